#include "paracal/calibration/prediction.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "distance_geometry.hpp"
#include "numerics/dense.hpp"
#include "numerics/distributions.hpp"
#include "numerics/square_root.hpp"
#include "observation.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/random.hpp"
#include "sought.hpp"
#include "started.hpp"

namespace paracal {
namespace {

/// Removes from stacked displacements (3 rows a point) what a rigid motion of all points explains.
Eigen::MatrixXd without_rigid_motion(const Eigen::MatrixXd& displacements, const std::vector<Eigen::Vector3d>& points) {
  constexpr double kLever = 100.0;  // mm: brings turns and shifts to one size
  Eigen::MatrixXd motions(displacements.rows(), 6);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d p = points[k] / kLever;
    auto block = motions.middleRows<3>(3 * static_cast<Eigen::Index>(k));
    block.leftCols<3>().setIdentity();
    block.rightCols<3>() << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0;
  }
  return displacements - detail::product(motions, detail::least_squares(motions, displacements));
}

/// Of the largest |value| of each column, a machine, what a twentieth of the machines exceeds.
double exceeded_by_a_twentieth(const Eigen::MatrixXd& machines) {
  const Eigen::VectorXd of_each = machines.cwiseAbs().colwise().maxCoeff();
  std::vector<double> largest(of_each.begin(), of_each.end());
  const auto place = largest.begin() + static_cast<std::ptrdiff_t>(largest.size() * 95 / 100);
  std::ranges::nth_element(largest, place);
  return *place;
}

Eigen::VectorXd variances(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& covariance) {
  return detail::product(rows, covariance).cwiseProduct(rows).rowwise().sum().cwiseMax(0.0);  // rounding may leave a
                                                                                              // zero below
}

/// Rows of a pose's rotation: phi, or of a plate with six freedoms its turn about x, y and z of {O}.
Eigen::Index rows_of_a_turn(const Robot& robot) { return robot.commands_tilt() ? 3 : 1; }

Eigen::MatrixXd turns_of(const Machine& machine, const PlateState& plate, const PlateMotions& motions) {
  if (!machine.commands_tilt()) return motions.row(3);
  return plate_rotation(plate.tilt).axes * motions.bottomRows<3>();
}

/// Lengths of vectors that stand below each other, so many rows each.
Eigen::MatrixXd lengths(const Eigen::MatrixXd& vectors, Eigen::Index rows) {
  return vectors.reshaped(rows, vectors.size() / rows).colwise().norm().reshaped(vectors.rows() / rows, vectors.cols());
}

}  // namespace

double SplineKnot::at(double joint) const {
  const double x = std::abs(joint - centre) / spacing;
  if (x >= 2.0) return 0.0;
  const double rest = 2.0 - x;
  return x < 1.0 ? 2.0 / 3.0 - x * x * (1.0 - 0.5 * x) : rest * rest * rest / 6.0;
}

double coverage_factor(double dof) {
  constexpr double kEachTail = 0.02275;  // of a standard normal variable beyond 2
  constexpr double kMany = 1e6,
                   kFewest = 0.1;  // of fewer, which only a fit that diverged has, no number is large enough
  if (!(dof < kMany)) return kCoverageFactor;
  return detail::students_t_quantile(kEachTail, std::max(dof, kFewest));
}

Eigen::MatrixXd KnownErrors::expanded_covariance() const {
  if (noise_covariance.size() == 0) return covariance;
  const double wider = std::pow(coverage_factor(noise_dof) / kCoverageFactor, 2) - 1.0;
  Eigen::MatrixXd expanded = covariance;
  expanded.topLeftCorner(noise_covariance.rows(), noise_covariance.cols()) += wider * noise_covariance;
  return expanded;
}

Eigen::VectorXd KnownErrors::joint_std_of_a_visit() const {
  if (visit_std.size() == 0) return joint_std;
  return joint_std.size() == 0 ? visit_std : (joint_std.cwiseAbs2() + visit_std.cwiseAbs2()).cwiseSqrt();
}

Eigen::MatrixXd KnownErrors::pose_covariance() const {
  Eigen::MatrixXd all = expanded_covariance();
  const Eigen::VectorXd joints = joint_std_of_a_visit();
  for (std::size_t k = 0; joints.size() > 0 && all.size() > 0 && k < parameters.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    if (parameters[k].knot || !is_joint_zero(parameters[k].source)) continue;
    all(at, at) += std::pow(joints(static_cast<Eigen::Index>(parameters[k].limb)), 2);
  }
  return all;
}

