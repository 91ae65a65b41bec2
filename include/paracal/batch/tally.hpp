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

/// Share of the machines that pass  [clopper-pearson1934].
Proportion yield(const Tally& tally, double confidence);

}  // namespace paracal
