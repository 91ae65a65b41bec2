#pragma once

#include <vector>

#include "paracal/batch/tally.hpp"

namespace paracal {

/// Which number of a machine.
struct Measure {
  ErrorKind kind = ErrorKind::distance;
  bool after = true;     ///< calibration
  bool used_up = false;  ///< instead: the largest error after calibration over its limit
};

/// How an error spreads over the machines of a batch.
///
/// Where all machines were made by produce(): counted. Where most were made to first order, l, and some both ways, l
/// and g: in each stratum s of l (ranks 0.5, 0.9, 0.99, 0.999 part them) the ratios g / l of the pairs, weighed by one
/// over the chance with which they were chosen, tell how much the linear values there are to be corrected,
///
///   \f[ P(g \le x) = sum_s (N_s / N) P_s(l (g / l) \le x) \f]
///
/// with l and g / l of a stratum taken as independent, and with the variance of that of N drawn machines and of the
/// weighed pairs together. Strata in which all machines were made both ways are counted. Machines that do not close
/// have no error.
class ErrorSpread {
 public:
  ErrorSpread(const Tally& tally, Measure measure);

  double mean() const;
  double std() const;
  double quantile(double share) const;
  /// Of all machines of which these are some.
  Interval quantile_interval(double share, double confidence) const;
  /// Share of the machines up to a value.
  Proportion share_within(double value, double confidence) const;
  /// To the nearest whole machine.
  Histogram counts() const;

 private:
  /// What the pairs say of one stratum.
  struct Stratum {
    std::vector<Histogram::Bin> linear;  ///< its machines to first order
    double machines = 0.0;
    std::vector<double> ratios, weights;  ///< of the pairs; weights add up to 1
  };
  void add(const Stratum& stratum);
  double variance_within(double value) const;
  double at_rank(double rank) const;

  std::vector<double> machines_;
  double total_ = 0.0;
  std::vector<Stratum> corrected_;
};

}  // namespace paracal