KnownErrors known_errors(const Calibration& calibration) {
  KnownErrors known{.errors = calibration.errors(),
                    .parameters = {},
                    .covariance = calibration.covariance,
                    .noise_covariance = calibration.noise_covariance,
                    .noise_dof = calibration.noise_dof,
                    .joint_std = calibration.joint_std,
                    .visit_std = calibration.visit_std};
  for (const ParameterEstimate& one : calibration.parameters) known.parameters.push_back({one.limb, one.source});
  add_drives(calibration.drives, calibration.drive_covariance, known);
  return known;
}

void add_drives(const std::vector<SoughtSource>& drives, const Eigen::MatrixXd& covariance, KnownErrors& known) {
  if (drives.empty() || known.covariance.size() == 0) return;
  const Eigen::Index n = known.covariance.rows(), more = covariance.rows();
  known.parameters.insert(known.parameters.end(), drives.begin(), drives.end());
  known.covariance.conservativeResize(n + more, n + more);
  known.covariance.bottomRows(more) = covariance;
  known.covariance.topRightCorner(n, more) = covariance.leftCols(n).transpose();
}

KnownErrors promised(const Robot& robot, const Measurements& given, const CalibrationOptions& options) {
  check(given, robot.limb_count());
  const Measurements plan = detail::as_points(given).value_or(given);
  detail::Observation observation(robot, plan, options, detail::all_with_priors(robot, options), true);
  const auto start = observation.start({});
  InformationRoot root(observation.unknown_count());
  if (!start || !detail::with_priors(observation)(*start, root)) {
    throw detail::not_closed(robot, robot.nominal(), plan.stations);
  }
  const Eigen::Index n = observation.source_count();
  return {{}, observation.sought(), inverse_information(root.root()).bottomRightCorner(n, n)};
}

PlateMotions plate_jacobian(const Machine& machine, const PlateState& plate, const Joints& joints,
                            const std::vector<SoughtSource>& parameters) {
  const ExactJacobian exact = exact_jacobian(machine, plate, joints);
  PlateMotions motions(7, exact.ok ? static_cast<Eigen::Index>(parameters.size()) : 0);
  for (Eigen::Index k = 0; k < motions.cols(); ++k) {
    const SoughtSource& one = parameters[static_cast<std::size_t>(k)];
    const double share = one.knot ? one.knot->at(joints(static_cast<Eigen::Index>(one.limb))) : 1.0;
    const Eigen::VectorXd sensitivity =
        share * exact.plate.col(static_cast<Eigen::Index>(machine.parameter(one.limb, one.source)));
    motions.col(k).head<3>() = sensitivity.head<3>();
    motions(3, k) = machine.has_slide() ? machine.rotation_of(sensitivity(3)) : 0.0;
    motions.col(k).tail<3>() = sensitivity.tail<3>();
  }
  return motions;
}

namespace {

/// Of a plate that stands there with these joints.
Eigen::MatrixXd pose_jacobian_at(const Machine& machine, const PlateState& plate, const Joints& joints,
                                 const std::vector<SoughtSource>& parameters) {
  const PlateMotions motions = plate_jacobian(machine, plate, joints, parameters);
  if (motions.cols() == 0 && !parameters.empty()) return {};
  if (!machine.commands_tilt()) return motions.topRows<4>();
  Eigen::MatrixXd commanded(6, motions.cols());
  commanded << motions.topRows<3>(), motions.bottomRows<3>();
  return commanded;
}

}  // namespace

Eigen::MatrixXd pose_jacobian(const Machine& machine, const Joints& joints,
                              const std::vector<SoughtSource>& parameters) {
  const ForwardResult pose = forward(machine, joints);
  return pose.usable() ? pose_jacobian_at(machine, pose.plate, joints, parameters) : Eigen::MatrixXd();
}

PredictedPose predict(const Robot& robot, const KnownErrors& known, const Joints& joints,
                      const ForwardOptions& options) {
  const Machine machine = build(robot, known.errors);
  const ForwardResult result = forward(machine, joints, options);
  if (!result.usable()) throw Unreachable("no solution: " + why_no_pose(machine, result));
  const Eigen::MatrixXd jacobian = pose_jacobian_at(machine, result.plate, joints, known.parameters);
  if (jacobian.rows() == 0) throw Unreachable("no solution: the plate can move with fixed joints");
  return {pose_of(machine, result.plate),
          detail::product(detail::product(jacobian, known.pose_covariance()), jacobian.transpose())};
}

