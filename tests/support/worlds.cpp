#include "support/worlds.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/units.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test {
namespace {

constexpr std::uint64_t kErrors = 101, kNoiseOfReadings = 102, kWrongPoses = 103;
constexpr double kTurnLever = 100.0;  // mm: by what a body is turned where its points are off

RigidMotion world_frame() {
  return {Eigen::AngleAxisd(-1.3, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix(), {-900, 2200, 1400}};
}

/// @param faults  gets the names of wrong parts.
SourceErrors drawn(const Robot& robot, const World& world, RandomStream& random, std::vector<std::string>& faults) {
  SourceErrors errors = draw_errors(robot, *robot.tolerances(), random);
  // [huang2016, Table 4] has lengths below 0.7 mm and angles below 0.45 / 375 rad.
  constexpr double kTable4Share = 0.3;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : all_sources()) {
      double& error = errors(limb, source);
      error *= tilts_plate(source) ? world.tilt_tolerances : world.position_tolerances;
      if (world.table4_sized && !is_joint_zero(source)) error *= kTable4Share;
    }
  }
  std::vector<std::pair<std::size_t, Source>> wrong;
  while (std::ssize(wrong) < world.wrong_parts) {
    const auto limb = static_cast<std::size_t>(random.uniform() * static_cast<double>(robot.limb_count()));
    const std::span<const Source> kinds = sources_of(robot.actuator());
    const auto moving = std::ranges::count(kinds, false, [&](Source one) { return tilts_plate(one); });
    const Source source = kinds[static_cast<std::size_t>(random.uniform() * static_cast<double>(moving))];
    const double side = random.uniform() < 0.5 ? -10.0 : 10.0;
    if (std::ranges::find(wrong, std::pair(limb, source)) != wrong.end()) continue;
    wrong.emplace_back(limb, source);
    // On a vertical rail these move the plate alike.
    const bool as_zero = source == "e_z" && robot.actuator() == Actuator::linear;
    faults.push_back(std::string(as_zero ? "theta_offset" : name(source)) + " of limb " + std::to_string(limb + 1) +
                     " ");
    errors(limb, source) = side * (*robot.tolerances())[source];
  }
  return errors;
}

