#pragma once

// Private to calibration: how probable it is that chance alone shows as much.

namespace paracal::detail {

/// Probability that a chi-square variable of `freedom` degrees of freedom is above `sum`.
double chi_square_tail(double sum, double freedom);
/// The same of Fisher's F: a mean square of `numerator` degrees of freedom over one of `denominator`.
double fisher_tail(double ratio, double numerator, double denominator);

}  // namespace paracal::detail
