// Allocates tolerances for a plate tilt below 0.1 / 100 (3 sigma), once as in Table 2 of Huang et al. (2016) and once
// with higher costs of precise angles. It then draws a batch to compute the yield.

#include <cstdio>
#include <paracal/paracal.hpp>

using namespace paracal;

int main() {
  const Robot robot = catalogue::huang2016();
  const Allocation table2 = allocate(robot, EqualInfluence{.max_tilt = 1e-3});
  if (!table2.ok()) return 1;

  AllocationProblem problem{.rest = table2.tolerances, .requirements = {{{Quantity::tilt}, 1e-3}}};
  for (const Source source : {Source("alpha2"), Source("alpha03"), Source("beta2"), Source("beta03")}) {
    problem.variables.push_back({{source}, {.law = CostLaw::reciprocal, .B = 1e-3}, 5e-5, 2e-3});
  }
  const Allocation own = allocate(robot, problem);
  if (!own.ok()) return 1;

  const MonteCarlo batch =
      monte_carlo(robot, own.tolerances, problem.requirements, {own.requirements.front().worst.pose});
  std::printf("alpha2: %.3f, with own costs %.3f (1e-3 rad)\n", 1e3 * table2.tolerances["alpha2"],
              1e3 * own.tolerances["alpha2"]);
  std::printf("%llu machines: 3 sigma of tilt %.3f (1e-3 rad), yield at the worst pose %.2f %%\n",
              static_cast<unsigned long long>(batch.machines), 3e3 * batch.requirements.front().at_worst().sigma,
              100.0 * batch.yield().value);
}