/// One machine as it really is.
class Truth {
 public:
  Truth(const Robot& robot, const World& world, int number)
      : robot_(robot), world_(world), random_(kErrors, static_cast<std::uint64_t>(number)) {
    errors_ = drawn(robot, world, random_, faults_);
    if (world.reflector_off > 0.0 && robot.slide()) faults_.emplace_back("reflector");
    if (world.last_series_factor > 1.0 && world.states_sigmas) {
      faults_.emplace_back(world.readings == Readings::two_trackers ? "the points of other tracker" : "of bar ");
    }
    cold_ = differentiable(robot, errors_);
    SourceErrors warm = errors_;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      if (swings_arm(robot.actuator())) {
        warm(limb, "arm_length") += world.warm_drives * robot.nominal().limbs[limb].arm;
      } else {
        warm(limb, "gain") += world.warm_drives * kGainLength;
      }
    }
    warm_ = differentiable(robot, warm);
    if (world.warming_rod > 0.0) {
      warming_limb_ = static_cast<std::size_t>(number) % robot.limb_count();
      faults_.push_back("rod 1 of limb " + std::to_string(warming_limb_ + 1));
    }
    if (world.backlash_by_side > 0.0) faults_.emplace_back("direction of its motion");
    if (world.sticks > 0.0) faults_.emplace_back(" sticks: ");
    sides_ = Joints::Zero(static_cast<Eigen::Index>(robot.limb_count()));
    be_at(1.0);
    loose_joint_ = static_cast<Eigen::Index>(random_.uniform() * static_cast<double>(robot.limb_count()));
    waves_ = Eigen::MatrixXd::NullaryExpr(6, static_cast<Eigen::Index>(robot.limb_count()),
                                          [&] { return random_.normal(); });
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      zeros_.push_back({limb, joint_zero(robot.nominal().limbs[limb].actuator)});
    }
    survey();
  }

  /// As its drives feel them.
  SourceErrors errors() const { return as_felt(robot_, errors_); }
  /// As notes name them, those of the readings included.
  std::vector<std::string>& faults() { return faults_; }

  /// What the machine is at a time from 0 to 1; afterwards it stays as at 1.
  void be_at(double time) {
    if (world_.warming_rod == 0.0) return;
    SourceErrors now = errors_;
    now(warming_limb_, "rod_mean") += 0.5 * time * world_.warming_rod;
    now(warming_limb_, "rod_difference") += time * world_.warming_rod;
    cold_ = warm_ = differentiable(robot_, now);
  }
  /// Joints come from where they are to a station.
  void go_to(const Station& station) {
    if (world_.backlash_by_side == 0.0) return;
    const Joints there = believed_joints(robot_, station);
    if (came_from_.size() > 0) {
      for (Eigen::Index k = 0; k < there.size(); ++k) {
        if (there(k) != came_from_(k)) sides_(k) = there(k) > came_from_(k) ? -1.0 : 1.0;
      }
    }
    came_from_ = there;
  }
  /// In the middle of the play.
  void forget_sides() { sides_.setZero(); }

  /// Where the plate stands at a station this time; the same joints are off the same way at every visit.
  /// @param visits  a single visit, at which a loose joint stands anew.
  Pose at(const Station& station, bool warm = true, bool visits = false) {
    constexpr double kPulley = 40.0 / to_radians(360.0);  // mm a rad: 20 teeth of 2 mm
    const bool swings = swings_arm(robot_.actuator());
    const double turn = swings ? 1.0 : kPulley, lever = swings ? 1.0 : robot_.nominal().limbs[0].mean_rod();
    Joints joints = believed_joints(robot_, station);
    const double side = random_.uniform() < 0.5 ? -1.0 : 1.0;
    if (visits) joints(loose_joint_) += lever * world_.loose * side;
    if (visits && world_.sticks > 0.0 && random_.uniform() < 0.1) joints(loose_joint_) += lever * world_.sticks * side;
    for (Eigen::Index k = 0; k < joints.size(); ++k) {
      const double q = joints(k);
      if (k == 0 || !world_.one_drive) joints(k) += lever * world_.encoder_once_a_turn * std::sin(q / turn);
      for (int turns = 1; world_.uneven > 0.0 && turns <= 3; ++turns) {
        const double phase = 2.0 * std::numbers::pi * turns * (q - low_(k)) / stroke_(k);
        joints(k) += lever * world_.uneven / std::sqrt(3.0) *
                     (waves_(2 * turns - 2, k) * std::sin(phase) + waves_(2 * turns - 1, k) * std::cos(phase));
      }
      if (world_.backlash_by_side > 0.0) {
        joints(k) += lever * world_.backlash_by_side * (visits ? (random_.uniform() < 0.5 ? -1.0 : 1.0) : sides_(k));
      }
      if (world_.backlash > 0.0) joints(k) += lever * (random_.uniform() < 0.5 ? -world_.backlash : world_.backlash);
    }
    for (Eigen::Index k = 0; world_.uneven_fast > 0.0 && k < joints.size(); ++k) {
      const double turns = 10.0 * (joints(k) - low_(k)) / stroke_(k);
      joints(k) += lever * world_.uneven_fast * std::sin(2.0 * std::numbers::pi * turns + waves_(0, k));
    }
    if (world_.counts_per_turn > 0.0) {
      const double step = lever * 2.0 * std::numbers::pi / world_.counts_per_turn;
      joints = step * (joints / step).array().round();
    }
    const auto bent = world_.guides_aside > 0.0 || world_.wobble > 0.0 ? bent_at(joints) : DifferentiableMachine{};
    const bool bends = world_.guides_aside > 0.0 || world_.wobble > 0.0;
    const DifferentiableMachine& machine = bends ? bent : warm ? warm_ : cold_;
    if (world_.compliance > 0.0) {  // what lifts the plate turns each joint, by as much as the plate follows it
      const PlateMotions motions = plate_jacobian(machine, forward(machine, joints).plate, joints, zeros_);
      joints -= world_.compliance * most_lift_ * motions.row(2).transpose();
    }
    Pose pose = pose_of(machine, forward(machine, joints).plate);
    if (world_.bow_at_rim > 0.0) {
      const Workspace& workspace = robot_.workspace();
      const double up = (pose.position.z() - workspace.centre().z()) / (0.5 * workspace.height);
      pose.position.x() += world_.bow_at_rim * up * up;
    }
    pose.position.z() -= world_.sag_at_rim * pose.position.head<2>().norm() / robot_.workspace().radius;
    return pose;
  }

 private:
  /// What guides or axes that are not straight make of the machine at these joints.
  DifferentiableMachine bent_at(const Joints& joints) const {
    SourceErrors now = errors_;
    for (std::size_t limb = 0; limb < robot_.limb_count(); ++limb) {
      const auto k = static_cast<Eigen::Index>(limb);
      const double s = 2.0 * (joints(k) - low_(k)) / stroke_(k) - 1.0, q = joints(k);
      now(limb, "e_y") += world_.guides_aside * (0.5 * s * (5.0 * s * s - 3.0) * waves_(1, k) / 1.5);
      now(limb, "alpha0") += world_.wobble * std::sin(2.0 * q + waves_(2, k));
      now(limb, "beta0") += world_.wobble * std::sin(3.0 * q + waves_(3, k));
    }
    return differentiable(robot_, now);
  }

  /// Strokes of the joints, and how much they lift the plate.
  void survey() {
    const auto joints = static_cast<Eigen::Index>(robot_.limb_count());
    low_ = Joints::Constant(joints, 1e300);
    Joints high = -low_;
    double most = 0.0;
    for (const Station& station : workspace_stations(robot_)) {
      const Joints at = believed_joints(robot_, station);
      low_ = low_.cwiseMin(at);
      high = high.cwiseMax(at);
      const PlateMotions motions =
          plate_jacobian(robot_.nominal(), plate_at(robot_.nominal(), station.commanded), at, zeros_);
      most = std::max(most, motions.row(2).squaredNorm());
    }
    stroke_ = high - low_;
    most_lift_ = 1.0 / most;
  }

  const Robot& robot_;
  const World& world_;
  std::vector<std::string> faults_;
  RandomStream random_;
  SourceErrors errors_;
  DifferentiableMachine cold_, warm_;
  Eigen::Index loose_joint_ = 0;
  std::size_t warming_limb_ = 0;
  Joints sides_, came_from_;
  Eigen::MatrixXd waves_;
  std::vector<SoughtSource> zeros_;
  Joints low_, stroke_;
  double most_lift_ = 0.0;
};

