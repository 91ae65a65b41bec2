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

/// Paired simulation of a machine: to first order, and by produce().
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

/// Sums over many machines, in whole numbers: the result does not depend on the order of merging, to the last bit.
/// Memory does not depend on the number of machines (except for the few pairs).
struct Tally {
  std::array<std::uint64_t, kFates.size()> fates{};  ///< of the machines from produce()
  std::uint64_t passed = 0;                          ///< likewise
  PerErrorKind<Histogram> before, after;             ///< of these without scrap and pairs, mm and rad
  std::optional<FirstOrderTally> first_order = {};   ///< if most machines are computed to first order
  std::vector<MachinePair> pairs = {};               ///< some of them, by number

  std::uint64_t& of(Fate fate) { return fates[static_cast<std::size_t>(fate)]; }
  std::uint64_t of(Fate fate) const { return fates[static_cast<std::size_t>(fate)]; }
  /// Number of machines from produce().
  std::uint64_t produced() const;
  /// Number of all machines.
  std::uint64_t machines() const { return first_order ? first_order->machines : produced(); }

  void add(const MachineOutcome& outcome);
  void add(const MachinePair& pair);
  void add(const Tally& other);
};

/// Probability that a machine passes: counted if produce() computed all  [clopper-pearson1934], else by ErrorSpread.
Proportion yield(const Tally& tally, double confidence);

/// If no exact machine was rejected, not converged or scrap: upper end of the interval of this fraction
/// [clopper-pearson1934]. Zero if produce() computed all machines.
double unseen_share(const Tally& tally, double confidence);

}  // namespace paracal
