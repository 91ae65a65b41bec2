#include "paracal/kinematics/inverse.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "linear_closure.hpp"

namespace paracal {
namespace {

/// Closed form on the centre lines of the limbs, plate level.
InverseResult level_inverse(const Machine& machine, const Pose& pose) {
  InverseResult result;
  result.joints.resize(static_cast<Eigen::Index>(machine.limb_count));
  result.status = InverseStatus::reached;
  const Eigen::Vector3d slide = machine.slide_of(pose.rotation) * machine.slide_axis;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    const ArmSolution arm = solve_arm(limb, pose.position + limb.plate + limb.slide_sign * slide);
    result.joints(static_cast<Eigen::Index>(i)) = arm.joint;
    if (!arm.reached && result.unreachable_limb < 0) {
      result.status = InverseStatus::unreachable;
      result.unreachable_limb = static_cast<int>(i);
    }
  }
  return result;
}

/// Moves joints and tilt together until the closure's least-squares answer has its position and slide on the pose:
///   forward step at fixed joints  dx = -H^-1 J^T f,   effect of joints  dx = -H^-1 J^T J_q dq = -M dq,
///   dq from the position-and-slide rows of  (x + dx - M dq) = target.
template <int N>
void settle(const Machine& machine, const Pose& pose, InverseResult& result) {
  constexpr int kMaxIterations = 20;
  constexpr double kTolerance = 1e-11;  // of the last step in rad: converges linearly at about 1e-5 a step
  PlateState plate;
  plate.position = pose.position;
  plate.slide = machine.slide_of(pose.rotation);
  result.status = InverseStatus::not_converged;
  while (result.iterations < kMaxIterations) {
    const detail::Elbows<N> elbows = detail::elbows_of<N>(machine, result.joints);
    const detail::LinearClosure<N> linear = detail::linearize<N>(machine, plate, elbows);
    Eigen::Matrix<double, N + 3, N> joints_to_gradient;  // J^T J_q; joint i acts on the two rods of limb i
    for (int i = 0; i < N; ++i) {
      const Limb& limb = machine.limbs[i];
      joints_to_gradient.col(i).setZero();
      for (int row = 2 * i; row < 2 * i + 2; ++row) {
        const Eigen::Vector3d motion = limb.frame.col(2).cross(elbows[i].joint[row % 2] - limb.base);
        joints_to_gradient.col(i) -= linear.jacobian.row(row).transpose() * linear.direction[row].dot(motion);
      }
    }
    const Eigen::LLT<detail::NormalMatrix<N>> normal(linear.normal());
    if (normal.info() != Eigen::Success) return;
    const detail::Unknowns<N> free_step = -normal.solve(linear.gradient());
    const Eigen::Matrix<double, N + 3, N> joints_to_plate = -normal.solve(joints_to_gradient);
    const Eigen::Matrix<double, N, 1> joint_step =
        -joints_to_plate.template topRows<N>().partialPivLu().solve(free_step.template head<N>());
    result.joints += joint_step;
    plate.tilt += (free_step + joints_to_plate * joint_step).template tail<3>();
    ++result.iterations;
    const double step = joint_step.cwiseAbs().maxCoeff();
    if (!std::isfinite(step)) return;
    if (step < kTolerance) {
      result.status = InverseStatus::reached;
      return;
    }
  }
}

}  // namespace

InverseResult inverse(const Machine& machine, const Pose& pose) noexcept {
  InverseResult result = level_inverse(machine, pose);
  if (!machine.has_slide() && pose.rotation != 0.0) result.status = InverseStatus::unreachable;
  if (result.ok() && machine.tilts_plate) {
    detail::with_limb_count(machine.limb_count, [&]<int N>() { settle<N>(machine, pose, result); });
  }
  return result;
}

}  // namespace paracal
