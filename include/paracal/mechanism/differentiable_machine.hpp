#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "paracal/mechanism/machine.hpp"

namespace paracal {

class Robot;

/// d(a number of a limb's closure) / d(one of that limb's errors).
struct NumberByError {
  std::uint8_t number;  ///< place in a ClosureLimb; behind its numbers sine and cosine of the TurnCurve
  std::uint8_t error;   ///< place in sources_of() its kind
  double slope;         ///< in the unit of the number per mm, rad or mm/m
};

/// A machine and how the numbers of its limbs change with its errors: all that the derivative of a pose needs of
/// build(), found once for all poses.
struct DifferentiableMachine : Machine {
  DifferentiableMachine() = default;
  DifferentiableMachine(const Machine& machine, std::array<std::vector<NumberByError>, kMaxLimbs> slopes)
      : Machine(machine), by_errors(std::move(slopes)) {}

  std::array<std::vector<NumberByError>, kMaxLimbs> by_errors = {};  ///< those that are not zero
};

/// build(robot, errors) on numbers that carry their derivatives.
DifferentiableMachine differentiable(const RobotDescription& robot, const SourceErrors& errors);
DifferentiableMachine differentiable(const Robot& robot, const SourceErrors& errors);

}  // namespace paracal