/// Noise of a reading, mm.
class Noise {
 public:
  Noise(const World& world, int number)
      : world_(world), random_(kNoiseOfReadings, static_cast<std::uint64_t>(number)), factor_(world.noise_factor) {}

  double operator()() {
    double draw = random_.normal();
    if (world_.student) {
      double squares = 0.0;
      for (int k = 0; k < 3; ++k) squares += std::pow(random_.normal(), 2);
      draw /= std::sqrt(squares / 3.0);
    }
    return draw * factor_ * kWorldNoise * (gross_ ? 5.0 : 1.0);
  }
  /// Begins a series that is as noisy as this beside what it states.
  void next_series(double factor) { factor_ = factor; }
  /// Begins a reading, which may be a gross one.
  void next_reading() { gross_ = random_.uniform() < world_.gross_share; }

 private:
  const World& world_;
  RandomStream random_;
  double factor_;
  bool gross_ = false;
};

/// How far each pose is from what was commanded there, mm.
std::vector<Eigen::Vector3d> wrong_poses(const World& world, std::size_t count, int number) {
  std::vector<Eigen::Vector3d> off(count, Eigen::Vector3d::Zero());
  if (world.wrong_poses == 1) off[count / 2] = world.wrong_pose * Eigen::Vector3d(0.6, -0.64, 0.48);
  RandomStream random(kWrongPoses, static_cast<std::uint64_t>(number));
  for (int wrong = 0; world.wrong_poses > 1 && wrong < world.wrong_poses;) {
    Eigen::Vector3d& one = off[static_cast<std::size_t>(random.uniform() * static_cast<double>(count))];
    const Eigen::Vector3d side(random.normal(), random.normal(), random.normal());
    if (!one.isZero()) continue;
    one = world.wrong_pose * side.normalized();
    ++wrong;
  }
  return off;
}

