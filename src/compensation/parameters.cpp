#include "paracal/compensation/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/closure_limb.hpp"
#include "paracal/mechanism/coordinates.hpp"

namespace paracal {
namespace {

static_assert(kCompensatorLimbs == kMaxLimbs);

/// Bit k of coordinate k that a machine can be commanded to: x, y, z, tilt_x, tilt_y, tilt_z, phi.
std::uint32_t commanded(const Machine& machine) {
  std::uint32_t bits = 0;
  for (const std::size_t k : commanded_coordinates(machine)) bits |= 1U << among_seven(machine, k);
  return bits;
}

template <typename Scalar>
DriveCurve<Scalar> in_scalar(const DriveCurve<double>& curve, const TurnCurve<double>& turn) {
  DriveCurve<Scalar> rounded{static_cast<Scalar>(curve.first), static_cast<Scalar>(curve.spacing)};
  std::ranges::transform(curve.sizes, rounded.sizes.begin(), [](double size) { return static_cast<Scalar>(size); });
  rounded.turn = {static_cast<Scalar>(turn.turning), static_cast<Scalar>(turn.sine), static_cast<Scalar>(turn.cosine)};
  return rounded;
}

void check_compensated(const Robot& robot) {
  if (has_compensator(robot)) return;
  throw InvalidArgument(fmt::format(
      "compensator: expected three or four limbs, as many as degrees of freedom, where limbs have two rods, got {}: "
      "command the joints of paracal compensate",
      robot.name()));
}

}  // namespace

bool has_compensator(const Robot& robot) {
  const Machine& machine = robot.nominal();
  const auto limbs = std::span(machine.limbs).first(machine.limb_count);
  return std::ranges::all_of(limbs, &Limb::has_one_rod) || can_settle(machine);
}

template <typename Scalar>
CompensatorParameters<Scalar> compensator_parameters(const Robot& robot, const SourceErrors& errors,
                                                     const DriveCurves& drives) {
  check_compensated(robot);
  const Machine identified = build(robot, errors);
  CompensatorParameters<Scalar> parameters;
  parameters.limb_count = static_cast<std::uint32_t>(identified.limb_count);
  parameters.tilts_plate = identified.tilts_plate ? 1 : 0;
  parameters.is_level = identified.is_level ? 1 : 0;
  parameters.commanded = commanded(identified);
  parameters.held_z.fill(identified.freedoms.holds_z() ? static_cast<Scalar>(identified.guided_z) : Scalar(0));
  for (std::size_t i = 0; i < identified.limb_count; ++i) {
    parameters.identified[i] = closure_limb<Scalar>(identified, i);
    parameters.nominal[i] = closure_limb<Scalar>(robot.nominal(), i);
    parameters.drives[i] = in_scalar<Scalar>(drives.of(i), identified.limbs[i].turn);
    if (!identified.is_level) continue;
    const Eigen::Vector3d radial = radial_of(robot.limbs()[i]);
    for (std::size_t k = 0; k < 3; ++k)
      parameters.radial[i][k] = static_cast<Scalar>(radial[static_cast<Eigen::Index>(k)]);
    constexpr std::size_t kEven = ErrorModel::kPosition + ErrorModel::kTilt;  // harmonics are with the drives
    const std::span<const Source> own = sources_of(robot.actuator()).first(kEven);
    for (std::size_t k = 0; k < own.size(); ++k) {
      const auto error = static_cast<Scalar>(robot.parameter(i, own[k]).lever * errors(i, own[k]));
      constexpr std::size_t kPosition = ErrorModel::kPosition;
      (k < kPosition ? parameters.position_errors[i][k] : parameters.tilt_errors[i][k - kPosition]) = error;
    }
  }
  return parameters;
}

template CompensatorParameters<double> compensator_parameters(const Robot& robot, const SourceErrors& errors,
                                                              const DriveCurves& drives);
template CompensatorParameters<float> compensator_parameters(const Robot& robot, const SourceErrors& errors,
                                                             const DriveCurves& drives);

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
