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

/// How an error spreads over the machines of a batch, of which N are known to first order (l) and n of these exactly
/// (g), too. The probability that an error is beyond x is what first order predicts, corrected by how that errs on the
/// n  [angelopoulos2023],
///
///   \f[ Q(x) = \lambda \bar p_{N-n} + \overline{(1[g > x] - \lambda p(l))}_n, \qquad \lambda = 1 - n / N \f]
///
/// with p(l) the percentage of the n ratios g / l above x / l. Nothing is assumed of these: a bad prediction costs
/// width, not truth. With V the variance of Q, the interval is that of a score test which counts one machine more that
/// no prediction saw,
///
///   \f[ |Q - q| \le h = z^2 / 2n + \sqrt{(z^2 / 2n)^2 + z^2 V} \f]
///
/// so that nothing is known better than n machines can tell: without surprises h = z^2 / n, as of a counted proportion
/// [wilson1927]. Where all were made by produce(), n = N and this is the counted distribution. Scrap has no error; of
/// `used_up` it does not pass.
class ErrorSpread {
 public:
  ErrorSpread(const Tally& tally, Measure measure);

  struct Moments {
    double mean = 0.0, std = 0.0;
  };
  Moments moments() const;
  /// Smallest value that at least this percentage does not exceed; NaN without machines.
  double quantile(double share) const;
  /// Of all machines of which these are some. From 0 and to infinity where these machines cannot tell.
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
  std::vector<Histogram::Bin> others_;  ///< machines known to first order alone
  std::vector<std::int64_t> shifts_;    ///< bins from linear to exact, ascending
  std::vector<double> larger_shifts_;   ///< percentage above shifts_.front(), above the next bin, ...
  double n_ = 0.0, closed_ = 0.0, rest_ = 0.0;
  std::int64_t lowest_ = 0, highest_ = 0;  ///< all lie in these bins
};

}  // namespace paracal