/// What an instrument reads of a body on a plate with six freedoms; of others of a reflector at the plate's origin.
PointReading read_point(const Robot& robot, const Pose& pose, const World& world, Noise& noise) {
  const RigidMotion frame = world_frame(), body{world_frame().rotation, {30.0, -20.0, 50.0}};
  const auto three = [&] { return Eigen::Vector3d(noise(), noise(), noise()); };
  PointReading reading;
  const Eigen::Matrix3d end_effector =
      plate_rotation(pose.tilt).matrix * Eigen::AngleAxisd(pose.rotation, Eigen::Vector3d::UnitZ());
  Eigen::Vector3d place = pose.position + world.reflector_off * (end_effector * Eigen::Vector3d(-0.8, 0.6, 0.0));
  if (!robot.is_level() && robot.freedoms().are_all()) {
    const Eigen::Matrix3d plate = plate_rotation(pose.tilt).matrix;
    const Eigen::Vector3d off = three() / kTurnLever;
    const Quaternion turned = Quaternion(1.0, 0.5 * off.x(), 0.5 * off.y(), 0.5 * off.z()).normalized();
    place += plate * body.translation;
    reading.orientation = turned * Quaternion(Eigen::Matrix3d(frame.rotation * plate * body.rotation));
  }
  reading.point = (1.0 + world.scale) * frame(place) + three();
  return reading;
}

Measurements points(const Robot& robot, const World& world, Truth& truth, Noise& noise, std::vector<Station> stations,
                    int visits, int number) {
  Measurements measured{.stations = std::move(stations), .series = {{"tracker", {}}}};
  const std::vector<Eigen::Vector3d> off = wrong_poses(world, measured.stations.size(), number);
  const std::size_t poses = measured.stations.size(), all = poses * static_cast<std::size_t>(visits);
  std::vector<std::optional<Pose>> mean(poses);
  for (std::size_t row = 0; row < all; ++row) {
    const std::size_t k = world.in_passes ? row % poses : row / static_cast<std::size_t>(visits);
    const Station& station = measured.stations[k];
    const bool warm = 2 * row >= all;
    truth.be_at(static_cast<double>(row) / static_cast<double>(all - 1));
    truth.go_to(station);
    if (!mean[k] || world.in_passes) mean[k] = truth.at(station, warm);
    Pose pose = *mean[k];
    pose.position += off[k];
    const bool is_first = world.in_passes ? row < poses : row % static_cast<std::size_t>(visits) == 0;
    if (is_first && !off[k].isZero()) truth.faults().push_back("pose " + station.name + " ");
    noise.next_reading();
    const Pose there = world.loose > 0.0 || world.sticks > 0.0 ? truth.at(station, warm, true) : pose;
    PointReading reading = read_point(robot, there, world, noise);
    const double time = static_cast<double>(k) / static_cast<double>(poses - 1);
    reading.point += world.drift * time * Eigen::Vector3d(0.48, 0.6, -0.64);
    reading.station = k;
    measured.series.front().readings.push_back(std::move(reading));
  }
  truth.forget_sides();
  return measured;
}

/// Every reading states kWorldNoise; the last series may be noisier.
void state_sigmas(Measurements& measured) {
  for (PointSeries& series : measured.series) {
    for (PointReading& one : series.readings) {
      one.sigma = kWorldNoise;
      if (one.orientation) one.orientation_sigma = kWorldNoise / kTurnLever;
    }
  }
  for (LengthSeries& series : measured.lengths) {
    for (LengthReading& one : series.readings) one.sigma = kWorldNoise;
  }
}

