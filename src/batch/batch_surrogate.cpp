#include "batch_surrogate.hpp"

#include <algorithm>
#include <cmath>

namespace paracal {
namespace {

constexpr std::uint64_t kPilot = 4096;
constexpr std::uint64_t kPilotStreams = std::uint64_t{3} << 60;  // beyond those of any batch
constexpr double kAllOfAStratum = 100.0;                         // machines of it, before chance decides
constexpr double kRate = 0.1;

/// Share of the machines in the stratum above so many ends.
double share_of_stratum(std::size_t ends_below) {
  const double low = ends_below == 0 ? 0.0 : kRanks[ends_below - 1];
  return (ends_below == kRanks.size() ? 1.0 : kRanks[ends_below]) - low;
}

double chance_in_stratum(std::uint64_t machine, double share) {
  const auto m = static_cast<double>(machine);
  return m * share < kAllOfAStratum ? 1.0 : std::min(1.0, kRate / (share * std::sqrt(m)));
}

}  // namespace

BatchSurrogate::BatchSurrogate(const Batch& batch) : surrogate_(batch.robot, batch.plan), strata_(kRanks.size()) {
  PerErrorKind<Histogram> after;
  for (const Surrogate::Values& one : surrogate_.machines(batch.seed, kPilotStreams, kPilot)) {
    for (const ErrorKind kind : kErrorKinds) after[kind].add(one.after[kind]);
  }
  for (std::size_t k = 0; k < kRanks.size(); ++k) {
    for (const ErrorKind kind : kErrorKinds) strata_[k][kind] = after[kind].quantile(kRanks[k]);
  }
}

double BatchSurrogate::chance(std::uint64_t machine, const Accuracy& after) const {
  double largest = 0.0;
  for (const ErrorKind kind : kErrorKinds) {
    if (strata_.front()[kind] == 0.0) continue;  // a plate that does not turn
    const auto below = std::ranges::count_if(strata_, [&](const Accuracy& end) { return end[kind] < after[kind]; });
    largest = std::max(largest, chance_in_stratum(machine, share_of_stratum(static_cast<std::size_t>(below))));
  }
  return largest;
}

Batch with_surrogate(Batch batch) {
  if (Surrogate::follows(batch.plan)) batch.surrogate = std::make_shared<const BatchSurrogate>(batch);
  return batch;
}

std::vector<Accuracy> strata(const Batch& batch) {
  return batch.surrogate ? batch.surrogate->strata() : std::vector<Accuracy>();
}

}  // namespace paracal
