#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "paracal/mechanism/limb_description.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// Distribution of a geometric error within its tolerance.
enum class Distribution : std::uint8_t { normal, uniform, truncated_normal };

/// Origin of a half-width.
enum class Origin : std::uint8_t {
  stated,    ///< stated in a drawing, a file or a design
  generous,  ///< not stated: a default tolerance
  exact,     ///< not listed in a table: zero
};

/// Tolerance half-widths T = 3 sigma, one per geometric error, equal for all limbs [huang2016, Eqs. (10), (13)];
/// mm or rad by the source's unit. Zero means exact.
///
/// Measured errors of built parts replace half-width and distribution in all statistics. A worst case uses the
/// half-width, or the largest measured value if no half-width is stated.
struct Tolerances {
  BySource<double> half_width{};
  Distribution distribution = Distribution::normal;
  BySource<std::vector<double>> measured{};  ///< errors measured on parts, mm or rad; may be empty
  BySource<Origin> origin{};
  /// Assumptions in words, with their values, from list_assumed(). Every result that depends on the tolerances states
  /// them.
  std::vector<std::string> assumed{};

  double& operator[](Source source) { return half_width[source]; }
  double operator[](Source source) const { return half_width[source]; }
  /// Sets this half-width and removes measured values, for design.
  void state(Source source, double value);
  /// Mean of a geometric error: zero unless measured.
  double mean(Source source) const;
  /// Standard deviation of a geometric error: T / 3, or T / sqrt(3) when uniform; a normal one cut off at +-T is
  /// narrower by 1.3 %. With measured values: their standard deviation.
  double std(Source source) const;
  /// Largest |error| within the tolerance.
  double largest(Source source) const;
};

/// Fills `assumed` from the half-widths and their origin.
void list_assumed(Tolerances& tolerances, const Limbs& limbs);

/// Default tolerances, for machines without known drawings. Position group: encoder offsets about
/// twice the largest of [huang2016, section 5.2.1] (endstops of rails 3 mm). Lengths and angles: about four times the
/// largest of [huang2016, Table 4]. Struts: 3 mm for each coordinate of a joint and the zero, 15 mm/m for the drive.
/// Tilt group: [huang2016, Table 2], whose rod and width differences are divided by the parallelogram's width. Limbs of
/// different kinds share the wider of two.
Tolerances generous_tolerances(const Limbs& limbs);

}  // namespace paracal