/// The same poses by two trackers.
Measurements points_of_two(const Robot& robot, const World& world, Truth& truth, Noise& noise,
                           const std::vector<Station>& stations, int number) {
  Measurements measured = points(robot, world, truth, noise, stations, world.visits, number);
  noise.next_series(world.last_series_factor);
  measured.series.push_back(points(robot, world, truth, noise, stations, world.visits, number).series.front());
  measured.series.back().name = "other tracker";
  if (world.states_sigmas) state_sigmas(measured);
  return measured;
}

/// The same poses by a tracker, a probe and a ball bar.
Measurements points_and_lengths(const Robot& robot, const World& world, Truth& truth, Noise& noise,
                                const std::vector<Station>& stations, int number) {
  Measurements measured = points(robot, world, truth, noise, stations, world.visits, number);
  const Workspace& workspace = robot.workspace();
  const Eigen::Vector3d fixed = workspace.centre() - Eigen::Vector3d(20.0, -30.0, workspace.radius + workspace.height);
  measured.lengths = {{.name = "bed", .kind = LengthKind::height},
                      {.name = "bar", .kind = LengthKind::ball_bar, .at = fixed}};
  for (LengthSeries& series : measured.lengths) {
    const bool last = series.kind == LengthKind::ball_bar;
    noise.next_series(last ? world.last_series_factor : 1.0);
    for (std::size_t k = 0; k < stations.size(); ++k) {
      const Eigen::Vector3d r = truth.at(stations[k]).position;
      const double length = last ? (r - fixed - Eigen::Vector3d(1.0, -2.0, 0.5)).norm()
                                 : r.z() - (workspace.centre().z() + 1e-3 * r.x() - 2e-3 * r.y());
      for (int visit = 0; visit < world.visits; ++visit) {
        series.readings.push_back({.station = k, .length = length + noise()});
      }
    }
  }
  if (world.states_sigmas) state_sigmas(measured);
  return measured;
}

/// Home, and two rings of six on the middle layer: heights above a plane that nobody knows.
std::vector<Station> height_stations(const Robot& robot) {
  std::vector<Station> stations{{"home", {robot.workspace().centre(), 0.0}}};
  for (int k = 0; k < 12; ++k) {
    const double radius = robot.workspace().radius * (k < 6 ? 0.5 : 0.95),
                 angle = to_radians(60.0 * k + (k < 6 ? 30 : 0));
    stations.push_back(
        {"H" + std::to_string(k + 1),
         {robot.workspace().centre() + radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0), 0.0}});
  }
  return stations;
}

Measurements heights(const Robot& robot, Truth& truth, Noise& noise, bool distances) {
  Measurements measured{.stations = height_stations(robot), .lengths = {{"bed"}}};
  std::vector<Eigen::Vector3d> places;
  for (std::size_t k = 0; k < measured.stations.size(); ++k) {
    places.push_back(truth.at(measured.stations[k]).position);
    const Eigen::Vector3d& r = places.back();
    measured.lengths.front().readings.push_back(
        {.station = k, .length = r.z() - (places.front().z() + 1e-3 * r.x() - 2e-3 * r.y()) + noise()});
  }
  for (std::size_t k = 7; distances && k < 13; k += 2) {
    measured.distances.push_back({.from = 0, .to = k, .distance = (places[k] - places[0]).norm() + noise()});
  }
  return measured;
}

Measurements distances(const Robot& robot, Truth& truth, Noise& noise) {
  Measurements measured{.stations = rough_stations(robot, 6)};
  std::vector<Eigen::Vector3d> places;
  for (const Station& station : measured.stations) places.push_back(truth.at(station).position);
  for (std::size_t k = 1; k < places.size(); ++k) {
    measured.distances.push_back({.from = 0, .to = k, .distance = (places[k] - places[0]).norm() + noise()});
  }
  return measured;
}

