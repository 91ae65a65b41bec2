#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "paracal/batch/production.hpp"
#include "paracal/tolerance/statistics.hpp"

namespace paracal {

/// A machine that was made both ways: to first order, and by produce().
struct MachinePair {
  std::uint64_t machine = 0;
  double chance = 1.0;  ///< with which one like it is made both ways
  MachineOutcome outcome;
  Accuracy first_order_before, first_order_after;
  double used_up = 0.0;              ///< the largest error after calibration over its limit; 0 without limits
  double first_order_used_up = 0.0;  ///< likewise

  bool operator==(const MachinePair&) const = default;
};

/// Machines of which all were made to first order, and some both ways.
struct SurrogateTally {
  std::uint64_t machines = 0;
  PerErrorKind<Histogram> before, after;  ///< to first order, mm and rad
  Histogram used_up;                      ///< to first order, the largest error after calibration over its limit
  std::vector<MachinePair> pairs;

  void add(const SurrogateTally& other);
};

/// What many machines add up to, in whole numbers alone: parts merged in any order are the same whole, to the last bit,
/// in memory that does not depend on their number (but for pairs, which are few).
struct Tally {
  std::array<std::uint64_t, kFates.size()> fates{};  ///< of the machines that produce() made
  std::uint64_t passed = 0;                          ///< likewise
  PerErrorKind<Histogram> before, after;             ///< of all of these but scrap, mm and rad
  std::optional<SurrogateTally> surrogate = {};      ///< where most machines were made to first order

  std::uint64_t& of(Fate fate) { return fates[static_cast<std::size_t>(fate)]; }
  std::uint64_t of(Fate fate) const { return fates[static_cast<std::size_t>(fate)]; }
  /// That produce() made.
  std::uint64_t produced() const;
  /// All of them.
  std::uint64_t machines() const { return surrogate ? surrogate->machines : produced(); }

  void add(const MachineOutcome& outcome);
  void add(const Tally& other);
};

/// Share of the machines that pass: counted  [clopper-pearson1934], or by the pairs (ErrorSpread).
Proportion yield(const Tally& tally, double confidence);

/// Where none of the machines made both ways was rejected, not settled or scrap: what share may be so all the same, the
/// upper end of the interval of none  [clopper-pearson1934]. Zero where all were made by produce().
double unseen_share(const Tally& tally, double confidence);

}  // namespace paracal
