#include "paracal/calibration/identification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "paracal/calibration/least_squares.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal {
namespace {

/// Joint coordinates that the controller believed at a station.
Joints believed_joints(const Robot& robot, const Station& station) {
  if (station.believed) return *station.believed;
  const InverseResult nominal = inverse(robot.nominal(), station.commanded);
  if (nominal.ok()) return nominal.joints;
  const Eigen::Vector3d& r = station.commanded.position;
  throw Unreachable(fmt::format("station \"{}\": robot {} cannot reach ({:g}, {:g}, {:g}) mm at {:g} deg", station.name,
                                robot.name(), r.x(), r.y(), r.z(), to_degrees(station.commanded.rotation)));
}

/// What the machine does at one station, and how that changes with the parameters.
struct PredictedStation {
  PlateState plate;
  double rotation = 0.0;
  Eigen::Matrix<double, 3, Eigen::Dynamic> position_jacobian;
  Eigen::RowVectorXd rotation_jacobian;
};

/// The readings as a function of the source errors sought: predictions, derivatives, weighted residuals.
class ReadingModel {
 public:
  ReadingModel(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
               const std::vector<ParameterEstimate>& sought)
      : robot_(robot), measurements_(measurements), options_(options), sought_(sought) {
    for (const Station& station : measurements.stations) joints_.push_back(believed_joints(robot, station));
  }

  Eigen::Index parameter_count() const { return static_cast<Eigen::Index>(sought_.size()); }

  Eigen::Index row_count() const {
    const auto rotations = std::ranges::count_if(
        measurements_.distances, [](const DistanceReading& reading) { return reading.rotation.has_value(); });
    return static_cast<Eigen::Index>(measurements_.distances.size()) + rotations;
  }

  /// Weighted residuals predicted - measured and their Jacobian; false when the machine does not close
  /// somewhere or a reading is too absurd to be squared.
  bool operator()(const Eigen::VectorXd& values, Linearization& linearization) const {
    std::vector<PredictedStation> stations;
    if (!predict(values, stations)) return false;
    linearization.residual.resize(row_count());
    linearization.jacobian.resize(row_count(), parameter_count());
    Eigen::Index row = 0;
    for (const DistanceReading& reading : measurements_.distances) {
      const PredictedStation &from = stations[reading.from], &to = stations[reading.to];
      const Eigen::Vector3d between = to.plate.position - from.plate.position;
      const double sigma = reading.distance_sigma.value_or(options_.distance_sigma);
      linearization.residual(row) = (between.norm() - reading.distance) / sigma;
      linearization.jacobian.row(row++) =
          between.normalized().transpose() * (to.position_jacobian - from.position_jacobian) / sigma;
      if (!reading.rotation) continue;
      const double rotation_sigma = options_.rotation_sigma;
      linearization.residual(row) = (to.rotation - from.rotation - *reading.rotation) / rotation_sigma;
      linearization.jacobian.row(row++) = (to.rotation_jacobian - from.rotation_jacobian) / rotation_sigma;
    }
    return std::isfinite(linearization.residual.squaredNorm());
  }

 private:
  bool predict(const Eigen::VectorXd& values, std::vector<PredictedStation>& stations) const {
    SourceErrors errors;
    for (std::size_t k = 0; k < sought_.size(); ++k) {
      errors(sought_[k].limb, sought_[k].source) = values(static_cast<Eigen::Index>(k));
    }
    const Machine machine = build(robot_, errors);
    for (const Joints& joints : joints_) {
      const ForwardResult pose = forward(machine, joints);
      const ExactJacobian jacobian = exact_jacobian(machine, pose.plate, joints);
      if (!pose.ok() || !jacobian.ok) return false;
      stations.push_back(project(machine, pose.plate, jacobian));
    }
    return true;
  }

  PredictedStation project(const Machine& machine, const PlateState& plate, const ExactJacobian& jacobian) const {
    PredictedStation station{plate, machine.rotation_of(plate.slide), {}, {}};
    station.position_jacobian.resize(3, parameter_count());
    station.rotation_jacobian.setZero(parameter_count());
    for (std::size_t k = 0; k < sought_.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const auto sensitivity = jacobian.plate.col(ExactJacobian::column(sought_[k].limb, sought_[k].source));
      station.position_jacobian.col(column) = sensitivity.head<3>();
      if (machine.has_slide()) station.rotation_jacobian(column) = machine.rotation_of(sensitivity(3));
    }
    return station;
  }

