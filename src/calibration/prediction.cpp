#include "paracal/calibration/prediction.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "distance_geometry.hpp"
#include "observation.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "sought.hpp"

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
  return displacements - motions * motions.colPivHouseholderQr().solve(displacements);
}

Eigen::VectorXd variances(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& covariance) {
  return (rows * covariance).cwiseProduct(rows).rowwise().sum().cwiseMax(0.0);  // rounding may leave a zero below
}

}  // namespace

KnownErrors known_errors(const Calibration& calibration) {
  KnownErrors known{calibration.errors(), {}, calibration.covariance};
  for (const ParameterEstimate& one : calibration.parameters) known.parameters.push_back({one.limb, one.source});
  return known;
}

KnownErrors promised(const Robot& robot, const Measurements& given, const CalibrationOptions& options) {
  check(given, robot.limb_count());
  const Measurements plan = detail::as_points(given).value_or(given);
  detail::Observation observation(robot, plan, options, detail::all_with_priors(robot, options));
  const auto start = observation.start({});
  InformationRoot root(observation.unknown_count());
  if (!start || !detail::with_priors(observation)(*start, root)) {
    throw InvalidArgument("the nominal machine does not close at every station");
  }
  const Eigen::Index n = observation.source_count();
  return {{}, observation.sought(), inverse_information(root.root()).bottomRightCorner(n, n)};
}

Eigen::MatrixXd pose_jacobian(const Machine& machine, const Joints& joints,
                              const std::vector<SoughtSource>& parameters) {
  const ForwardResult pose = forward(machine, joints);
  const ExactJacobian exact = exact_jacobian(machine, pose.plate, joints);
  if (!pose.usable() || !exact.ok) return {};
  Eigen::MatrixXd jacobian(4, static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const auto sensitivity = exact.plate.col(ExactJacobian::column(parameters[k].limb, parameters[k].source));
    jacobian.col(column).head<3>() = sensitivity.head<3>();
    jacobian(3, column) = machine.has_slide() ? machine.rotation_of(sensitivity(3)) : 0.0;
  }
  return jacobian;
}

PredictedPose predict(const Robot& robot, const KnownErrors& known, const Joints& joints) {
  const Machine machine = build(robot, known.errors);
  const ForwardResult result = forward(machine, joints);
  const Eigen::MatrixXd jacobian = pose_jacobian(machine, joints, known.parameters);
  if (!result.usable() || jacobian.rows() == 0) throw Unreachable("the machine does not close at these joints");
  return {{result.plate.position, machine.rotation_of(result.plate.slide)},
          jacobian * known.covariance * jacobian.transpose()};
}

PoseSpread::PoseSpread(const Robot& robot, const SourceErrors& errors, const std::vector<SoughtSource>& parameters,
                       const std::vector<Station>& stations) {
  const Machine machine = build(robot, errors);
  const auto n = static_cast<Eigen::Index>(parameters.size()), poses = static_cast<Eigen::Index>(stations.size());
  Eigen::MatrixXd displacements(3 * poses, n), rotations(poses, n);
  std::vector<Eigen::Vector3d> points;
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const Joints joints = believed_joints(robot, stations[k]);
    const Eigen::MatrixXd jacobian = pose_jacobian(machine, joints, parameters);
    if (jacobian.rows() == 0) throw Unreachable(fmt::format("station \"{}\": singular", stations[k].name));
    displacements.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = jacobian.topRows<3>();
    rotations.row(static_cast<Eigen::Index>(k)) = jacobian.row(3);
    points.push_back(forward(machine, joints).plate.position);
  }
  aligned_ = without_rigid_motion(displacements, points);
  distance_.resize(poses - 1, n);
  rotation_.resize(poses - 1, n);
  for (Eigen::Index k = 1; k < poses; ++k) {
    const Eigen::Vector3d direction = (points[static_cast<std::size_t>(k)] - points[0]).normalized();
    distance_.row(k - 1) = direction.transpose() * (displacements.middleRows<3>(3 * k) - displacements.topRows<3>());
    rotation_.row(k - 1) = rotations.row(k) - rotations.row(0);
  }
}

std::vector<PoseStd> PoseSpread::each(const Eigen::MatrixXd& covariance) const {
  const Eigen::VectorXd distance = variances(distance_, covariance), aligned = variances(aligned_, covariance),
                        rotation = variances(rotation_, covariance);
  std::vector<PoseStd> poses(static_cast<std::size_t>(aligned.size() / 3));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    poses[k].aligned = std::sqrt(aligned.segment<3>(3 * row).sum());
    if (k == 0) continue;
    poses[k].distance = std::sqrt(distance(row - 1));
    poses[k].rotation = std::sqrt(rotation(row - 1));
  }
  return poses;
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
  return aligned_.transpose() * aligned_ / (static_cast<double>(aligned_.rows()) / 3.0) +
         lever * lever / static_cast<double>(rotation_.rows()) * (rotation_.transpose() * rotation_);
}

}  // namespace paracal
