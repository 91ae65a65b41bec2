#include "paracal/batch/tally.hpp"

#include <algorithm>
#include <numeric>

#include "paracal/batch/error_spread.hpp"

namespace paracal {

void SurrogateTally::add(const SurrogateTally& other) {
  machines += other.machines;
  for (const ErrorKind kind : kErrorKinds) {
    before[kind].add(other.before[kind]);
    after[kind].add(other.after[kind]);
  }
  used_up.add(other.used_up);
  const auto middle = pairs.insert(pairs.end(), other.pairs.begin(), other.pairs.end());
  std::inplace_merge(pairs.begin(), middle, pairs.end(),
                     [](const MachinePair& one, const MachinePair& another) { return one.machine < another.machine; });
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

void Tally::add(const Tally& other) {
  for (const Fate fate : kFates) of(fate) += other.of(fate);
  passed += other.passed;
  for (const ErrorKind kind : kErrorKinds) {
    before[kind].add(other.before[kind]);
    after[kind].add(other.after[kind]);
  }
  if (!other.surrogate) return;
  if (!surrogate) surrogate.emplace();
  surrogate->add(*other.surrogate);
}

double unseen_share(const Tally& tally, double confidence) {
  const bool seen = tally.of(Fate::accepted) < tally.produced();
  if (seen || tally.produced() == tally.machines()) return 0.0;
  return proportion_interval(0, tally.produced(), confidence).high;
}

Proportion yield(const Tally& tally, double confidence) {
  if (!tally.surrogate) return proportion(tally.passed, tally.produced(), confidence);
  Proportion share = ErrorSpread(tally, {.used_up = true}).share_within(1.0, confidence);
  const auto& pairs = tally.surrogate->pairs;
  double all = 0.0, closed = 0.0;
  for (const MachinePair& pair : pairs) {
    all += 1.0 / pair.chance;
    if (pair.outcome.fate != Fate::does_not_close) closed += 1.0 / pair.chance;
  }
  const double shape = all > 0.0 ? closed / all : 0.0;  // scrap does not pass
  share.value *= shape;
  share.interval.low = std::max(shape * share.interval.low - unseen_share(tally, confidence), 0.0);
  share.interval.high *= shape;
  return share;
}

}  // namespace paracal
