#include "peak.hpp"

#include <Eigen/Core>

#include "interleaved_timing.hpp"

namespace paracal::benchmark {
namespace {

// Fills 12 of the 16 SSE registers: a multiplication and an addition take about 6 cycles in a row, and a core starts
// two pairs a cycle.
constexpr int kAccumulators = 24;
constexpr int kRepetitions = 20000;

using Accumulators = Eigen::Array<double, kAccumulators, 1>;

}  // namespace

double peak_operations() { return 2.0 * kAccumulators * kRepetitions; }

void peak_pass() {
  Accumulators sums = Accumulators::LinSpaced(0.0, 1.0);
  constexpr double factor = 0.999, increment = 1e-3;  // the sums tend to 1: neither overflow nor denormal numbers
  for (int k = 0; k < kRepetitions; ++k) sums = sums * factor + increment;
  keep(sums);
}

}  // namespace paracal::benchmark
