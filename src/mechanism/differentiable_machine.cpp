#include "paracal/mechanism/differentiable_machine.hpp"

#include <Eigen/Core>
#include <bit>
#include <unsupported/Eigen/AutoDiff>

#include "paracal/mechanism/machine_impl.hpp"

namespace paracal {
namespace {

/// Carries its derivatives by the errors of its own limb.
using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, static_cast<int>(kMostSources), 1>>;

BasicSourceErrors<Dual> with_derivatives(const Limbs& limbs, const SourceErrors& errors) {
  BasicSourceErrors<Dual> all;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    for (const Source source : sources_of(limbs[i].kind)) {
      all(i, source) =
          Dual(errors(i, source), static_cast<int>(kMostSources), static_cast<int>(place_in(limbs[i].kind, source)));
    }
  }
  return all;
}

std::vector<NumberByError> slopes_of(const BasicMachine<Dual>& machine, std::size_t number) {
  std::vector<NumberByError> slopes;
  const auto add = [&](const Dual& value, std::size_t place) {
    for (std::size_t error = 0; error < kMostSources; ++error) {
      const double slope = value.derivatives()(static_cast<Eigen::Index>(error));
      if (slope == 0.0) continue;
      slopes.push_back({static_cast<std::uint8_t>(place), static_cast<std::uint8_t>(error), slope});
    }
  };
  const auto numbers = numbers_of<Dual>(machine.limbs[number]);
  for (std::size_t k = 0; k < numbers.size(); ++k) add(numbers[k], k);
  const TurnCurve<Dual>& turn = machine.limbs[number].turn;
  add(turn.sine, numbers.size());
  add(turn.cosine, numbers.size() + 1);
  return slopes;
}

}  // namespace

DifferentiableMachine differentiable(const RobotDescription& robot, const SourceErrors& errors) {
  const BasicMachine<Dual> dual = build(robot, with_derivatives(robot.limbs, errors));
  std::array<std::vector<NumberByError>, kMaxLimbs> slopes;
  for (std::size_t i = 0; i < dual.limb_count; ++i) slopes[i] = slopes_of(dual, i);
  return {build(robot, errors), std::move(slopes)};
}

DifferentiableMachine differentiable(const Robot& robot, const SourceErrors& errors) {
  return differentiable(robot.description(), errors);
}

}  // namespace paracal
