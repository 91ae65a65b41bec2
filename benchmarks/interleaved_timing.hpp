#pragma once

#include <functional>
#include <vector>

namespace paracal::benchmark {

/// Makes the compiler assume that a value is read, so that its computation is not removed.
template <typename Value>
void keep(const Value& value) {
  asm volatile("" : : "m"(value) : "memory");
}

/// One pass of a candidate: every input once.
using Pass = std::function<void()>;

/// Seconds of each candidate in each round. Within a round the candidates run one right after the other, so that what
/// disturbs the machine for longer than a round disturbs all of them alike; the first one moves on by one each round.
/// One round more, before the others, warms caches and branch predictors and is not counted.
/// @returns one vector a candidate, one entry a round.
std::vector<std::vector<double>> interleave(const std::vector<Pass>& candidates, int rounds);

/// How a figure spreads over the rounds.
struct Spread {
  double median = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

Spread spread_of(std::vector<double> figures);

/// Median over the rounds of the ratio within each round.
double median_ratio(const std::vector<double>& candidate, const std::vector<double>& baseline);

/// And its quartiles.
struct Quartiles {
  double low = 0.0, median = 0.0, high = 0.0;
};
Quartiles ratio_quartiles(const std::vector<double>& candidate, const std::vector<double>& baseline);

}  // namespace paracal::benchmark