PoseSpread::PoseSpread(const Robot& robot, const SourceErrors& errors, const std::vector<SoughtSource>& parameters,
                       const std::vector<Station>& stations) {
  const Machine machine = build(robot, errors);
  const auto n = static_cast<Eigen::Index>(parameters.size()), poses = static_cast<Eigen::Index>(stations.size());
  const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
  const Eigen::Index turns = rows_of_a_turn(robot);
  Eigen::MatrixXd displacements(3 * poses, n), rotations(turns * poses, n);
  position_joint_.resize(3 * poses, limbs);
  rotation_joint_.resize(turns * poses, limbs);
  std::vector<SoughtSource> with_joints = parameters;  // a joint that stands elsewhere is one whose zero lies elsewhere
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb)
    with_joints.push_back({limb, joint_zero(robot.nominal().limbs[limb].actuator)});
  std::vector<Eigen::Vector3d> points;
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const Joints joints = believed_joints(robot, stations[k]);
    const ForwardResult pose = forward(machine, joints, detail::started(robot, stations[k]));
    const PlateMotions jacobian = plate_jacobian(machine, pose.plate, joints, with_joints);
    if (!pose.usable() || jacobian.cols() == 0) {
      throw Unreachable(named(stations[k]) + ": singular");
    }
    displacements.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = jacobian.topLeftCorner(3, n);
    const Eigen::MatrixXd turned = turns_of(machine, pose.plate, jacobian);
    rotations.middleRows(turns * static_cast<Eigen::Index>(k), turns) = turned.leftCols(n);
    position_joint_.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = jacobian.topRightCorner(3, limbs);
    rotation_joint_.middleRows(turns * static_cast<Eigen::Index>(k), turns) = turned.rightCols(limbs);
    points.push_back(pose.plate.position);
  }
  aligned_ = without_rigid_motion(displacements, points);
  distance_.resize(poses - 1, n);
  rotation_.resize(turns * (poses - 1), n);
  distance_joint_.resize(poses - 1, limbs);
  home_distance_joint_.resize(poses - 1, limbs);
  for (Eigen::Index k = 1; k < poses; ++k) {
    const Eigen::Vector3d direction = (points[static_cast<std::size_t>(k)] - points[0]).normalized();
    distance_.row(k - 1) =
        direction.transpose().lazyProduct(displacements.middleRows<3>(3 * k) - displacements.topRows<3>());
    rotation_.middleRows(turns * (k - 1), turns) = rotations.middleRows(turns * k, turns) - rotations.topRows(turns);
    distance_joint_.row(k - 1) = direction.transpose().lazyProduct(position_joint_.middleRows<3>(3 * k));
    home_distance_joint_.row(k - 1) = direction.transpose().lazyProduct(position_joint_.topRows<3>());
  }
}

std::vector<PoseStd> PoseSpread::each(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& joint_std) const {
  const Eigen::VectorXd distance = variances(distance_, covariance), aligned = variances(aligned_, covariance),
                        turn = variances(rotation_, covariance);
  const Eigen::VectorXd joints =
      joint_std.size() > 0 ? joint_std : Eigen::VectorXd(Eigen::VectorXd::Zero(position_joint_.cols()));
  const auto squares = [&](const auto& rows) { return (rows * joints.asDiagonal()).squaredNorm(); };
  const Eigen::Index turns = turn_rows();
  std::vector<PoseStd> poses(static_cast<std::size_t>(aligned.size() / 3));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    poses[k].aligned = std::sqrt(aligned.segment<3>(3 * row).sum() + squares(position_joint_.middleRows<3>(3 * row)));
    if (k == 0) continue;
    poses[k].distance = std::sqrt(distance(row - 1) + squares(distance_joint_.row(row - 1)) +
                                  squares(home_distance_joint_.row(row - 1)));
    poses[k].rotation =
        std::sqrt(turn.segment(turns * (row - 1), turns).sum() +
                  squares(rotation_joint_.middleRows(turns * row, turns)) + squares(rotation_joint_.topRows(turns)));
  }
  return poses;
}

