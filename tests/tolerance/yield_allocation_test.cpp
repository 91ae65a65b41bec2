// The cheapest tolerances with which few machines break a limit: held against machines drawn anew, and against trades.

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/tolerance/allocation.hpp"
#include "support/robots.hpp"

namespace paracal::yield_allocation_test {
namespace {

using testing::HasSubstr;

class YieldAllocation : public test::EveryRobot {
 protected:
  /// A few errors to choose, all at a cost of one over their half-widths.
  AllocationProblem problem(double max_failures) const {
    AllocationProblem problem{.rest = tolerances_of(robot), .max_failures = max_failures};
    for (const Source source :
         {Source("rod_difference"), Source("alpha2"), Source("beta03"), Source("width_difference")}) {
      const double usual = problem.rest[source];
      problem.variables.push_back({{source}, {.B = usual}, usual / 30.0, 30.0 * usual});
    }
    problem.requirements = {{{Quantity::tilt}, 1e-3, Spread::yield}};
    for (std::size_t k = 0; k < 121; k += 4) problem.poses.push_back(workspace_stations(robot)[k].commanded);
    return problem;
  }
  static double cost(const AllocationProblem& problem, const Tolerances& tolerances) {
    double sum = 0.0;
    for (const DesignVariable& one : problem.variables) sum += one.cost.cost(tolerances[one.sources.front()]);
    return sum;
  }
  double share(const AllocationProblem& problem, const Tolerances& tolerances, std::uint64_t seed) const {
    const FailureShare found = failure_share(robot, tolerances, problem.requirements, problem.poses,
                                             {.seed = seed, .relative_error = 0.03, .max_exact = 0});
    EXPECT_EQ(found.status, FailureStatus::settled) << found.reason;
    return found.linear.value;
  }
  /// What several tests look at, allocated once.
  const Allocation& chosen(double max_failures) const {
    static std::map<std::pair<std::string, double>, Allocation> all;
    const auto [place, is_new] = all.try_emplace({robot.name(), max_failures});
    if (is_new) place->second = allocate(robot, problem(max_failures));
    return place->second;
  }
};
PARACAL_ON_EVERY_ROBOT(YieldAllocation);

TEST_P(YieldAllocation, KeepsTheShareAndNoTradeIsCheaper) {
  constexpr double kMost = 1e-4;
  const AllocationProblem wanted = problem(kMost);
  const Allocation& found = chosen(kMost);
  ASSERT_EQ(found.status, AllocationStatus::optimal) << found.reason;
  ASSERT_TRUE(found.failures && found.failures->exact);
  EXPECT_LE(found.failures->exact->interval.high, kMost);
  EXPECT_GT(found.failures->exact->value, 0.8 * kMost);
  EXPECT_NEAR(found.cost, static_cast<double>(robot.limb_count()) * cost(wanted, found.tolerances), 1e-9 * found.cost);
  EXPECT_GT(found.failure_price, 0.0);
  // One a tenth wider, another as much tighter as makes all cheaper by 0.3 %: more fail. Other random numbers, the same
  // for both.
  const double before = share(wanted, found.tolerances, 11);
  const double cheaper = (1.0 - 3e-3) * cost(wanted, found.tolerances);
  for (std::size_t wider = 0; wider < wanted.variables.size(); ++wider) {
    const Source one = wanted.variables[wider].sources.front();
    const DesignVariable& tighter = wanted.variables[(wider + 1) % wanted.variables.size()];
    const Source other = tighter.sources.front();
    Tolerances traded = found.tolerances;
    traded[one] *= 1.1;
    const double left = cheaper - cost(wanted, traded) + tighter.cost.cost(traded[other]);
    traded[other] = tighter.cost.B / left;
    ASSERT_NEAR(cost(wanted, traded), cheaper, 1e-9 * cheaper);
    ASSERT_LT(traded[other], found.tolerances[other]);
    EXPECT_GT(share(wanted, traded, 11), before) << name(one) << name(other);
  }
}

/// Fewer failures cost more, by what the price says. Cost grows faster the fewer may fail: each of four halvings costs
/// between the prices at both ends. Costs scatter by a percent (rates are met to a tenth), the mean of four halvings
/// by a tenth.
TEST_P(YieldAllocation, ThePriceIsThatOfFewerFailures) {
  constexpr double kScatter = 0.3;
  const Allocation &few = chosen(1e-4), &many = chosen(16e-4);
  ASSERT_TRUE(few.ok() && many.ok());
  const double a_halving = (few.cost - many.cost) / 4.0;
  EXPECT_LT(a_halving, (1.0 + kScatter) * few.failure_price);
  EXPECT_GT(a_halving, (1.0 - kScatter) * many.failure_price);
}

TEST_P(YieldAllocation, OtherLimitsHoldBesides) {
  AllocationProblem wanted = problem(1e-3);
  const Allocation free = allocate(robot, wanted);
  const double limit = 0.97 * worst_spread(robot, {Quantity::twist}, free.tolerances, Spread::worst_case).value;
  wanted.requirements.push_back({{Quantity::twist}, limit, Spread::worst_case});
  const Allocation found = allocate(robot, wanted);
  ASSERT_EQ(found.status, AllocationStatus::optimal) << found.reason;
  EXPECT_LE(found.requirements[1].worst.value, limit * (1 + 2e-6));
  EXPECT_LE(found.failures->best().interval.high, 1e-3);
  EXPECT_GT(found.cost, 0.99 * free.cost);
}

TEST(YieldAllocationOf, TightestPartsThatFailIsInfeasible) {
  const Robot robot = catalogue::huang2016();
  AllocationProblem problem{.rest = *robot.tolerances(), .max_failures = 1e-6};
  problem.variables = {{{"alpha2"}, {}, 1e-4, 1e-3}};
  problem.requirements = {{{Quantity::tilt}, 8e-4, Spread::yield}};
  problem.poses = {{robot.workspace().centre(), 0.0}};
  const Allocation found = allocate(robot, problem);
  EXPECT_EQ(found.status, AllocationStatus::infeasible);
  EXPECT_THAT(found.reason, HasSubstr("with the tightest tolerances, above "));
}

TEST(YieldAllocationOf, WhatMakesNoSenseIsRefused) {
  const Robot robot = catalogue::huang2016();
  AllocationProblem sound{.rest = *robot.tolerances(), .max_failures = 1e-4};
  sound.variables = {{{"alpha2"}, {}, 1e-4, 1e-3}};
  sound.requirements = {{{Quantity::tilt}, 1e-3, Spread::yield}};
  sound.poses = {{robot.workspace().centre(), 0.0}};
  const auto refused = [&](const auto& spoil) {
    AllocationProblem problem = sound;
    spoil(problem);
    EXPECT_THROW((void)allocate(robot, problem), InvalidArgument);
  };
  refused([](AllocationProblem& one) { one.max_failures.reset(); });
  refused([](AllocationProblem& one) { one.max_failures = 0.0; });
  refused([](AllocationProblem& one) { one.max_failures = 0.6; });
  refused([](AllocationProblem& one) { one.requirements[0].criterion = Spread::statistical; });
  refused([](AllocationProblem& one) { one.rest.distribution = Distribution::uniform; });
  refused([](AllocationProblem& one) {
    one.variables[0].cost = {.law = CostLaw::grades, .grades = {{"ground", 1e-4, 1.0}}};
  });
}

}  // namespace
}  // namespace paracal::yield_allocation_test