Measurements measured(const Bench& bench, const World& world, Truth& truth, int number) {
  Noise noise(world, number);
  switch (world.readings) {
    case Readings::points:
      return points(bench.robot, world, truth, noise, bench.selected, world.visits, number);
    case Readings::two_trackers:
      return points_of_two(bench.robot, world, truth, noise, bench.selected, number);
    case Readings::points_and_lengths:
      return points_and_lengths(bench.robot, world, truth, noise, bench.selected, number);
    case Readings::seven_points:
      return points(bench.robot, world, truth, noise, rough_stations(bench.robot, 6), 1, number);
    case Readings::six_distances:
      return distances(bench.robot, truth, noise);
    case Readings::heights:
      return heights(bench.robot, truth, noise, false);
    case Readings::heights_and_distances:
      break;
  }
  return heights(bench.robot, truth, noise, true);
}

CalibrationOptions options_of(const World& world) {
  CalibrationOptions options;
  options.noise_is_known = world.noise_is_known;
  options.noise.point = options.noise.body = options.noise.distance = options.noise.height = kWorldNoise;
  options.noise.rotation = kWorldNoise / kTurnLever;
  return options;
}

void count_exceeded(const PoseErrorSummary& largest, const Use& use, std::array<int, 3>& exceeded) {
  exceeded[0] += largest.max_abs_distance > use.distance.U ? 1 : 0;
  exceeded[1] += largest.max_volumetric_aligned > use.aligned.U ? 1 : 0;
  if (use.rotation && largest.max_abs_rotation) exceeded[2] += *largest.max_abs_rotation > use.rotation->U ? 1 : 0;
}

/// 2 std of a distance, Student's factor included, at each pose.
std::vector<double> expanded_distances(const Bench& bench, const KnownErrors& known, const Eigen::VectorXd& joint_std) {
  const std::vector<PoseStd> each = PoseSpread(bench.robot, known.errors, known.parameters, bench.others)
                                        .each(known.expanded_covariance(), joint_std);
  std::vector<double> U;
  for (std::size_t k = 1; k < each.size(); ++k) U.push_back(kCoverageFactor * each[k].distance);
  return U;
}

/// A fit that was told the true noise and the true tolerances, and seeks nothing else.
Calibration oracle(const Bench& bench, const World& world, const Measurements& readings) {
  CalibrationOptions options = options_of(world);
  options.noise_is_known = true;
  options.noise.point = options.noise.body = options.noise.distance = options.noise.height =
      world.noise_factor * kWorldNoise;
  options.noise.rotation = world.noise_factor * kWorldNoise / kTurnLever;
  options.seeks_discrepancies = false;
  options.tolerances = *bench.robot.tolerances();
  for (const Source source : all_sources()) {
    const bool tilts = tilts_plate(source);
    (*options.tolerances)[source] *= tilts ? world.tilt_tolerances : world.position_tolerances;
  }
  return calibrate(bench.robot, readings, options);
}

/// A cause is named where a note states it and not that it may be another one.
void count_named(const std::vector<std::string>& faults, const std::vector<std::string>& notes, Judgement& all) {
  const auto holds = [](const std::string& note, const std::string& text) {
    return note.find(text) != std::string::npos;
  };
  const auto certain = [&](const std::string& note) { return !holds(note, "The readings cannot tell"); };
  const auto names = [&](const std::string& note, const std::string& fault) {
    return certain(note) && holds(note, fault);
  };
  const auto is_named = [&](const std::string& fault) {
    return std::ranges::any_of(notes, [&](const std::string& note) { return names(note, fault); });
  };
  const auto blames = [&](const std::string& note) {
    return certain(note) && std::ranges::none_of(faults, [&](const std::string& fault) { return holds(note, fault); });
  };
  const auto is_listed = [&](const std::string& fault) {
    return std::ranges::any_of(notes, [&](const std::string& note) { return holds(note, fault); });
  };
  if (std::ranges::all_of(faults, is_named)) ++all.named;
  if (std::ranges::all_of(faults, is_listed)) ++all.listed;
  if (std::ranges::any_of(notes, blames)) ++all.blamed;
}