Use PoseSpread::worst_of(Spread machines, const Eigen::VectorXd& joint_std) const {
  // Drawn once and dealt out anew to each machine and pose: drawing as many as there are poses would cost more than all
  // else. A prime number of them, so that they meet the poses in turn.
  constexpr Eigen::Index kPool = 4099, kStride = 1787;
  constexpr std::uint64_t kSeed = 96;
  const Eigen::Index poses = aligned_.rows() / 3, turns = turn_rows(), joints = joint_std.size();
  if (joints > 0 && joint_std.maxCoeff() > 0.0) {
    RandomStream random(kSeed);
    const Eigen::MatrixXd pool =
        joint_std.asDiagonal() * Eigen::MatrixXd::NullaryExpr(joints, kPool, [&] { return random.normal(); });
    Eigen::MatrixXd off(joints, poses);
    for (Eigen::Index machine = 0; machine < machines.aligned.cols(); ++machine) {
      for (Eigen::Index k = 0; k < poses; ++k) off.col(k) = pool.col((machine * poses + k) * kStride % kPool);
      for (Eigen::Index k = 0; k < poses; ++k) {
        machines.aligned.col(machine).segment<3>(3 * k) += position_joint_.middleRows<3>(3 * k).lazyProduct(off.col(k));
        if (k == 0) continue;
        machines.distances(k - 1, machine) +=
            distance_joint_.row(k - 1).dot(off.col(k)) - home_distance_joint_.row(k - 1).dot(off.col(0));
        machines.rotations.col(machine).segment(turns * (k - 1), turns) +=
            rotation_joint_.middleRows(turns * k, turns).lazyProduct(off.col(k)) -
            rotation_joint_.topRows(turns).lazyProduct(off.col(0));
      }
    }
  }
  return {.distance = {exceeded_by_a_twentieth(machines.distances)},
          .aligned = {exceeded_by_a_twentieth(lengths(machines.aligned, 3))},
          .rotation = UseQuantity{exceeded_by_a_twentieth(lengths(machines.rotations, turns))}};
}

PoseSpread::Spread PoseSpread::drawn(const Eigen::MatrixXd& covariance) const {
  constexpr Eigen::Index kMachines = 1000;
  constexpr std::uint64_t kSeed = 95;
  RandomStream random(kSeed);
  const Eigen::MatrixXd root = detail::square_root(covariance);
  const Eigen::Index n = root.cols();
  const Eigen::MatrixXd errors =
      detail::product(root, Eigen::MatrixXd::NullaryExpr(n, kMachines, [&] { return random.normal(); }));
  return {detail::product(distance_.leftCols(n), errors), detail::product(aligned_.leftCols(n), errors),
          detail::product(rotation_.leftCols(n), errors)};
}

Use PoseSpread::worst_of_tolerances(const Eigen::MatrixXd& covariance) const { return worst_of(drawn(covariance), {}); }

UseOfVisits PoseSpread::worst(const KnownErrors& known) const {
  const Spread machines = drawn(known.expanded_covariance());
  UseOfVisits use{.any = {}, .mean = worst_of(machines, known.joint_std)};
  use.any = known.visit_std.size() > 0 ? worst_of(machines, known.joint_std_of_a_visit()) : use.mean;
  return use;
}

UseOfVisits use_over_workspace(const Robot& robot, const KnownErrors& known, const Eigen::MatrixXd& tolerances) {
  const PoseSpread spread(robot, known.errors, known.parameters, workspace_stations(robot));
  UseOfVisits use = spread.worst(known);
  if (tolerances.size() > 0) use.uncalibrated = spread.worst_of_tolerances(tolerances);
  if (!robot.slide() && !robot.commands_tilt()) {
    use.any.rotation.reset();
    use.mean.rotation.reset();
    if (use.uncalibrated) use.uncalibrated->rotation.reset();
  }
  return use;
}

WorkspaceUncertainty PoseSpread::uncertainty(const Eigen::MatrixXd& covariance) const {
  const std::vector<PoseStd> poses = each(covariance);
  const auto largest = [&](double PoseStd::*what) { return std::ranges::max(poses, {}, what).*what; };
  const auto rms = [&](double PoseStd::*what, std::size_t count) {
    double sum = 0.0;
    for (const PoseStd& one : poses) sum += one.*what * one.*what;
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
  };
  const std::size_t but_home = poses.size() - 1;
  return {.rms_distance = rms(&PoseStd::distance, but_home),
          .max_distance = largest(&PoseStd::distance),
          .rms_aligned = rms(&PoseStd::aligned, poses.size()),
          .max_aligned = largest(&PoseStd::aligned),
          .rms_rotation = rms(&PoseStd::rotation, but_home),
          .max_rotation = largest(&PoseStd::rotation)};
}

Eigen::MatrixXd PoseSpread::mean_square(double lever) const {
  return detail::product(aligned_.transpose(), aligned_) / (static_cast<double>(aligned_.rows()) / 3.0) +
         lever * lever * static_cast<double>(turn_rows()) / static_cast<double>(rotation_.rows()) *
             detail::product(rotation_.transpose(), rotation_);
}

}  // namespace paracal
