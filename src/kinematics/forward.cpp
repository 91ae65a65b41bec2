#include "paracal/kinematics/forward.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <type_traits>

#include "first_guess.hpp"
#include "guides.hpp"
#include "linear_closure.hpp"
#include "numerics/small.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal {
namespace {

using detail::advance;
using detail::LinearClosure;
using detail::linearize;
using detail::Unknowns;

/// Step in mm, rotations counted at the half width of the parallelogram, where the rods feel them.
template <int N>
double step_length(const Unknowns<N>& step, double lever) {
  return std::max(step.template head<detail::kUnknowns<N> - 3>().norm(), lever * step.template tail<3>().norm());
}

/// What Newton's steps from a closure need: of six rods its derivative, else the normal equations.
template <int N>
using Factors = std::conditional_t<N == 6, detail::Elimination<detail::kUnknowns<N>>,
                                   detail::SmallCholesky<detail::NormalMatrix<N>>>;

template <int N>
Factors<N> factorized(const LinearClosure<N>& linear) {
  if constexpr (N == 6) {
    return detail::Elimination<detail::kUnknowns<N>>(linear.jacobian);
  } else {
    return Factors<N>(linear.normal());
  }
}

/// The same with the curvature of rods that cannot all have their lengths, near the least squares that they allow.
template <int N>
Factors<N> curved(const Machine& machine, const PlateState& plate, const detail::Ends<N>& ends,
                  const LinearClosure<N>& linear) {
  if constexpr (N == detail::kAnyLimbs) {
    if (linear.residual.cwiseAbs().maxCoeff() > detail::kExact) {
      Factors<N> factors(linear.normal() + detail::curvature(machine, plate, ends, linear));
      if (factors.ok()) return factors;
    }
  }
  return factorized<N>(linear);
}

/// Empty at a singular closure.
template <int N>
std::optional<Unknowns<N>> newton_step(const Factors<N>& factors, const LinearClosure<N>& linear) {
  if constexpr (N == 6) {
    const Unknowns<N> step = -factors.solve(linear.residual);
    return step.allFinite() ? std::optional(step) : std::nullopt;
  } else {
    if (!factors.ok()) return std::nullopt;
    return Unknowns<N>(-factors.solve(linear.gradient()));
  }
}

/// The step that is still to come, by the derivative of the one before, which hardly changed since: where it is too
/// small to be looked at, it is taken, and the answer found an iteration earlier.
template <int N>
bool settles(const Factors<N>& factors, double tolerance, double lever, LinearClosure<N>& linear, PlateState& plate) {
  constexpr double kMost = 10.0;  // mm of a rod a mm of such a step: a large residual spares the question
  if (linear.residual.cwiseAbs().maxCoeff() > kMost * tolerance) return false;
  const std::optional<Unknowns<N>> rest = newton_step<N>(factors, linear);
  if (!rest || !(step_length<N>(*rest, lever) < tolerance)) return false;
  advance<N>(plate, *rest);
  linear.residual += linear.jacobian * *rest;
  return true;
}

/// A step, halved while the rods miss by more after it. Near the answer rounding alone makes them do so, and tiny steps
/// are not judged.
template <int N>
void take(const Machine& machine, const detail::Ends<N>& ends, double length, Unknowns<N> step,
          LinearClosure<N>& linear, PlateState& plate) {
  constexpr int kMaxHalvings = 8;
  constexpr double kTiny = 1e-3;  // mm
  const double cost = linear.residual.squaredNorm();
  for (int k = 0; k <= kMaxHalvings; ++k, step *= 0.5) {
    PlateState trial = plate;
    advance<N>(trial, step);
    linear = linearize<N>(machine, trial, ends);
    if (k < kMaxHalvings && length > kTiny && linear.residual.squaredNorm() > cost) continue;
    plate = trial;
    return;
  }
}

template <int N>
ForwardResult solve(const Machine& machine, const Joints& joints, const ForwardOptions& options) {
  constexpr double kNear = 1.0;  // mm, of a step
  constexpr int kFar = 4;        // iterations from a far start
  const double lever = machine.turn_lever;
  ForwardResult result;
  const detail::Ends<N> ends = detail::ends_of<N>(machine, joints);
  result.plate = options.start ? *options.start : detail::level_guess<N>(machine, ends);
  if constexpr (!detail::kIsLevel<N>) {
    detail::guide(machine, result.plate);
  } else {
    // From a good guess, that of a machine which tilts its plate is as far away as the level one.
    if (!options.start || !machine.tilts_plate) result.plate = detail::level_start<N>(machine, ends, result.plate);
  }
  LinearClosure<N> linear = linearize<N>(machine, result.plate, ends);
  double last_step = HUGE_VAL;
  while (result.iterations < options.max_iterations) {
    const bool curves = last_step < kNear || result.iterations >= kFar;
    const Factors<N> factors = curves ? curved<N>(machine, result.plate, ends, linear) : factorized<N>(linear);
    const std::optional<Unknowns<N>> newton = newton_step<N>(factors, linear);
    if (!newton) {
      result.status = ForwardStatus::singular;
      break;
    }
    last_step = step_length<N>(*newton, lever);
    take<N>(machine, ends, last_step, *newton, linear, result.plate);
    ++result.iterations;
    bool settled = last_step < options.step_tolerance;
    if constexpr (N == 6) {
      settled =
          settled || (last_step < kNear && settles<N>(factors, options.step_tolerance, lever, linear, result.plate));
    }
    if (settled) {
      result.status = ForwardStatus::converged;
      break;
    }
    if (!std::isfinite(last_step)) break;
  }
  result.residual = linear.residual.cwiseAbs().maxCoeff();
  result.gradient = linear.gradient().norm();
  const double most = machine.spare_limbs() > 0 ? options.max_disagreement : options.max_residual;
  if (result.ok() && !(result.residual <= most)) result.status = ForwardStatus::strained;
  return result;
}

/// In the workspace, or so near to it that no second way to assemble the machine is in question.
bool is_near(const WorkingRange& range, const PlateState& plate) {
  constexpr double kSlack = 1e-6, kMargin = 0.1, kTurn = 0.05;  // mm; of the workspace; rad
  const Eigen::Array3d away = (plate.position - range.centre).array().abs();
  const Eigen::Array3d turned = plate.tilt.array().abs() - range.tilt.array();
  return (away <= (1.0 + kMargin) * range.half.array() + kSlack).all() && (turned <= kTurn).all();
}

/// From joints to joints, the shorter way round.
Joints change_of(const Machine& machine, const Joints& from, const Joints& to) {
  Joints change = to - from;
  for (Eigen::Index i = 0; i < change.size(); ++i) {
    if (joint_unit(machine.limbs[static_cast<std::size_t>(i)].actuator) == Unit::rad) {
      change(i) = std::remainder(change(i), 2.0 * std::numbers::pi);
    }
  }
  return change;
}

/// The plate that straight motions of all joints from the middle of the workspace lead to: the assembly mode in which
/// the machine works. `not_converged` where they do not get there; empty where the machine does not reach that middle.
template <int N>
std::optional<ForwardResult> led_from_centre(const Machine& machine, const Joints& joints,
                                             const ForwardOptions& options) {
  constexpr double kFirst = 0.125, kLeast = 1.0 / 256.0;  // of the way
  constexpr int kEasily = 10;                             // iterations: a plate that it takes more is not the next one
  const Pose centre{machine.range.centre};
  const InverseResult home = inverse(machine, centre);
  if (!home.ok()) return std::nullopt;
  const Joints way = change_of(machine, home.joints, joints);
  ForwardResult reached;
  reached.plate = plate_at(machine, centre);
  ForwardOptions step = options;
  step.max_iterations = kEasily;
  for (double at = 0.0, by = kFirst; at < 1.0;) {
    const double next = std::min(at + by, 1.0);
    step.start = reached.plate;
    const ForwardResult tried = solve<N>(machine, next < 1.0 ? Joints(home.joints + next * way) : joints, step);
    if (tried.usable()) {
      reached = tried;
      at = next;
    } else if ((by *= 0.5) < kLeast) {
      reached.status = ForwardStatus::not_converged;
      return reached;
    }
  }
  return reached;
}

/// The same plate, but for rounding.
bool is_same(const PlateState& one, const PlateState& other) {
  constexpr double kSame = 1e-6;  // mm, rad
  return (one.position - other.position).norm() < kSame && (one.tilt - other.tilt).norm() < kSame;
}

/// A solution outside of the workspace may be that of a machine assembled otherwise.
template <int N>
ForwardResult in_its_mode(const Machine& machine, const Joints& joints, const ForwardOptions& options) {
  ForwardResult direct = solve<N>(machine, joints, options);
  const auto is_meant = [&](const ForwardResult& found) { return found.ok() && is_near(machine.range, found.plate); };
  if (options.start || !joints.allFinite() || is_meant(direct)) return direct;
  if constexpr (!detail::kIsLevel<N>) {  // of a level plate the other solution is the mirror image, wherever it lies
    ForwardOptions placed = options;
    placed.start = detail::placed_level<N>(machine, joints);
    if (ForwardResult other = solve<N>(machine, joints, placed); is_meant(other)) return other;
  }
  const std::optional<ForwardResult> led = led_from_centre<N>(machine, joints, options);
  if (led && led->usable()) {
    const bool agrees = direct.usable() && is_same(direct.plate, led->plate);
    return agrees ? direct : *led;
  }
  if (led && direct.ok()) direct.status = ForwardStatus::other_mode;
  return direct;
}

}  // namespace

ForwardResult forward(const Machine& machine, const Joints& joints, const ForwardOptions& options) noexcept {
  return detail::with_limb_count(machine, [&]<int N>() { return in_its_mode<N>(machine, joints, options); });
}

}  // namespace paracal
