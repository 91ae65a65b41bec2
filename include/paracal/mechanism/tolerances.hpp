#pragma once

#include <array>
#include <cstdint>

#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// How a source error spreads over a batch of machines within its tolerance.
enum class Distribution : std::uint8_t { normal, uniform, truncated_normal };

/// Tolerance half-widths T = 3 sigma, one number a source, equal for all limbs [huang2016, Eqs. (10), (13)];
/// mm or rad by the source's unit. Zero means exact.
struct Tolerances {
  std::array<double, kSourceCount> half_width{};
  Distribution distribution = Distribution::normal;

  double& operator[](Source source) { return half_width[index(source)]; }
  double operator[](Source source) const { return half_width[index(source)]; }
};

}  // namespace paracal
