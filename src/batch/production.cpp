#include "paracal/batch/production.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <new>

#include "calibration/fit/as_given.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_error.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/drive.hpp"

namespace paracal {
namespace {

constexpr int kFinePoints = 9;  // on each rim: the n at which O2 settles
constexpr int kSelectedPoses = 30, kCandidates = 300;

Fate fate_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::accepted:
      return Fate::accepted;
    case Verdict::rejected:
      return Fate::rejected;
    case Verdict::not_identifiable:
      return Fate::not_identifiable;
    case Verdict::not_converged:
      break;
  }
  return Fate::not_converged;
}

/// What the metrologist hands over: errors for the controller to compensate, where the calibration was accepted.
struct Delivery {
  Fate fate = Fate::does_not_close;
  std::optional<SourceErrors> compensated = {};
};

/// calibrate() without what nobody reads of a thousand machines.
Calibration fate_told(const Robot& robot, const Measurements& readings, const CalibrationOptions& options) {
  if (options.diagnose) return calibrate(robot, readings, options);
  return detail::calibrate_as_given(robot, readings, options, detail::Told::verdict);
}

Delivery measure_and_calibrate(const Robot& robot, const ProductionPlan& plan, const SourceErrors& errors,
                               RandomStream& random) {
  try {
    const Measurements readings = simulate(robot, errors, plan.stations, plan.instrument, random);
    const Calibration calibration = fate_told(robot, readings, plan.calibration);
    if (!calibration.accepted()) return {fate_of(calibration.verdict)};
    return {Fate::accepted, calibration.errors()};
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Unreachable&) {
    return {Fate::does_not_close};
  } catch (const std::exception&) {  // readings, or statistics of them, that are no numbers any more
    return {Fate::not_converged};
  }
}

/// Asks a controller for the validation poses.
class Validator {
 public:
  Validator(const Robot& robot, const std::vector<Station>& stations, const SourceErrors& errors)
      : robot_(robot), stations_(stations), actual_(build(robot, errors)) {
    tilts_.reserve(stations.size());
    for (const Station& station : stations) tilts_.push_back(station.commanded.tilt);
  }

  /// @param believed  the machine that the controller computes with. Empty where a pose cannot be asked for or taken.
  std::optional<Accuracy> operator()(const Machine& believed) {
    std::vector<PosePair> pairs;
    pairs.reserve(stations_.size());
    Accuracy accuracy;
    for (std::size_t k = 0; k < stations_.size(); ++k) {
      const Pose& commanded = stations_[k].commanded;
      const std::optional<PlateState> taken = drive(actual_, believed, commanded, guess_at(k));
      if (!taken) return std::nullopt;
      tilts_[k] = taken->tilt;
      pairs.push_back({commanded, pose_of(actual_, *taken)});
      const double tilt = turned_away(actual_, commanded, *taken).head<2>().norm();
      accuracy[ErrorKind::tilt] = std::max(accuracy[ErrorKind::tilt], tilt);
    }
    const PoseErrorSummary largest = summarize(pairs, robot_.slide().has_value());
    accuracy[ErrorKind::distance] = largest.max_abs_distance;
    accuracy[ErrorKind::volumetric] = largest.max_volumetric;
    accuracy[ErrorKind::volumetric_aligned] = largest.max_volumetric_aligned;
    accuracy[ErrorKind::rotation] =
        !robot_.is_level() ? largest_turn_since_home(pairs) : largest.max_abs_rotation.value_or(0.0);
    return accuracy;
  }

 private:
  /// Of R_0^T R against the same as commanded.
  static double largest_turn_since_home(const std::vector<PosePair>& pairs) {
    const auto since_home = [](const Pose& home, const Pose& pose) -> Eigen::Matrix3d {
      return plate_rotation(home.tilt).matrix.transpose() * plate_rotation(pose.tilt).matrix;
    };
    double largest = 0.0;
    for (const PosePair& pair : pairs) {
      const Eigen::Matrix3d meant = since_home(pairs.front().meant, pair.meant);
      const Eigen::Matrix3d actual = since_home(pairs.front().actual, pair.actual);
      largest = std::max(largest, Eigen::AngleAxisd(meant.transpose() * actual).angle());
    }
    return largest;
  }

