#include "paracal/compensation/pose_correction.hpp"

#include "paracal/compensation/parameters.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal {
namespace {

PoseCorrector of_level_plate(const Robot& robot, const KnownErrors& known, CompensationWay way,
                             const Robot& controller) {
  const Compensator<double> compensator(compensator_parameters(robot, known.errors), way);
  std::optional<CompensatorCovariance<double>> covariance;
  if (known.covariance.size() > 0) {
    covariance = compensator_covariance(robot, known.parameters, known.pose_covariance());
  }
  return [=](const Pose& wanted) {
    const CompensatorPose<double> pose = compensator_pose(wanted);
    CompensatorJoints<double> joints{};
    CorrectedPose found;
    found.status = compensator.compensate(pose, joints, &found.tilt);
    if (found.status != CompensationStatus::ok) return found;
    found.joints = compensated_joints(robot, joints);
    found.target = corrected_target(controller, found.joints, wanted);
    CompensatorUncertainty<double> U;
    if (covariance && stated_uncertainty(compensator.parameters(), *covariance, pose, U) == CompensationStatus::ok) {
      found.uncertainty = {{U.x, U.y, U.z}, U.phi};
    }
    return found;
  };
}

CompensationStatus status_of(InverseStatus status) {
  if (status == InverseStatus::reached) return CompensationStatus::ok;
  return status == InverseStatus::unreachable ? CompensationStatus::unreachable : CompensationStatus::singular;
}

PoseCorrector of_six_freedoms(const Robot& robot, const KnownErrors& known, const Robot& controller) {
  const Eigen::MatrixXd covariance = known.covariance.size() > 0 ? known.pose_covariance() : Eigen::MatrixXd();
  return [=, actual = build(robot, known.errors), parameters = known.parameters](const Pose& wanted) {
    CorrectedPose found;
    found.status = CompensationStatus::not_finite;
    if (!wanted.position.allFinite() || !wanted.tilt.allFinite()) return found;
    const InverseResult solution = inverse(actual, wanted);
    found.status = status_of(solution.status);
    if (!solution.ok()) return found;
    found.joints = solution.joints;
    found.target = corrected_target(controller, found.joints, wanted);
    if (const auto U = plate_uncertainty(actual, plate_at(actual, wanted), found.joints, parameters, covariance)) {
      found.uncertainty = {U->head<3>(), 0.0, U->tail<3>()};
    }
    return found;
  };
}

}  // namespace

PoseCorrector pose_corrector(const Robot& robot, const KnownErrors& known, CompensationWay way,
                             const Robot& controller) {
  if (robot.is_level()) return of_level_plate(robot, known, way, controller);
  if (way == CompensationWay::exact) return of_six_freedoms(robot, known, controller);
  throw InvalidArgument(
      "way: expected exact: the linear methods are for plates that three or four parallelograms keep level");
}

PoseCorrector pose_corrector(const Robot& robot, const KnownErrors& known, CompensationWay way) {
  return pose_corrector(robot, known, way, robot);
}

}  // namespace paracal
