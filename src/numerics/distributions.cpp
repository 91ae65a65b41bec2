#include "numerics/distributions.hpp"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace paracal::detail {

using boost::math::binomial_distribution, boost::math::chi_squared_distribution, boost::math::complement,
    boost::math::fisher_f_distribution, boost::math::normal_distribution, boost::math::students_t_distribution;

double normal_quantile(double probability) { return quantile(normal_distribution<>(), probability); }
double two_sided_quantile(double confidence) { return normal_quantile(0.5 + 0.5 * confidence); }

double students_t_quantile(double tail, double freedom) {
  return quantile(complement(students_t_distribution<>(freedom), tail));
}

double chi_square_tail(double sum, double freedom) { return cdf(complement(chi_squared_distribution<>(freedom), sum)); }

double chi_square_quantile(double tail, double freedom) {
  return quantile(complement(chi_squared_distribution<>(freedom), tail));
}

double fisher_tail(double ratio, double numerator, double denominator) {
  return cdf(complement(fisher_f_distribution<>(numerator, denominator), ratio));
}

double fisher_quantile(double tail, double numerator, double denominator) {
  return quantile(complement(fisher_f_distribution<>(numerator, denominator), tail));
}

double binomial_cdf(double hits, double trials, double probability) {
  return cdf(binomial_distribution<>(trials, probability), hits);
}

ProbabilityBounds probability_bounds(double hits, double trials, double risk) {
  return {binomial_distribution<>::find_lower_bound_on_p(trials, hits, risk),
          binomial_distribution<>::find_upper_bound_on_p(trials, hits, risk)};
}

}  // namespace paracal::detail