  const Robot& robot_;
  const Measurements& measurements_;
  const CalibrationOptions& options_;
  const std::vector<ParameterEstimate>& sought_;
  std::vector<Joints> joints_;
};

/// Turns weighted residuals (predicted - measured) back into measured - predicted, in mm and rad.
void fill_residuals(const Measurements& measurements, const CalibrationOptions& options, const Eigen::VectorXd& before,
                    const Eigen::VectorXd& after, Calibration& calibration) {
  Eigen::Index row = 0;
  for (const DistanceReading& reading : measurements.distances) {
    const double sigma = reading.distance_sigma.value_or(options.distance_sigma);
    ReadingResidual residual;
    residual.from = measurements.stations[reading.from].name;
    residual.to = measurements.stations[reading.to].name;
    residual.distance = reading.distance;
    residual.distance_before = -before(row) * sigma;
    residual.distance_after = -after(row++) * sigma;
    if (reading.rotation) {
      residual.rotation = reading.rotation;
      residual.rotation_before = -before(row) * options.rotation_sigma;
      residual.rotation_after = -after(row++) * options.rotation_sigma;
    }
    calibration.residuals.push_back(std::move(residual));
  }
}

/// Summary of one pair of columns of the residual table.
ResidualSummary summarize(const std::vector<ReadingResidual>& residuals, double ReadingResidual::*distance,
                          std::optional<double> ReadingResidual::*rotation) {
  ResidualSummary summary;
  double sum = 0.0;
  for (const ReadingResidual& residual : residuals) {
    summary.max_abs_distance = std::max(summary.max_abs_distance, std::abs(residual.*distance));
    sum += residual.*distance * residual.*distance;
    if (!(residual.*rotation)) continue;
    summary.max_abs_rotation = std::max(summary.max_abs_rotation.value_or(0.0), std::abs(*(residual.*rotation)));
  }
  summary.rms_distance = std::sqrt(sum / static_cast<double>(residuals.size()));
  return summary;
}

bool all_sigmas_stated(const Measurements& measurements) {
  return std::ranges::all_of(measurements.distances, [](const DistanceReading& reading) {
    return reading.distance_sigma.has_value() && !reading.rotation;
  });
}

/// Probability that noise alone improves the weighted sum of squares from `before` to `after` with `rank` parameters:
/// F((before - after) / rank : after / freedom), or chi-square of before - after where the sigmas are known.
std::optional<double> chance_of(double before, double after, int rank, int freedom, bool sigmas_known) {
  const double gain = std::max(before - after, 0.0);
  if (rank == 0) return 1.0;
  if (sigmas_known) {
    return boost::math::cdf(boost::math::complement(boost::math::chi_squared_distribution<>(rank), gain));
  }
  if (freedom <= 0) return std::nullopt;
  if (after <= 0.0) return gain > 0.0 ? 0.0 : 1.0;
  const double ratio = (gain / rank) / (after / freedom);
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f_distribution<>(rank, freedom), ratio));
}

void judge(const LeastSquaresResult& fit, const CalibrationOptions& options, Calibration& calibration) {
  if (fit.status != LeastSquaresStatus::converged) {
    calibration.verdict = Verdict::not_converged;
    calibration.reasons.push_back(fit.status == LeastSquaresStatus::not_evaluable
                                      ? "the nominal machine does not close at every station, or a reading is absurd: "
                                        "are joint angles, distances "
                                        "and sigmas those of this robot, in deg and mm?"
                                      : fmt::format("the fit did not settle in {} iterations", fit.iterations));
    return;
  }
  if (calibration.rank < fit.parameters.size()) {
    calibration.verdict = Verdict::not_identifiable;
    calibration.reasons.push_back(fmt::format("the readings determine {} of {} parameters: measure more poses",
                                              calibration.rank, fit.parameters.size()));
    return;
  }
  calibration.verdict = Verdict::rejected;
  if (!calibration.chance) {
    calibration.reasons.push_back(
        fmt::format("{} readings for {} parameters leave nothing to check the fit with: measure more distances or "
                    "state their sigma",
                    fit.at_answer.residual.size(), fit.parameters.size()));
  } else if (*calibration.chance > options.largest_chance) {
    calibration.reasons.push_back(fmt::format(
        "the improvement could be chance (probability {:.2g}, limit {:g}): these offsets are not shown to be real",
        *calibration.chance, options.largest_chance));
  } else {
    calibration.verdict = Verdict::accepted;
  }
}

