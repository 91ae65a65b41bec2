#include "paracal/kinematics/inverse.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "guides.hpp"
#include "linear_closure.hpp"
#include "numerics/dense.hpp"
#include "paracal/mechanism/closure_limb.hpp"
#include "rod_derivative.hpp"

namespace paracal {
namespace {

void take(InverseResult& result, std::size_t limb, const JointSolution& solution) {
  result.joints(static_cast<Eigen::Index>(limb)) = solution.joint;
  if (!solution.reached && result.unreachable_limb < 0) {
    result.status = InverseStatus::unreachable;
    result.unreachable_limb = static_cast<int>(limb);
  }
}

/// Closed form of six even struts, with all their errors; as solve_joint(), but roots and quotients of all struts
/// together.
InverseResult strut_inverse(const Machine& machine, const Pose& pose) {
  using PerStrut = Eigen::Array<double, 6, 1>;
  const Eigen::Matrix3d rotation = plate_rotation(pose.tilt).matrix;
  PerStrut square, zero, gain;
  for (Eigen::Index i = 0; i < PerStrut::SizeAtCompileTime; ++i) {
    const Limb& limb = machine.limbs[static_cast<std::size_t>(i)];
    square(i) = (pose.position + rotation * limb.plate - limb.base).squaredNorm();
    zero(i) = limb.rod[0] + limb.joint_offset;
    gain(i) = limb.gain;
  }
  const PerStrut joints = (square.sqrt() - zero) / gain;
  InverseResult result{.status = InverseStatus::reached, .joints = joints};
  if (joints.isFinite().all()) return result;
  for (Eigen::Index i = 0; i < joints.size(); ++i) {
    take(result, static_cast<std::size_t>(i), {joints(i), std::isfinite(joints(i))});
  }
  return result;
}

/// Closed form of each limb: of its rod, with all its errors, or of the centre line of its parallelogram.
InverseResult limb_inverse(const Machine& machine, const Pose& pose) {
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
  const auto is_strut = [](const Limb& limb) { return limb.is_strut() && limb.turn.is_even(); };
  const bool six_struts = machine.limb_count == 6 && std::ranges::all_of(std::span(machine.limbs).first(6), is_strut);
  return six_struts ? strut_inverse(machine, pose) : limb_inverse(machine, pose);
}

/// Closed form on the centre lines of the limbs, plate level.
InverseResult level_inverse(const Machine& machine, const Pose& pose) {
  InverseResult result;
  result.joints.resize(static_cast<Eigen::Index>(machine.limb_count));
  result.status = InverseStatus::reached;
  const Eigen::Vector3d slide = machine.slide_of(pose.rotation) * machine.slide_axis;
  if (runs_on_rail(machine.limbs[0].actuator)) {
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

/// The closed form, and from there, where it reaches what can be commanded, to the balance of the rods
/// (machine_closure.hpp).
template <std::size_t N>
InverseResult balanced_inverse(const Machine& machine, const Pose& pose, bool can_be_commanded) {
  const ClosureLimbs<double, N> limbs = closure_limbs<N>(machine);
  const ClosurePose<double> commanded = closure_pose(pose);
  const closure::Arms<double, N> arms =
      machine.is_level ? closure::closed_arms<N>(limbs, commanded, closure::LevelPlate{})
                       : closure::closed_arms<N>(limbs, commanded, closure::commanded_plate(commanded));
  InverseResult result{.status = InverseStatus::reached, .joints = Joints(N)};
  closure::joints_of(limbs, arms, result.joints);
  for (std::size_t i = 0; i < N; ++i) take(result, i, solution(result.joints(static_cast<Eigen::Index>(i))));
  if (result.ok() && can_be_commanded) {
    ClosureVector<double> tilt{};
    result.iterations = closure::settle(limbs, commanded, fourth_coordinate(machine), arms, result.joints, tilt);
    result.tilt = {tilt[0], tilt[1], tilt[2]};
    if (result.iterations == 0) result.status = InverseStatus::not_converged;
  }
  for (std::size_t i = 0; i < N; ++i) {
    double& joint = result.joints(static_cast<Eigen::Index>(i));
    joint = machine.limbs[i].turn.commanded(joint);
  }
  return result;
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
    const detail::Elbows<N> elbows = detail::elbows_of<N>(machine, result.joints);
    const detail::LinearClosure<N> linear = detail::linearize<N>(machine, plate, elbows);
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(6, limbs + 6);
    Eigen::Index row = 0;
    for (Eigen::Index i = 0; i < limbs; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const detail::StandingLimb limb(machine, k, plate, plate_rotation(plate.tilt).matrix, result.joints(i));
      for (std::size_t j = 0; j < rod_count(machine.limbs[k]); ++j, ++row) {
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
  const bool is_balanced = machine.tilts_plate && can_settle(machine);
  InverseResult result;
  if (is_balanced && machine.limb_count == 3) {
    result = balanced_inverse<3>(machine, pose, can_be_commanded);
  } else if (is_balanced && machine.limb_count == 4) {
    result = balanced_inverse<4>(machine, pose, can_be_commanded);
  } else {
    result = machine.is_level ? level_inverse(machine, pose) : closed_inverse(machine, pose);
    if (result.ok() && can_be_commanded && machine.tilts_plate) settle_any(machine, pose, result);
  }
  if (!can_be_commanded) result.status = InverseStatus::unreachable;
  return result;
}

}  // namespace paracal
