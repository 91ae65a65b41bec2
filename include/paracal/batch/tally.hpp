#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "paracal/batch/production.hpp"
#include "paracal/tolerance/statistics.hpp"

namespace paracal {

/// Errors of a machine as bins of Histogram: exact to 0.2 %, and a byte or two each where they are kept.
struct ErrorBins {
  PerErrorKind<std::uint32_t> before, after;
  std::uint32_t used_up = 0;  ///< the largest error after calibration over its limit; 1 is the first bin of an octave

  bool operator==(const ErrorBins&) const = default;
};

ErrorBins bins_of(const Accuracy& before, const Accuracy& after, const PerErrorKind<std::optional<double>>& limits);

/// A machine computed both ways: to first order, and by produce().
struct MachinePair {
  std::uint64_t machine = 0;
  Fate fate = Fate::does_not_close;
  bool passes = false;
  ErrorBins first_order, exact;  ///< exact: zero for scrap

  bool operator==(const MachinePair&) const = default;
};

/// Machines computed to first order.
struct FirstOrderTally {
  std::uint64_t machines = 0;
  PerErrorKind<Histogram> before, after;  ///< mm and rad
  Histogram used_up;                      ///< the largest error after calibration over its limit

  void add(const FirstOrderTally& other);
};

/// What many machines add up to, in whole numbers alone: parts merged in any order are the same whole, to the last bit,
/// in memory that does not depend on their number (but for pairs, which are few).
struct Tally {
  std::array<std::uint64_t, kFates.size()> fates{};  ///< of the machines that produce() made
  std::uint64_t passed = 0;                          ///< likewise
  PerErrorKind<Histogram> before, after;             ///< of these but scrap and pairs, mm and rad
  std::optional<FirstOrderTally> first_order = {};   ///< where most machines are computed to first order
  std::vector<MachinePair> pairs = {};               ///< some of them, by number

  std::uint64_t& of(Fate fate) { return fates[static_cast<std::size_t>(fate)]; }
  std::uint64_t of(Fate fate) const { return fates[static_cast<std::size_t>(fate)]; }
  /// That produce() made.
  std::uint64_t produced() const;
  /// All of them.
  std::uint64_t machines() const { return first_order ? first_order->machines : produced(); }

  void add(const MachineOutcome& outcome);
  void add(const MachinePair& pair);
  void add(const Tally& other);
};

/// Probability that a machine passes: counted where produce() made all  [clopper-pearson1934], else by ErrorSpread.
Proportion yield(const Tally& tally, double confidence);

/// Where none of the exact machines was rejected, not settled or scrap: what percentage may be so all the same, the
/// upper end of the interval of none  [clopper-pearson1934]. Zero where all were made by produce().
double unseen_share(const Tally& tally, double confidence);

}  // namespace paracal
