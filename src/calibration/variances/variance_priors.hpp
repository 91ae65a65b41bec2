#pragma once

// Private to calibration: priors of the logarithms of standard deviations.

namespace paracal::detail {

/// Minus the logarithm of a prior density of u, but for a constant, with its first and second derivative.
struct Slope {
  double cost = 0.0, slope = 0.0, curvature = 0.0;
};

/// Half-Cauchy of exp(u), with the Jacobian of the logarithm.
Slope half_cauchy(double u, double scale);

/// What was stated is so, or larger: by a factor whose logarithm is exponentially distributed, rounded at zero. Never
/// less. Of one peak, unlike a heavier tail: what readings hardly tell stays as it was stated.
Slope as_stated(double u, double mean);

/// Noise of a series that is suspected to be larger than it states: within a factor of some e of what the readings
/// suggest. The density itself, not but for a constant: tables with and without it are compared.
Slope of_suspected_noise(double u, double about);

/// Noise that nobody stated, but not below what no instrument is.
Slope any_noise(double u, double least);

}  // namespace paracal::detail