/// Scatter, standard deviations and covariance.
void state_uncertainty(const LeastSquaresResult& fit, bool sigmas_known, Calibration& calibration) {
  const double sum = fit.at_answer.residual.squaredNorm();
  if (calibration.degrees_of_freedom > 0) {
    calibration.unit_weight_std = std::sqrt(sum / calibration.degrees_of_freedom);
  }
  const bool determined = calibration.rank == fit.parameters.size();
  if (!determined || (!calibration.unit_weight_std && !sigmas_known)) return;
  const double scatter = calibration.unit_weight_std.value_or(1.0);
  calibration.covariance = fit.covariance * std::pow(sigmas_known ? std::max(1.0, scatter) : scatter, 2);
  for (std::size_t k = 0; k < calibration.parameters.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    calibration.parameters[k].std = std::sqrt(calibration.covariance(i, i));
  }
}

/// "0.71 theta_offset limb 1 - 0.71 theta_offset limb 3": the parameters with a share in a direction.
std::string describe(const Eigen::VectorXd& direction, const std::vector<ParameterEstimate>& parameters) {
  constexpr double kSmallestShare = 0.05;
  std::string text;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const double share = direction(static_cast<Eigen::Index>(k));
    if (std::abs(share) < kSmallestShare) continue;
    const std::string_view sign = share < 0 ? (text.empty() ? "-" : " - ") : (text.empty() ? "" : " + ");
    text +=
        fmt::format("{}{:.2f} {} limb {}", sign, std::abs(share), name(parameters[k].source), parameters[k].limb + 1);
  }
  return text;
}

/// Residuals, chance, uncertainty, null space and stage of a fit that could be evaluated.
/// @param nominal  weighted residuals of the nominal machine.
void state_evidence(const Measurements& measurements, const Eigen::VectorXd& nominal, const LeastSquaresResult& fit,
                    Calibration& calibration) {
  const Eigen::VectorXd& answer = fit.at_answer.residual;
  const bool sigmas_known = all_sigmas_stated(measurements);
  calibration.degrees_of_freedom = static_cast<int>(answer.size()) - fit.rank;
  fill_residuals(measurements, calibration.options, nominal, answer, calibration);
  calibration.before =
      summarize(calibration.residuals, &ReadingResidual::distance_before, &ReadingResidual::rotation_before);
  calibration.after =
      summarize(calibration.residuals, &ReadingResidual::distance_after, &ReadingResidual::rotation_after);
  calibration.chance =
      chance_of(nominal.squaredNorm(), answer.squaredNorm(), fit.rank, calibration.degrees_of_freedom, sigmas_known);
  state_uncertainty(fit, sigmas_known, calibration);
  for (const auto& direction : fit.null_space.colwise()) {
    calibration.null_space.push_back({describe(direction, calibration.parameters), direction});
  }
  const double smallest = fit.singular_values.size() < fit.parameters.size() ? 0.0 : fit.singular_values.minCoeff();
  calibration.stages.push_back({"rough", fit.iterations, fit.status == LeastSquaresStatus::converged, fit.rank,
                                fit.singular_values(0) / smallest, calibration.after.rms_distance});
}

/// The encoder offsets of all limbs, not yet known.
std::vector<ParameterEstimate> encoder_offsets(const Robot& robot) {
  std::vector<ParameterEstimate> parameters;
  for (std::size_t i = 0; i < robot.limb_count(); ++i) parameters.push_back({.limb = i});
  return parameters;
}

}  // namespace

Calibration calibrate(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options) {
  check(measurements, robot.limb_count());
  if (measurements.distances.empty()) throw InvalidArgument("measurements: expected at least one distance, got none");
  Calibration calibration{
      .robot = robot, .parameters = encoder_offsets(robot), .options = options, .files = measurements.files};
  const ReadingModel model(robot, measurements, options, calibration.parameters);
  const Eigen::VectorXd start = Eigen::VectorXd::Zero(model.parameter_count());
  const LeastSquaresResult fit = solve_least_squares(std::cref(model), start);
  calibration.rank = fit.rank;
  for (std::size_t k = 0; k < calibration.parameters.size(); ++k) {
    calibration.parameters[k].value = fit.parameters(static_cast<Eigen::Index>(k));
  }
  if (fit.status != LeastSquaresStatus::not_evaluable) {
    Linearization nominal;
    model(start, nominal);
    state_evidence(measurements, nominal.residual, fit, calibration);
  }
  judge(fit, options, calibration);
  return calibration;
}

}  // namespace paracal