void judge_machine(const Bench& bench, const World& world, int number, bool with_oracle, Judgement& all) {
  Truth truth(bench.robot, world, number);
  const Measurements readings = measured(bench, world, truth, number);
  const Calibration calibration = calibrate(bench.robot, readings, options_of(world));
  ++all.machines;
  for (const std::string& note : calibration.notes) all.notes.push_back(std::to_string(number) + ": " + note);
  for (const std::string& reason : calibration.reasons) all.reasons.push_back(std::to_string(number) + ": " + reason);
  if (!calibration.accepted()) return;
  count_named(truth.faults(), calibration.notes, all);
  ++all.accepted;
  if (!calibration.notes.empty()) ++all.noted;
  const SourceErrors errors = truth.errors();
  for (const ParameterEstimate& one : calibration.parameters) {
    if (!one.identified() || !one.std) continue;
    ++all.errors;
    const double U = one.coverage() * *one.std;
    if (std::abs(one.value - errors(one.limb, one.source)) <= U) ++all.errors_held;
  }
  const KnownErrors known = known_errors(calibration);
  const std::vector<double> U = expanded_distances(bench, known, known.joint_std);
  const std::vector<double> U_of_a_visit = expanded_distances(bench, known, known.joint_std_of_a_visit());
  std::vector<PosePair> mean, visit;
  for (const Station& station : bench.others) {
    const Pose believed = predict(bench.robot, known, believed_joints(bench.robot, station)).pose;
    mean.push_back({believed, truth.at(station)});
    const bool differs = world.loose > 0.0 || world.sticks > 0.0 || world.backlash_by_side > 0.0;
    visit.push_back({believed, differs ? truth.at(station, true, true) : mean.back().actual});
  }
  for (std::size_t k = 1; k < bench.others.size(); ++k) {
    ++all.distances;
    if (std::abs(error_relative_to(mean[0], mean[k]).distance) <= U[k - 1]) ++all.distances_held;
    if (std::abs(error_relative_to(visit[0], visit[k]).distance) <= U_of_a_visit[k - 1]) ++all.visits_held;
  }
  const bool turns = bench.robot.slide().has_value();
  const PoseErrorSummary of_mean = summarize(mean, turns), of_visit = summarize(visit, turns);
  all.largest_distance_error.push_back(of_mean.max_abs_distance);
  all.largest_U.push_back(std::ranges::max(U));
  if (calibration.use && calibration.use_mean) {
    count_exceeded(of_mean, *calibration.use_mean, all.use_exceeded);
    count_exceeded(of_visit, *calibration.use, all.visit_exceeded);
  }
  if (!with_oracle) return;
  const Calibration told = oracle(bench, world, readings);
  const double ideal = std::ranges::max(expanded_distances(bench, known_errors(told), {}));
  all.U_over_oracle.push_back(std::ranges::max(U) / ideal);
  all.use_over_oracle.push_back(std::ranges::max(U_of_a_visit) / ideal);
}

}  // namespace

