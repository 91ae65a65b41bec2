#include "paracal/kinematics/inverse.hpp"

#include <Eigen/LU>
#include <cmath>

#include "guides.hpp"
#include "linear_closure.hpp"

namespace paracal {
namespace {

void take(InverseResult& result, std::size_t limb, const JointSolution& solution) {
  result.joints(static_cast<Eigen::Index>(limb)) = solution.joint;
  if (!solution.reached && result.unreachable_limb < 0) {
    result.status = InverseStatus::unreachable;
    result.unreachable_limb = static_cast<int>(limb);
  }
}

/// Closed form on struts, with all their errors; as solve_joint(), but roots and quotients of all struts together.
InverseResult strut_inverse(const Machine& machine, const Pose& pose) {
  using PerStrut = Eigen::Array<double, kMaxLimbs, 1>;
  const Eigen::Matrix3d rotation = plate_rotation(pose.tilt).matrix;
  PerStrut square, zero, gain;
  for (Eigen::Index i = 0; i < kMaxLimbs; ++i) {
    const Limb& limb = machine.limbs[static_cast<std::size_t>(i)];
    square(i) = (pose.position + rotation * limb.plate - limb.base).squaredNorm();
    zero(i) = limb.rod[0] + limb.joint_offset;
    gain(i) = limb.gain;
  }
  const PerStrut joints = (square.sqrt() - zero) / gain;
  InverseResult result{.status = InverseStatus::reached, .joints = joints};
  if (joints.isFinite().all()) return result;
  for (Eigen::Index i = 0; i < kMaxLimbs; ++i) {
    take(result, static_cast<std::size_t>(i), {joints(i), std::isfinite(joints(i))});
  }
  return result;
}

/// Closed form of arms and carriages with one rod, with all their errors.
InverseResult rod_inverse(const Machine& machine, const Pose& pose) {
  const Eigen::Matrix3d rotation = plate_rotation(pose.tilt).matrix;
  InverseResult result;
  result.joints.resize(static_cast<Eigen::Index>(machine.limb_count));
  result.status = InverseStatus::reached;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    take(result, i, solve_joint(limb, pose.position + rotation * limb.plate));
  }
  return result;
}

InverseResult closed_inverse(const Machine& machine, const Pose& pose) {
  const bool six_struts = machine.actuator() == Actuator::strut && !machine.has_guides();
  return six_struts ? strut_inverse(machine, pose) : rod_inverse(machine, pose);
}

/// Closed form on the centre lines of the limbs, plate level.
InverseResult level_inverse(const Machine& machine, const Pose& pose) {
  InverseResult result;
  result.joints.resize(static_cast<Eigen::Index>(machine.limb_count));
  result.status = InverseStatus::reached;
  const Eigen::Vector3d slide = machine.slide_of(pose.rotation) * machine.slide_axis;
  if (machine.actuator() == Actuator::linear) {
    for (std::size_t i = 0; i < machine.limb_count; ++i) {
      const Limb& limb = machine.limbs[i];
      take(result, i, solve_joint(limb, pose.position + limb.plate + limb.slide_sign * slide));
    }
    return result;
  }
  // All triangles before the first arctangent: the short chains of arithmetic then overlap, limb with limb.
  std::array<ArmDirection<double>, kMaxLimbs> direction;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    direction[i] = close_triangle(limb, pose.position + limb.plate + limb.slide_sign * slide);
  }
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    take(result, i, arm_along(machine.limbs[i], direction[i]));
  }
  return result;
}

/// Newton on joints and tilt, position and slide held on the pose, until the closure is at its least-squares answer:
///
///   J^T (f + J_q dq + J_tilt dtilt) = 0        N + 3 equations in N + 3 unknowns
template <int N>
void settle(const Machine& machine, const Pose& pose, InverseResult& result) {
  constexpr int kMaxIterations = 20;
  constexpr double kTolerance = 4e-9;  // mm at the elbows, of the last step: converges linearly at about 1e-5 a step
  const double ratio = joint_ratio(machine.limbs[0]);
  PlateState plate;
  plate.position = pose.position;
  plate.slide = machine.slide_of(pose.rotation);
  result.status = InverseStatus::not_converged;
  while (result.iterations < kMaxIterations) {
    const detail::Elbows<N> elbows = detail::elbows_of<N>(machine, result.joints);
    const detail::LinearClosure<N> linear = detail::linearize<N>(machine, plate, elbows);
    detail::NormalMatrix<N> system;  // J^T (J_q, J_tilt); joint i acts on the two rods of limb i
    for (int i = 0; i < N; ++i) {
      const Limb& limb = machine.limbs[i];
      system.col(i).setZero();
      for (int row = 2 * i; row < 2 * i + 2; ++row) {
        const Eigen::Vector3d motion = hinge_motion(limb, elbows[i], static_cast<std::size_t>(row % 2));
        system.col(i) -= linear.jacobian.row(row).transpose() * linear.direction[row].dot(motion);
      }
    }
    system.template rightCols<3>() = linear.jacobian.transpose().lazyProduct(linear.jacobian.template rightCols<3>());
    const detail::Unknowns<N> step = -system.partialPivLu().solve(linear.gradient());
    result.joints += step.template head<N>();
    plate.tilt += step.template tail<3>();
    ++result.iterations;
    const double joint_step = ratio * step.template head<N>().cwiseAbs().maxCoeff();
    if (!std::isfinite(joint_step)) return;
    if (joint_step < kTolerance) {
      result.status = InverseStatus::reached;
      return;
    }
  }
}

}  // namespace

InverseResult inverse(const Machine& machine, const Pose& pose) noexcept {
  InverseResult result = machine.on_single_rods() ? closed_inverse(machine, pose) : level_inverse(machine, pose);
  const bool turns = pose.rotation != 0.0, leans = !pose.tilt.isZero(0.0);
  const bool held = machine.has_guides() && !detail::is_free(machine, pose);
  if ((!machine.has_slide() && turns) || (!machine.on_single_rods() && leans) || held) {
    result.status = InverseStatus::unreachable;
  }
  if (result.ok() && machine.tilts_plate) {
    detail::with_pair_count(machine.limb_count, [&]<int N>() { settle<N>(machine, pose, result); });
  }
  return result;
}

}  // namespace paracal
