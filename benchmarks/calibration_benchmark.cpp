// Time of calibration and of pose selection on huang2016, beside other ways to the same answers. Plain chrono code for
// the reasons that kinematics_benchmark.cpp gives.
//
//   paracal-calibration-benchmark
//
// Reports and never judges: the exit status is 0 whatever the figures.

#include <fmt/format.h>

#include "calibration_reports.hpp"
#include "host.hpp"

int main() {
  using namespace paracal::benchmark;
  fmt::print("{}", host_description());
  fmt::print(
      "\nTimes: median, 99th percentile and maximum over the rounds; ratios: median of the ratios within the "
      "rounds.\n");
  report_fine_fit();
  report_pairs();
  report_selection();
}