std::vector<World> wrong_worlds() {
  return {{.name = "clean"},
          {.name = "noise known", .noise_is_known = true},
          {.name = "six distances", .readings = Readings::six_distances, .table4_sized = true},
          {.name = "seven points", .readings = Readings::seven_points},
          {.name = "13 heights", .readings = Readings::heights},
          {.name = "13 heights, 3 distances", .readings = Readings::heights_and_distances},
          {.name = "all errors x 3", .position_tolerances = 3.0, .tilt_tolerances = 3.0},
          {.name = "position errors x 3", .position_tolerances = 3.0},
          {.name = "tilt errors x 3", .tilt_tolerances = 3.0},
          {.name = "one wrong part", .wrong_parts = 1},
          {.name = "two wrong parts", .wrong_parts = 2},
          {.name = "backlash 0.02 deg", .backlash = to_radians(0.02)},
          {.name = "backlash 0.005 deg", .backlash = to_radians(0.005)},
          {.name = "backlash 0.02 deg, noise known", .noise_is_known = true, .backlash = to_radians(0.02)},
          {.name = "loose 0.02 deg", .loose = to_radians(0.02)},
          {.name = "loose 0.02 deg, noise known", .noise_is_known = true, .loose = to_radians(0.02)},
          {.name = "sticks 0.02 deg at one visit of ten", .sticks = to_radians(0.02)},
          {.name = "sticks 0.1 deg at one visit of ten", .sticks = to_radians(0.1)},
          {.name = "one visit", .visits = 1},
          {.name = "one visit, loose 0.02 deg", .visits = 1, .loose = to_radians(0.02)},
          {.name = "drives uneven 0.0015 deg", .uneven = to_radians(0.0015), .errors_cannot_be_told = true},
          {.name = "uneven 0.002 deg within a tenth of the stroke",
           .uneven_fast = to_radians(0.002),
           .errors_cannot_be_told = true},
          {.name = "17-bit encoders", .counts_per_turn = 131072.0, .errors_cannot_be_told = true},
          {.name = "guides 0.03 mm aside", .guides_aside = 0.03, .errors_cannot_be_told = true},
          {.name = "axes wobble 0.01 deg", .wobble = to_radians(0.01), .errors_cannot_be_told = true},
          {.name = "compliance 0.05 mm", .compliance = 0.05, .errors_cannot_be_told = true},
          {.name = "bowed 0.1 mm", .bow_at_rim = 0.1, .errors_cannot_be_told = true},
          {.name = "drift 0.05 mm", .drift = 0.05, .errors_cannot_be_told = true},
          {.name = "one rod warms by 0.1 mm", .in_passes = true, .warming_rod = 0.1, .errors_cannot_be_told = true},
          {.name = "backlash 0.005 deg by direction",
           .in_passes = true,
           .backlash_by_side = to_radians(0.005),
           .errors_cannot_be_told = true},
          {.name = "one pose off 0.5 mm", .wrong_pose = 0.5},
          {.name = "two poses off 0.5 mm", .wrong_pose = 0.5, .wrong_poses = 2},
          {.name = "three poses off 0.5 mm", .wrong_pose = 0.5, .wrong_poses = 3},
          {.name = "reflector 0.5 mm off", .reflector_off = 0.5},
          {.name = "ball bar at 5 times its noise",
           .readings = Readings::points_and_lengths,
           .visits = 1,
           .last_series_factor = 5.0},
          {.name = "ball bar at 5 times the noise of others, none stated",
           .readings = Readings::points_and_lengths,
           .states_sigmas = false,
           .last_series_factor = 5.0},
          {.name = "tracker at 5 times its noise", .readings = Readings::two_trackers, .last_series_factor = 5.0},
          {.name = "encoder 0.01 deg a turn", .encoder_once_a_turn = to_radians(0.01), .errors_cannot_be_told = true},
          {.name = "encoder 0.01 deg a turn, one drive",
           .encoder_once_a_turn = to_radians(0.01),
           .one_drive = true,
           .errors_cannot_be_told = true},
          {.name = "arms warm up 1e-4", .warm_drives = 1e-4, .errors_cannot_be_told = true},
          {.name = "sag 0.05 mm", .sag_at_rim = 0.05, .errors_cannot_be_told = true},
          {.name = "scale 20 ppm", .scale = 2e-5, .errors_cannot_be_told = true},
          {.name = "noise 3 times the stated", .noise_is_known = true, .noise_factor = 3.0},
          {.name = "noise a third of the stated", .noise_is_known = true, .noise_factor = 1.0 / 3.0},
          {.name = "Student t3", .student = true},
          {.name = "10 % at 5 sigma", .gross_share = 0.1}};
}

Bench bench_of(Robot robot, int candidates) {
  constexpr std::uint64_t kPlanSeed = 7, kOtherSeed = 11;
  std::vector<Station> selected =
      select_stations(robot, candidate_stations(robot, candidates, kPlanSeed), {.poses = 20}).stations;
  std::vector<Station> others = candidate_stations(robot, 40, kOtherSeed);
  return {std::move(robot), std::move(selected), std::move(others)};
}

Judgement judge_world(const Bench& bench, const World& world, int first, int count, bool with_oracle) {
  Judgement all;
  for (int number = first; number < first + count; ++number) judge_machine(bench, world, number, with_oracle, all);
  return all;
}

}  // namespace paracal::test
