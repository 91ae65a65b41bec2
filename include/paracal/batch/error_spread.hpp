#pragma once

#include <vector>

#include "paracal/batch/tally.hpp"

namespace paracal {

/// A quantity of a machine.
struct Measure {
  ErrorKind kind = ErrorKind::distance;
  bool after = true;     ///< calibration
  bool used_up = false;  ///< instead: the largest error after calibration over its limit
};

/// Distribution of an error over a batch of N machines, computed to first order (l); n of them also exactly (g). The
/// probability of an error above x is the first-order prediction, corrected by its error on the n machines
/// [angelopoulos2023]:
///
///   \f[ Q(x) = \lambda \bar p_{N-n} + \overline{(1[g > x] - \lambda p(l))}_n, \qquad \lambda = 1 - n / N \f]
///
/// with p(l) the fraction of the n ratios g / l above x / l. Their distribution is arbitrary: a bad prediction widens
/// the interval, but causes no bias. With V the variance of Q, the interval is that of a score test with one additional
/// unpredicted machine:
///
///   \f[ |Q - q| \le h = z^2 / 2n + \sqrt{(z^2 / 2n)^2 + z^2 V} \f]
///
/// So the interval is never narrower than n machines allow: without errors h = z^2 / n, as for a counted proportion
/// [wilson1927]. If produce() computed all, n = N and this is the counted distribution. Scrap has no error; in
/// `used_up` it does not pass.
class ErrorSpread {
 public:
  ErrorSpread(const Tally& tally, Measure measure);

  struct Moments {
    double mean = 0.0, std = 0.0;
  };
  Moments moments() const;
  /// Smallest value that at least this fraction does not exceed; NaN without machines.
  double quantile(double share) const;
  /// Interval for all possible machines. From 0, and to infinity if these machines are too few.
  Interval quantile_interval(double share, double confidence) const;
  /// Probability of errors below a value.
  Proportion share_within(double value, double confidence) const;
  /// To the nearest whole machine.
  Histogram counts() const;

 private:
  /// Exact machines alike.
  struct Known {
    std::int64_t linear = 0, exact = 0;  ///< bins
    double machines = 1.0;
    bool closes = true;
  };
  /// The probability of an error beyond a bin, and its variance.
  struct Beyond {
    double value = 0.0, variance = 0.0;
  };
  void predict_from_shifts();
  double predicted(std::int64_t linear, std::int64_t bin) const;
  Beyond beyond(std::int64_t bin) const;
  double half_width(const Beyond& at, double z) const;
  template <typename Condition>
  std::int64_t first_bin(const Condition& condition) const;
  std::vector<double> machines_by_bin() const;

  std::vector<Known> known_;
  std::vector<Histogram::Bin> others_;  ///< machines computed only to first order
  std::vector<std::int64_t> shifts_;    ///< bins from linear to exact, ascending
  std::vector<double> larger_shifts_;   ///< percentage above shifts_.front(), above the next bin, ...
  double n_ = 0.0, closed_ = 0.0, rest_ = 0.0;
  std::int64_t lowest_ = 0, highest_ = 0;  ///< all lie in these bins
};

}  // namespace paracal
