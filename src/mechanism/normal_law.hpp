#pragma once

// Private: the standard normal law.

#include <cmath>
#include <numbers>

namespace paracal::detail {

/// Phi(z), with all its digits for z far below zero.
inline double normal_probability(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

}  // namespace paracal::detail
