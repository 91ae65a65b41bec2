// Time of calibration and of pose selection on huang2016, compared with other methods for the same results.
// kinematics_benchmark.cpp explains why it uses plain chrono code.
//
//   paracal-calibration-benchmark
//
// It only reports: the exit status is always 0.

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
