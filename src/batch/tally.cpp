#include "paracal/batch/tally.hpp"

#include <algorithm>
#include <numeric>

#include "paracal/batch/error_spread.hpp"

namespace paracal {

ErrorBins bins_of(const Accuracy& before, const Accuracy& after, const PerErrorKind<std::optional<double>>& limits) {
  ErrorBins bins;
  bins.used_up = Histogram::bin_of(used_up(after, limits));
  for (const ErrorKind kind : kErrorKinds) {
    bins.before[kind] = Histogram::bin_of(before[kind]);
    bins.after[kind] = Histogram::bin_of(after[kind]);
  }
  return bins;
}

void FirstOrderTally::add(const FirstOrderTally& other) {
  machines += other.machines;
  for (const ErrorKind kind : kErrorKinds) {
    before[kind].add(other.before[kind]);
    after[kind].add(other.after[kind]);
  }
  used_up.add(other.used_up);
}

std::uint64_t Tally::produced() const { return std::accumulate(fates.begin(), fates.end(), std::uint64_t{0}); }

void Tally::add(const MachineOutcome& outcome) {
  ++of(outcome.fate);
  passed += outcome.passes ? 1 : 0;
  if (outcome.fate == Fate::does_not_close) return;
  for (const ErrorKind kind : kErrorKinds) {
    before[kind].add(outcome.before[kind]);
    after[kind].add(outcome.after[kind]);
  }
}

void Tally::add(const MachinePair& pair) {
  ++of(pair.fate);
  passed += pair.passes ? 1 : 0;
  pairs.push_back(pair);
}

void Tally::add(const Tally& other) {
  for (const Fate fate : kFates) of(fate) += other.of(fate);
  passed += other.passed;
  for (const ErrorKind kind : kErrorKinds) {
    before[kind].add(other.before[kind]);
    after[kind].add(other.after[kind]);
  }
  if (other.first_order) {
    if (!first_order) first_order.emplace();
    first_order->add(*other.first_order);
  }
  const auto middle = pairs.insert(pairs.end(), other.pairs.begin(), other.pairs.end());
  std::ranges::inplace_merge(pairs, middle, {}, &MachinePair::machine);
}

double unseen_share(const Tally& tally, double confidence) {
  const bool seen = tally.of(Fate::accepted) < tally.produced();
  if (seen || tally.produced() == tally.machines()) return 0.0;
  return proportion_interval(0, tally.produced(), confidence).high;
}

Proportion yield(const Tally& tally, double confidence) {
  if (tally.produced() == 0) return proportion(0, 0, confidence);
  if (tally.produced() == tally.machines()) return proportion(tally.passed, tally.produced(), confidence);
  return ErrorSpread(tally, {.used_up = true}).share_within(1.0, confidence);
}

}  // namespace paracal
