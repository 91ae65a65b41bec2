#include "tails.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>

namespace paracal::detail {

double chi_square_tail(double sum, double freedom) {
  return cdf(complement(boost::math::chi_squared_distribution<>(freedom), sum));
}

double chi_square_quantile(double tail, double freedom) {
  return quantile(complement(boost::math::chi_squared_distribution<>(freedom), tail));
}

double fisher_tail(double ratio, double numerator, double denominator) {
  return cdf(complement(boost::math::fisher_f_distribution<>(numerator, denominator), ratio));
}

double fisher_quantile(double tail, double numerator, double denominator) {
  return quantile(complement(boost::math::fisher_f_distribution<>(numerator, denominator), tail));
}

}  // namespace paracal::detail
