#include "variance_priors.hpp"

#include <cmath>

namespace paracal::detail {
namespace {

Slope normal(double u, double std) { return {0.5 * u * u / (std * std), u / (std * std), 1.0 / (std * std)}; }

}  // namespace

Slope half_cauchy(double u, double scale) {
  const double square = std::exp(2.0 * (u - std::log(scale)));
  return {std::log1p(square) - u, 2.0 * square / (1.0 + square) - 1.0, 4.0 * square / std::pow(1.0 + square, 2)};
}

Slope as_stated(double u, double mean) {
  constexpr double kBelow = 0.02, kRound = 0.1;
  const double bend = kRound * kRound / mean;
  if (u < bend) return normal(u, u < 0.0 ? kBelow : kRound);
  return {(u - 0.5 * bend) / mean, 1.0 / mean, 0.0};
}

Slope any_noise(double u, double least) {
  constexpr double kAny = 3.0, kBelow = 0.1;  // a factor of 20 either way surprises nobody
  Slope slope = normal(u, kAny);
  if (u >= least) return slope;
  const Slope below = normal(u - least, kBelow);
  return {slope.cost + below.cost, slope.slope + below.slope, slope.curvature + below.curvature};
}

Slope of_suspected_noise(double u, double about) { return normal(u - about, 1.0); }

}  // namespace paracal::detail
