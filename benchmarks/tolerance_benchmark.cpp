// Time of Monte Carlo and of allocation on huang2016, beside the limits of the machine and beside OpenTURNS where that
// was found. Plain chrono code for the reasons that kinematics_benchmark.cpp gives.
//
//   paracal-tolerance-benchmark
//
// Reports and never judges: the exit status is 0 whatever the figures.

#include <fmt/format.h>

#include "host.hpp"
#include "tolerance_reports.hpp"

int main() {
  using namespace paracal::benchmark;
  fmt::print("{}", host_description("one and two threads are used"));
  fmt::print(
      "\nTimes: median, 99th percentile and maximum over the rounds; ratios: median of the ratios within the "
      "rounds.\n");
  for (const unsigned threads : {1U, 2U}) report_linear_monte_carlo(threads);
  for (const unsigned threads : {1U, 2U}) report_exact_monte_carlo(threads);
  report_allocation();
}
