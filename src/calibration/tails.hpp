#pragma once

// Private to calibration: how probable it is that chance alone shows as much.

namespace paracal::detail {

/// Probability that a chi-square variable of `freedom` degrees of freedom is above `sum`.
double chi_square_tail(double sum, double freedom);
/// What a chi-square variable of `freedom` degrees of freedom exceeds with probability `tail`.
double chi_square_quantile(double tail, double freedom);
/// Probability that Fisher's F, a mean square of `numerator` degrees of freedom over one of `denominator`, is above
/// `ratio`.
double fisher_tail(double ratio, double numerator, double denominator);
/// What it exceeds with probability `tail`.
double fisher_quantile(double tail, double numerator, double denominator);

}  // namespace paracal::detail
