#pragma once

// Private to the library: probabilities of the usual distributions. Boost's are templates that take seconds to compile
// in every file that uses one; here each is compiled once.

#include <cmath>
#include <numbers>

namespace paracal::detail {

/// Probability that a standard normal variable is below z, with all its digits for z far below zero.
inline double normal_probability(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }
/// The z that it is below with a probability.
double normal_quantile(double probability);
/// The z with -z to z holding a standard normal variable with a probability of `confidence`.
double two_sided_quantile(double confidence);

/// What a variable of Student's t of `freedom` degrees of freedom exceeds with probability `tail`.
double students_t_quantile(double tail, double freedom);

/// Probability that a chi-square variable of `freedom` degrees of freedom is above `sum`.
double chi_square_tail(double sum, double freedom);
/// What a chi-square variable of `freedom` degrees of freedom exceeds with probability `tail`.
double chi_square_quantile(double tail, double freedom);

/// Probability that Fisher's F, a mean square of `numerator` degrees of freedom over one of `denominator`, is above
/// `ratio`.
double fisher_tail(double ratio, double numerator, double denominator);
/// What it exceeds with probability `tail`.
double fisher_quantile(double tail, double numerator, double denominator);

/// Probability of at most `hits` in `trials` of which each hits with `probability`.
double binomial_cdf(double hits, double trials, double probability);
/// The probabilities of a hit with which as few, or as many, hits happen with probability `risk`.
struct ProbabilityBounds {
  double low = 0.0, high = 1.0;
};
ProbabilityBounds probability_bounds(double hits, double trials, double risk);

}  // namespace paracal::detail
