#include "peak.hpp"

#include <Eigen/Core>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "interleaved_timing.hpp"

namespace paracal::benchmark {
namespace {

constexpr int kRepetitions = 20000;
constexpr double kFactor = 0.999, kIncrement = 1e-3;  // the sums tend to 1: neither overflow nor denormal numbers

// 24 doubles fill 12 of the 16 SSE registers: a multiplication and an addition take about 6 cycles in a row, and a core
// starts two pairs a cycle. A fused one takes 4.
constexpr int kAccumulators = 24;
constexpr int kRegisters = 12;

constexpr double operations_of(int accumulators) { return 2.0 * accumulators * kRepetitions; }

void compiled_pass() {
  using Accumulators = Eigen::Array<double, kAccumulators, 1>;
  Accumulators sums = Accumulators::LinSpaced(0.0, 1.0);
  for (int k = 0; k < kRepetitions; ++k) sums = sums * kFactor + kIncrement;
  keep(sums);
}

#if defined(__x86_64__)
// NOLINTBEGIN(modernize-avoid-c-arrays): a template would lose the attributes of the registers.
[[gnu::target("avx2,fma")]] void avx2_pass() {
  __m256d sums[kRegisters];
  for (int k = 0; k < kRegisters; ++k) sums[k] = _mm256_set1_pd(0.1 * k);
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    for (__m256d& sum : sums) sum = _mm256_fmadd_pd(sum, _mm256_set1_pd(kFactor), _mm256_set1_pd(kIncrement));
  }
  keep(sums);
}

[[gnu::target("avx512f")]] void avx512_pass() {
  __m512d sums[kRegisters];
  for (int k = 0; k < kRegisters; ++k) sums[k] = _mm512_set1_pd(0.1 * k);
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    for (__m512d& sum : sums) sum = _mm512_fmadd_pd(sum, _mm512_set1_pd(kFactor), _mm512_set1_pd(kIncrement));
  }
  keep(sums);
}
// NOLINTEND(modernize-avoid-c-arrays)
#endif

}  // namespace

Peak compiled_peak() { return {"as compiled", operations_of(kAccumulators), compiled_pass}; }

Peak machine_peak() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return {"AVX-512 FMA", operations_of(8 * kRegisters), avx512_pass};
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return {"AVX2 FMA", operations_of(4 * kRegisters), avx2_pass};
  }
#endif
  return compiled_peak();
}

}  // namespace paracal::benchmark
