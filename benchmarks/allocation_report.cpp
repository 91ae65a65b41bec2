#include <fmt/format.h>

#include "comparison.hpp"
#include "interleaved_timing.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/tolerance/allocation.hpp"
#include "tolerance_reports.hpp"

namespace paracal::benchmark {
namespace {

constexpr int kRounds = 51;

/// The tilt group within a factor of 10 of the robot's tolerances, each at a cost that it halves when twice as wide.
/// Limits at which both requirements bind.
AllocationProblem six_variables(const Robot& robot) {
  AllocationProblem problem{.rest = *robot.tolerances(),
                            .requirements = {{.characteristic = {Quantity::tilt}, .limit = 1e-3},
                                             {.characteristic = {Quantity::twist}, .limit = 0.9e-3}}};
  for (const Source source : all_sources()) {
    if (!tilts_plate(source)) continue;
    const double usual = problem.rest[source];
    problem.variables.push_back(
        {.sources = {source}, .cost = {.B = usual}, .lower = 0.1 * usual, .upper = 10.0 * usual});
  }
  return problem;
}

void print_row(const char* title, const std::vector<double>& seconds, const Allocation& allocation) {
  const Spread spread = spread_of(seconds);
  state(fmt::format("`allocate`: {}", title), 1e3 * spread.median, "ms");
  fmt::print("{:<46}{:>9.2f}{:>9.2f}{:>9.2f}{:>9}  {}", title, 1e3 * spread.median, 1e3 * spread.p99, 1e3 * spread.max,
             allocation.rounds, name(allocation.status));
  for (const RequirementOutcome& outcome : allocation.requirements) {
    fmt::print(", {} {:.4f} mrad at price {:.3g}", name(outcome.requirement.characteristic), 1e3 * outcome.worst.value,
               outcome.price);
  }
  fmt::print("\n");
}

}  // namespace

void report_allocation() {
  const Robot robot = catalogue::huang2016();
  const EqualInfluence sums{.bound = Bound::sum_of_maxima, .rest = *robot.tolerances()};
  const EqualInfluence true_maximum{.bound = Bound::true_maximum, .rest = *robot.tolerances()};
  const AllocationProblem problem = six_variables(robot);
  const auto seconds = interleave({[&] { keep(allocate(robot, sums)); }, [&] { keep(allocate(robot, true_maximum)); },
                                   [&] { keep(allocate(robot, problem)); }},
                                  kRounds);
  fmt::print("\nAllocation on huang2016, one thread, {} rounds (target: tens of milliseconds)\n", kRounds);
  fmt::print("{:<46}{:>9}{:>9}{:>9}{:>9}\n", "ms", "median", "p99", "max", "cutting");
  print_row("equal influence, sum of maxima", seconds[0], allocate(robot, sums));
  print_row("equal influence, true maximum", seconds[1], allocate(robot, true_maximum));
  print_row("six variables, tilt and twist", seconds[2], allocate(robot, problem));
}

}  // namespace paracal::benchmark
