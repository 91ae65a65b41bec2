// How errors that are known with a covariance spread over poses.

#include <algorithm>
#include <cmath>

#include "largest_errors.hpp"
#include "numerics/dense.hpp"
#include "numerics/square_root.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
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

}  // namespace

PoseSpread::PoseSpread(const Robot& robot, const SourceErrors& errors, const std::vector<SoughtSource>& parameters,
                       const std::vector<Station>& stations) {
  const DifferentiableMachine machine = differentiable(robot, errors);
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

UseOfVisits PoseSpread::worst(const KnownErrors& known, const Eigen::MatrixXd& tolerances) const {
  const Eigen::Index turns = turn_rows(), moving = distance_.rows();
  const auto quantities = [&](const Eigen::MatrixXd& covariance) {
    const Eigen::MatrixXd root = detail::square_root(covariance);
    const auto by = [&](const Eigen::MatrixXd& rows) { return detail::product(rows.leftCols(root.rows()), root); };
    return std::array<detail::PoseQuantity, 3>{{{1, by(distance_), distance_joint_, home_distance_joint_},
                                                {3, by(aligned_), position_joint_, {}},
                                                {turns, by(rotation_), rotation_joint_.bottomRows(turns * moving),
                                                 rotation_joint_.topRows(turns).replicate(moving, 1)}}};
  };
  const detail::DrawnMachines machines(distance_.cols(), position_joint_.cols());
  const auto uses = [&](const Eigen::MatrixXd& covariance, const std::vector<Eigen::VectorXd>& joint_std) {
    std::vector<Use> all(joint_std.size());
    const auto of_each = quantities(covariance);
    for (std::size_t quantity = 0; quantity < of_each.size(); ++quantity) {
      const std::vector<double> largest = machines.largest(of_each[quantity], joint_std);
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (quantity == 2) all[k].rotation.emplace();
        UseQuantity& one = quantity == 0 ? all[k].distance : quantity == 1 ? all[k].aligned : *all[k].rotation;
        one.U = largest[k];
      }
    }
    return all;
  };
  std::vector<Eigen::VectorXd> joint_std{known.joint_std};
  if (known.visit_std.size() > 0) joint_std.push_back(known.joint_std_of_a_visit());
  const std::vector<Use> calibrated = uses(known.expanded_covariance(), joint_std);
  UseOfVisits use{.any = calibrated.back(), .mean = calibrated.front()};
  if (tolerances.size() > 0) use.uncalibrated = uses(tolerances, {Eigen::VectorXd()}).front();
  return use;
}

UseOfVisits use_over_workspace(const Robot& robot, const KnownErrors& known, const Eigen::MatrixXd& tolerances) {
  const PoseSpread spread(robot, known.errors, known.parameters, workspace_stations(robot));
  UseOfVisits use = spread.worst(known, tolerances);
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
