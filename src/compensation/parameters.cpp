#include "paracal/compensation/parameters.hpp"

#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/level.hpp"
#include "paracal/mechanism/machine.hpp"

namespace paracal {
namespace {

static_assert(kCompensatorLimbs <= kMaxLimbs);

template <typename Scalar>
CompensatorVector<Scalar> rounded(const Eigen::Vector3d& v) {
  return {static_cast<Scalar>(v.x()), static_cast<Scalar>(v.y()), static_cast<Scalar>(v.z())};
}

template <typename Scalar>
CompensatorLimb<Scalar> compensator_limb(const Machine& machine, const Limb& limb) {
  CompensatorLimb<Scalar> constants;
  constants.base = rounded<Scalar>(limb.base);
  constants.radial = rounded<Scalar>(limb.frame.col(0));
  constants.normal = rounded<Scalar>(limb.frame.col(1));
  constants.axis = rounded<Scalar>(limb.frame.col(2));
  constants.plate = rounded<Scalar>(limb.plate);
  constants.slide = rounded<Scalar>(limb.slide_sign * machine.pinion_radius * machine.slide_axis);
  constants.elbow_half = rounded<Scalar>(0.5 * limb.elbow_width * limb.elbow_frame.col(2));
  constants.plate_half = rounded<Scalar>(0.5 * limb.plate_width * limb.plate_frame.col(2));
  constants.rod = {static_cast<Scalar>(limb.rod[0]), static_cast<Scalar>(limb.rod[1])};
  constants.arm = static_cast<Scalar>(limb.arm);
  constants.on_rail = limb.actuator == Actuator::linear ? Scalar(1) : Scalar(0);
  constants.joint_per_mm = static_cast<Scalar>(1.0 / limb.gain);
  constants.joint_offset = static_cast<Scalar>(limb.joint_offset);
  return constants;
}

}  // namespace

template <typename Scalar>
CompensatorParameters<Scalar> compensator_parameters(const Robot& robot, const SourceErrors& errors) {
  check_level(robot, "compensator");
  const Machine identified = build(robot, errors);
  CompensatorParameters<Scalar> parameters;
  parameters.limb_count = static_cast<std::uint32_t>(identified.limb_count);
  parameters.tilts_plate = identified.tilts_plate ? 1 : 0;
  for (std::size_t i = 0; i < identified.limb_count; ++i) {
    parameters.identified[i] = compensator_limb<Scalar>(identified, identified.limbs[i]);
    parameters.nominal[i] = compensator_limb<Scalar>(robot.nominal(), robot.nominal().limbs[i]);
    const std::span<const Source> own = sources_of(robot.actuator());
    for (std::size_t k = 0; k < own.size(); ++k) {
      const auto error = static_cast<Scalar>(robot.parameter(i, own[k]).lever * errors(i, own[k]));
      constexpr std::size_t kPosition = ErrorModel::kPosition;
      (k < kPosition ? parameters.position_errors[i][k] : parameters.tilt_errors[i][k - kPosition]) = error;
    }
  }
  return parameters;
}

template CompensatorParameters<double> compensator_parameters(const Robot& robot, const SourceErrors& errors);
template CompensatorParameters<float> compensator_parameters(const Robot& robot, const SourceErrors& errors);

template CompensationStatus compensate(const CompensatorParameters<double>& parameters, CompensationWay way,
                                       const CompensatorPose<double>& pose, CompensatorJoints<double>& joints,
                                       CompensatorTilt<double>* tilt) noexcept;

Joints compensated_joints(const Robot& robot, const CompensatorJoints<double>& joints) {
  Joints vector(static_cast<Eigen::Index>(robot.limb_count()));
  for (std::size_t i = 0; i < robot.limb_count(); ++i) vector(static_cast<Eigen::Index>(i)) = joints[i];
  return vector;
}

std::optional<Pose> corrected_target(const Robot& robot, const Joints& joints, const Pose& wanted) {
  const PlateState start = plate_at(robot.nominal(), wanted);
  const ForwardResult nominal = forward(robot.nominal(), joints, {.start = start});
  if (!nominal.ok()) return std::nullopt;
  return pose_of(robot.nominal(), nominal.plate);
}

}  // namespace paracal
