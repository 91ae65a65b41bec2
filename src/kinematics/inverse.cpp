#include "paracal/kinematics/inverse.hpp"

#include <algorithm>
#include <cmath>

#include "guides.hpp"
#include "linear_closure.hpp"
#include "numerics/dense.hpp"
#include "paracal/mechanism/closure_limb.hpp"
#include "rod_derivative.hpp"

namespace paracal {
namespace {

using MostArms = closure::Arms<double, kMaxLimbs>;

void name_unreachable(InverseResult& result) {
  const auto joint = std::ranges::find_if_not(result.joints, [](double one) { return std::isfinite(one); });
  if (joint == result.joints.end()) return;
  result.status = InverseStatus::unreachable;
  result.unreachable_limb = static_cast<int>(joint - result.joints.begin());
}

/// Closed form of each limb: of its rod, with all its errors, or of the centre line of its parallelogram. All triangles
/// before the first arctangent: the short chains of arithmetic then overlap, limb with limb.
/// @param joint_at  the joint of a limb at the plate, from O', in {O}.
template <typename JointAt>
InverseResult closed_inverse(const Machine& machine, const Pose& pose, const JointAt& joint_at, MostArms& arms) {
  const auto position = closure_vector<double>(pose.position);
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    const ClosureVector<double> at = closure::sum(position, joint_at(limb));
    arms[i] = closure::close_limb<double>(limb, closure::sum(at, limb.base, -1.0));
  }
  InverseResult result{.status = InverseStatus::reached, .joints = Joints(machine.limb_count)};
  double sum = 0.0;  // is finite only where all joints are
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const auto joint = closure::joint_of<double>(machine.limbs[i], arms[i]);
    result.joints(static_cast<Eigen::Index>(i)) = joint;
    sum += joint;
  }
  if (!std::isfinite(sum)) name_unreachable(result);
  return result;
}

[[gnu::flatten]] InverseResult closed_inverse(const Machine& machine, const Pose& pose, MostArms& arms) {
  if (machine.is_level) {
    return closed_inverse(
        machine, pose, [&](const Limb& limb) { return closure::plate_joint<double>(limb, pose.rotation); }, arms);
  }
  const auto plate = closure::commanded_plate(closure_pose(pose));
  return closed_inverse(
      machine, pose, [&](const Limb& limb) { return plate.turned(limb.plate); }, arms);
}

/// From the closed form to the balance of the rods (machine_closure.hpp).
template <std::size_t N>
void settle(const Machine& machine, const ClosurePose<double>& pose, const MostArms& arms, InverseResult& result) {
  closure::Arms<double, N> own;
  std::copy_n(arms.begin(), N, own.begin());
  ClosureVector<double> tilt{};
  result.iterations = closure::settle(machine.limbs, pose, fourth_coordinate(machine), own, result.joints, tilt);
  result.tilt = as_eigen(tilt);
  if (result.iterations == 0) result.status = InverseStatus::not_converged;
}

/// Of any other machine, such as one with spare limbs, by Newton's method on joints and what the parallelograms hold of
/// the plate:
///
///   J^T (f + J_q dq + J_held dheld) = 0        6 equations; of more unknowns the shortest step
///
/// so that forward kinematics of these joints are the pose, whatever errors tilt the plate.
void settle_any(const Machine& machine, const Pose& pose, InverseResult& result) {
  constexpr int kMaxIterations = 20;
  constexpr double kTolerance = 4e-9;  // mm, of the last step
  constexpr int N = detail::kAnyLimbs;
  PlateState plate = plate_at(machine, pose);
  const auto limbs = static_cast<Eigen::Index>(machine.limb_count);
  result.status = InverseStatus::not_converged;
  while (result.iterations < kMaxIterations) {
    const detail::Ends<N> ends = detail::ends_of<N>(machine, result.joints);
    const detail::LinearClosure<N> linear = detail::linearize<N>(machine, plate, ends);
    const Eigen::Matrix3d rotation = plate_rotation(plate.tilt).matrix;
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(6, limbs + 6);
    Eigen::Index row = 0;
    for (Eigen::Index i = 0; i < limbs; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const detail::StandingLimb limb(machine.limbs[k], ends[k], result.joints(i), rotation);
      for (std::size_t j = 0; j < machine.limbs[k].actuator.rods; ++j, ++row) {
        system.col(i) +=
            linear.jacobian.row(row).transpose() * limb.by_joint(j == 0 ? 1.0 : -1.0, linear.direction[row]);
      }
    }
    for (Eigen::Index k = 0; k < 6; ++k) {
      if (machine.freedoms.free[static_cast<std::size_t>(k)]) continue;
      system.col(limbs + k) = linear.jacobian.transpose() * linear.jacobian.col(k);
    }
    const Eigen::VectorXd step = -detail::shortest_solution(system, linear.gradient());
    result.joints += step.head(limbs);
    plate.position += step.segment<3>(limbs);
    plate.tilt += step.tail<3>();
    ++result.iterations;
    double largest = 0.0;
    for (Eigen::Index i = 0; i < limbs; ++i) {
      largest = std::max(largest, joint_ratio(machine.limbs[static_cast<std::size_t>(i)]) * std::abs(step(i)));
    }
    if (!std::isfinite(step.sum())) return;
    if (largest < kTolerance) {
      result.status = InverseStatus::reached;
      return;
    }
  }
}

}  // namespace

InverseResult inverse(const Machine& machine, const Pose& pose) noexcept {
  const bool turns = pose.rotation != 0.0, leans = machine.is_level && !pose.tilt.isZero(0.0);
  const bool can_be_commanded = (machine.has_slide() || !turns) && !leans && detail::is_free(machine, pose);
  MostArms arms;
  InverseResult result = closed_inverse(machine, pose, arms);
  const bool settles = result.ok() && can_be_commanded && machine.tilts_plate,
             is_small = settles && can_settle(machine);
  if (is_small && machine.limb_count == 3) settle<3>(machine, closure_pose(pose), arms, result);
  if (is_small && machine.limb_count == 4) settle<4>(machine, closure_pose(pose), arms, result);
  for (std::size_t i = 0; machine.has_harmonics && i < machine.limb_count; ++i) {
    double& joint = result.joints(static_cast<Eigen::Index>(i));
    joint = machine.limbs[i].turn.commanded(joint);
  }
  if (settles && !is_small) settle_any(machine, pose, result);
  if (!can_be_commanded) result.status = InverseStatus::unreachable;
  return result;
}

}  // namespace paracal
