#pragma once

#include <array>
#include <cstdint>

#include "paracal/batch/production.hpp"
#include "paracal/tolerance/statistics.hpp"

namespace paracal {

/// What many machines add up to, in whole numbers alone: parts merged in any order are the same whole, to the last bit,
/// in memory that does not depend on their number.
struct Tally {
  std::array<std::uint64_t, kFates.size()> fates{};
  std::uint64_t passed = 0;
  PerErrorKind<Histogram> before, after;  ///< of all machines but scrap, mm and rad

  std::uint64_t& of(Fate fate) { return fates[static_cast<std::size_t>(fate)]; }
  std::uint64_t of(Fate fate) const { return fates[static_cast<std::size_t>(fate)]; }
  std::uint64_t machines() const;

  void add(const MachineOutcome& outcome);
  void add(const Tally& other);
};

/// A share of machines, with its interval at a stated confidence.
struct Proportion {
  double value = 0.0;  ///< NaN without machines
  Interval interval;
};

/// Share of the machines that pass  [clopper-pearson1934].
Proportion yield(const Tally& tally, double confidence);

/// Defects per million machines: 10^6 (1 - yield).
Proportion defects_per_million(const Proportion& yield);

}  // namespace paracal
