#include "interleaved_timing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace paracal::benchmark {
namespace {

double seconds_of(const Pass& pass) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  pass();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The smallest figure that is not below a share of all of them; `figures` ascending.
double quantile(const std::vector<double>& figures, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(figures.size())));
  return figures[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

std::vector<std::vector<double>> interleave(const std::vector<Pass>& candidates, int rounds) {
  for (const Pass& pass : candidates) pass();
  std::vector<std::vector<double>> seconds(candidates.size(), std::vector<double>(static_cast<std::size_t>(rounds)));
  for (std::size_t round = 0; round < static_cast<std::size_t>(rounds); ++round) {
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const std::size_t candidate = (round + k) % candidates.size();
      seconds[candidate][round] = seconds_of(candidates[candidate]);
    }
  }
  return seconds;
}

Spread spread_of(std::vector<double> figures) {
  std::ranges::sort(figures);
  return {quantile(figures, 0.5), quantile(figures, 0.99), figures.back()};
}

double median_ratio(const std::vector<double>& candidate, const std::vector<double>& baseline) {
  return ratio_quartiles(candidate, baseline).median;
}

Quartiles ratio_quartiles(const std::vector<double>& candidate, const std::vector<double>& baseline) {
  std::vector<double> ratios(candidate.size());
  std::ranges::transform(candidate, baseline, ratios.begin(), std::divides<>());
  std::ranges::sort(ratios);
  return {quantile(ratios, 0.25), quantile(ratios, 0.5), quantile(ratios, 0.75)};
}

}  // namespace paracal::benchmark