  /// The commanded pose with the tilt that the machine last had there: joints that differ a little hardly change it.
  PlateState guess_at(std::size_t k) const {
    const Pose& commanded = stations_[k].commanded;
    return {commanded.position, tilts_[k], actual_.slide_of(commanded.rotation)};
  }

  const Robot& robot_;
  const std::vector<Station>& stations_;
  Machine actual_;
  std::vector<Eigen::Vector3d> tilts_;
};

}  // namespace

std::string_view name(ErrorKind kind) {
  constexpr std::array<std::string_view, kErrorKinds.size()> kNames{"distance", "volumetric", "volumetric_aligned",
                                                                    "rotation", "tilt"};
  return kNames[static_cast<std::size_t>(kind)];
}

Unit unit(ErrorKind kind) { return kind == ErrorKind::rotation || kind == ErrorKind::tilt ? Unit::rad : Unit::mm; }

std::string_view name(Fate fate) {
  constexpr std::array<std::string_view, kFates.size()> kNames{"accepted", "rejected", "not_identifiable",
                                                               "not_converged", "does_not_close"};
  return kNames[static_cast<std::size_t>(fate)];
}

bool turns(const Robot& robot) { return robot.slide().has_value() || robot.commands_tilt(); }

double used_up(const Accuracy& accuracy, const PerErrorKind<std::optional<double>>& limits) {
  double most = 0.0;
  for (const ErrorKind kind : kErrorKinds) {
    if (limits[kind]) most = std::max(most, accuracy[kind] / *limits[kind]);
  }
  return most;
}

bool has_limits(const ProductionPlan& plan) {
  return std::ranges::any_of(kErrorKinds, [&](ErrorKind kind) { return plan.limits[kind].has_value(); });
}

ProductionPlan paper_production(const Robot& robot, const Tolerances& tolerances) {
  ProductionPlan plan{.tolerances = tolerances, .instrument = {.noise = kUsualNoise}};
  if (!robot.is_level()) {
    const bool turns = robot.commands_tilt();
    const SelectionOptions full{.poses = kSelectedPoses,
                                .readings = {.measurand = turns ? Measurand::poses : Measurand::coordinates},
                                .tolerances = tolerances};
    plan.instrument.reads_orientation = turns;
    plan.stations = select_stations(robot, candidate_stations(robot, kCandidates, 1), full).stations;
    plan.validation = workspace_stations(robot);
  } else {
    plan.stations = fine_stations(robot, kFinePoints);
    plan.validation = validation_stations(robot);
  }
  plan.calibration.tolerances = tolerances;
  plan.calibration.states_use = false;  // of a thousand machines nobody reads it
  plan.calibration.diagnose = false;    // a virtual metrologist makes no such mistakes
  return plan;
}

ProductionPlan settled(const Robot& robot, ProductionPlan plan) {
  if (plan.stations.empty() || plan.validation.empty()) {
    throw InvalidArgument("batch: expected poses to measure and to validate, got none");
  }
  for (const Station& station : plan.validation) (void)believed_joints(robot, station);
  RandomStream random(0);
  const Measurements readings = simulate(robot, {}, plan.stations, plan.instrument, random);
  const Calibration nominal = calibrate(robot, readings, plan.calibration);
  if (plan.calibration.stage == Stage::automatic) {
    plan.calibration.stage = nominal.stages.size() > 1 ? Stage::fine : Stage::rough;
  }
  return plan;
}

MachineOutcome produce(const Robot& robot, const ProductionPlan& plan, std::uint64_t seed, std::uint64_t machine) {
  RandomStream random(seed, machine);
  const SourceErrors errors = draw_errors(robot, plan.tolerances, random);
  const Delivery delivery = measure_and_calibrate(robot, plan, errors, random);
  if (delivery.fate == Fate::does_not_close) return {};
  Validator validate(robot, plan.validation, errors);
  const std::optional<Accuracy> before = validate(robot.nominal());
  const std::optional<Accuracy> after =
      before && delivery.compensated ? validate(build(robot, *delivery.compensated)) : before;
  if (!before || !after) return {};
  const bool passes = has_limits(plan) ? used_up(*after, plan.limits) <= 1.0 : delivery.fate == Fate::accepted;
  return {delivery.fate, passes, *before, *after};
}

}  // namespace paracal
