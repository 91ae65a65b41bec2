#include "paracal/compensation/pose_correction.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_error.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal {
namespace {

CompensationStatus status_of(InverseStatus status) {
  if (status == InverseStatus::reached) return CompensationStatus::ok;
  return status == InverseStatus::unreachable ? CompensationStatus::unreachable : CompensationStatus::singular;
}

using JointFinder = std::function<CorrectedPose(const Pose& wanted)>;

/// As `inverse --errors` has them.
JointFinder exact_joints(const Machine& actual, const DriveCurves& drives) {
  return [=](const Pose& wanted) {
    CorrectedPose found{.status = CompensationStatus::not_finite, .joints = {}};
    if (!wanted.position.allFinite() || !wanted.tilt.allFinite() || !std::isfinite(wanted.rotation)) return found;
    const InverseResult solution = inverse(actual, wanted);
    found.status = status_of(solution.status);
    found.joints = found.status == CompensationStatus::ok ? drives.commanded(solution.joints) : solution.joints;
    found.tilt = {solution.tilt.x(), solution.tilt.y(), solution.tilt.z()};
    return found;
  };
}

JointFinder linear_joints(const Robot& robot, const KnownErrors& known, CompensationWay way) {
  return [=, compensator = Compensator<double>(compensator_parameters(robot, known.errors, known.drives()), way)](
             const Pose& wanted) {
    CompensatorJoints<double> joints{};
    CorrectedPose found;
    found.status = compensator.compensate(closure_pose(wanted), joints, &found.tilt);
    found.joints = compensated_joints(robot, joints);
    return found;
  };
}

using UncertaintyFinder = std::function<std::optional<StatedU>(const Pose& wanted, const Joints& joints)>;

UncertaintyFinder uncertainty_of(const DifferentiableMachine& actual, const KnownErrors& known) {
  if (known.covariance.size() == 0) return [](const Pose&, const Joints&) { return std::nullopt; };
  return [actual, uncertainty = PlateUncertainty(actual, known.parameters, known.pose_covariance())](
             const Pose& wanted, const Joints& joints) -> std::optional<StatedU> {
    const auto U = uncertainty.at(plate_at(actual, wanted), joints);
    if (!U) return {};
    if (actual.is_level) return StatedU{U->head<3>(), (*U)(3)};
    if (!actual.commands_tilt()) return StatedU{U->head<3>()};  // guides hold the angles
    return StatedU{U->head<3>(), 0.0, U->tail<3>()};
  };
}

}  // namespace

PoseCorrector pose_corrector(const Robot& robot, const KnownErrors& known, CompensationWay way,
                             const Robot& controller) {
  if (way != CompensationWay::exact && !robot.is_level()) {
    throw InvalidArgument(
        "way: expected exact: the linear methods are for plates that three or four parallelograms keep level");
  }
  const DifferentiableMachine actual = differentiable(robot, known.errors);
  const JointFinder find_joints =
      way == CompensationWay::exact ? exact_joints(actual, known.drives()) : linear_joints(robot, known, way);
  const UncertaintyFinder find_uncertainty = uncertainty_of(actual, known);
  return [=](const Pose& wanted) {
    CorrectedPose found = find_joints(wanted);
    if (found.status != CompensationStatus::ok) return found;
    found.target = corrected_target(controller, found.joints, wanted);
    found.uncertainty = find_uncertainty(wanted, found.joints);
    return found;
  };
}

double loss_without_drives(const Robot& robot, const KnownErrors& with_drives, const SourceErrors& rigid) {
  const DriveCurves drives = with_drives.drives();
  if (drives.are_even()) return 0.0;
  const Machine held = build(robot, rigid), actual = build(robot, with_drives.errors);
  std::vector<PosePair> pairs;
  for (const Station& station : workspace_stations(robot)) {
    const InverseResult commanded = inverse(held, station.commanded);
    if (!commanded.ok()) continue;
    const ForwardResult reached = forward(actual, drives.actual(commanded.joints));
    if (reached.usable()) pairs.push_back({station.commanded, pose_of(actual, reached.plate)});
  }
  double largest = 0.0;
  for (const PosePair& pair : pairs) {
    largest = std::max(largest, std::abs(error_relative_to(pairs.front(), pair).distance));
  }
  return largest;
}

PoseCorrector pose_corrector(const Robot& robot, const KnownErrors& known, CompensationWay way) {
  return pose_corrector(robot, known, way, robot);
}

}  // namespace paracal
