#include "numerics/distributions.hpp"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace paracal::detail {

namespace {

/// Computes with double. Boost's default computes with long double, which takes longer to compile and to run, for
/// digits that nobody prints.
using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using Binomial = boost::math::binomial_distribution<double, Policy>;
using ChiSquared = boost::math::chi_squared_distribution<double, Policy>;
using FisherF = boost::math::fisher_f_distribution<double, Policy>;
using Normal = boost::math::normal_distribution<double, Policy>;
using StudentsT = boost::math::students_t_distribution<double, Policy>;
using boost::math::complement;

}  // namespace

double normal_quantile(double probability) { return quantile(Normal(), probability); }
double two_sided_quantile(double confidence) { return normal_quantile(0.5 + 0.5 * confidence); }

double students_t_quantile(double tail, double freedom) { return quantile(complement(StudentsT(freedom), tail)); }

double chi_square_tail(double sum, double freedom) { return cdf(complement(ChiSquared(freedom), sum)); }

double chi_square_quantile(double tail, double freedom) { return quantile(complement(ChiSquared(freedom), tail)); }

double fisher_tail(double ratio, double numerator, double denominator) {
  return cdf(complement(FisherF(numerator, denominator), ratio));
}

double fisher_quantile(double tail, double numerator, double denominator) {
  return quantile(complement(FisherF(numerator, denominator), tail));
}

double binomial_cdf(double hits, double trials, double probability) { return cdf(Binomial(trials, probability), hits); }

ProbabilityBounds probability_bounds(double hits, double trials, double risk) {
  return {Binomial::find_lower_bound_on_p(trials, hits, risk), Binomial::find_upper_bound_on_p(trials, hits, risk)};
}

}  // namespace paracal::detail
