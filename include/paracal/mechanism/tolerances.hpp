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
  /// Standard deviation of a source error: T / 3, or T / sqrt(3) when uniform; a normal one cut off at +-T is
  /// narrower by 1.3 %.
  double std(Source source) const;
};

/// For machines whose drawings are not at hand. Position group: encoder offsets about twice the largest of
/// [huang2016, section 5.2.1], lengths and angles about four times the largest of [huang2016, Table 4]. Tilt group:
/// [huang2016, Table 2], whose rod and width differences are divided by the parallelogram's width (mm).
Tolerances generous_tolerances(double parallelogram_width);

}  // namespace paracal
