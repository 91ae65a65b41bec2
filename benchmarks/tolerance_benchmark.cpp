// Time of Monte Carlo and of allocation on huang2016, compared with the limits of the processor and with OpenTURNS if
// installed. kinematics_benchmark.cpp explains why it uses plain chrono code.
//
//   paracal-tolerance-benchmark
//
// It only reports: the exit status is always 0.

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
