#pragma once

#include <cstdint>
#include <vector>

namespace paracal {

/// Interval of a quantity at a stated confidence.
struct Interval {
  double low = 0.0, high = 0.0;

  bool contains(double value) const { return low <= value && value <= high; }
};

/// Probability of a success after `hits` of `trials`, exact  [clopper-pearson1934].
/// @param confidence  two-sided, below 1.
Interval proportion_interval(std::uint64_t hits, std::uint64_t trials, double confidence);

/// A fraction of machines, with its interval at a stated confidence.
struct Proportion {
  double value = 0.0;  ///< NaN without machines
  Interval interval;
};

/// hits / trials with proportion_interval().
Proportion proportion(std::uint64_t hits, std::uint64_t trials, double confidence);

/// Defects per million machines: 10^6 (1 - yield).
Proportion defects_per_million(const Proportion& yield);

/// Counts of magnitudes in bins a 256th of an octave wide, from 2^-40 to 2^24 (mm or rad), everything below in the
/// first bin and above in the last. Memory is constant; quantiles have an error of 0.2 %. All counts are whole numbers,
/// so the sum of parts does not depend on their order.
class Histogram {
 public:
  Histogram() : counts_(kBins, 0) {}

  /// @param value  at least 0 and not NaN.
  void add(double value);
  void add(const Histogram& other);
  /// `count` values of the bin with that number, as counts() lists them.
  void add(std::uint32_t bin, std::uint64_t count);

  std::uint64_t total() const { return total_; }
  double mean() const;
  double std() const;
  /// Smallest value that at least this fraction of all values does not exceed; NaN if empty.
  double quantile(double share) const;
  /// Interval of the quantile of all machines, if these are a sample: order statistics at binomial ranks.
  Interval quantile_interval(double share, double confidence) const;

  struct Bin {
    std::uint32_t number = 0;
    std::uint64_t count = 0;
    bool operator==(const Bin&) const = default;
  };
  /// The bins that are not empty, in order.
  std::vector<Bin> counts() const;
  /// The bin of a value.
  static std::uint32_t bin_of(double value);
  /// Lower end of a bin; the first one also contains zero.
  static double begin_of(std::uint32_t bin);
  /// Middle of a bin.
  static double value_of(std::uint32_t bin);
  static constexpr std::uint32_t kBins = 64 * 256;

 private:
  double ranked(std::uint64_t rank) const;

  std::vector<std::uint64_t> counts_;
  std::uint64_t total_ = 0;
};

}  // namespace paracal
