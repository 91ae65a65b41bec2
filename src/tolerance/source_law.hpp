#pragma once

// Private to tolerance: how one source error spreads, as drawn and tilted towards large values.

#include <vector>

#include "paracal/mechanism/tolerances.hpp"

namespace paracal::detail {

/// The distribution of a source error e with density f, and the same tilted exponentially  [siegmund1976]:
///
///   f_t(e) = f(e) exp(t e - K(t)),   K(t) = log E exp(t e),   K'(t) = mean of f_t
///
/// A sum of such errors that all tilt with t = theta a_k is, of all laws with that mean, the least unlikely way to be
/// as large. Of a normal error it is a shift of the mean by t sigma^2.
class SourceLaw {
 public:
  SourceLaw(const Tolerances& tolerances, Source source);

  /// K(t), t in 1 / mm or 1 / rad.
  double cumulant(double t) const;
  /// K'(t), mm or rad.
  double mean(double t) const;
  /// The quantile of f_t at the probability of a standard normal number; without tilt source_error() of it.
  double draw(double t, double standard_normal) const;

  double std() const { return std_; }
  /// Largest value of e, and the smallest: infinite of a normal law.
  double most() const { return most_; }
  double least() const { return least_; }
  /// Beyond this |t| a bounded law stands within a few percent of its end, and formulas lose their digits.
  double largest_tilt() const;

 private:
  double measured_cumulant(double t) const;

  const Tolerances* tolerances_;
  Source source_;
  double half_width_ = 0.0, std_ = 0.0, least_ = 0.0, most_ = 0.0;
  std::vector<double> measured_;
};

}  // namespace paracal::detail
