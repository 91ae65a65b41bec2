#include "paracal/batch/tally.hpp"

#include <numeric>

namespace paracal {

std::uint64_t Tally::machines() const { return std::accumulate(fates.begin(), fates.end(), std::uint64_t{0}); }

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
}

Proportion yield(const Tally& tally, double confidence) {
  return proportion(tally.passed, tally.machines(), confidence);
}

}  // namespace paracal
