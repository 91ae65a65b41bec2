#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// How a source error spreads over a batch of machines within its tolerance.
enum class Distribution : std::uint8_t { normal, uniform, truncated_normal };

/// Who says a half-width.
enum class Origin : std::uint8_t {
  stated,    ///< a drawing, a file, a design
  generous,  ///< nobody: a generous default
  exact,     ///< a table, of all errors that it does not list: zero
};

/// Tolerance half-widths T = 3 sigma, one number a source, equal for all limbs [huang2016, Eqs. (10), (13)];
/// mm or rad by the source's unit. Zero means exact.
///
/// Where the errors of built parts have been measured, their values replace half-width and distribution in everything
/// statistical; a worst case goes by the half-width, or by the largest value where no half-width is stated.
struct Tolerances {
  std::array<double, kSourceCount> half_width{};
  Distribution distribution = Distribution::normal;
  std::array<std::vector<double>, kSourceCount> measured{};  ///< errors found on built parts, mm or rad; may be empty
  std::array<Origin, kSourceCount> origin{};
  /// What was taken without being stated, in words and with its values, as list_assumed() says it; belongs into every
  /// result that depends on the tolerances.
  std::vector<std::string> assumed{};

  double& operator[](Source source) { return half_width[index(source)]; }
  double operator[](Source source) const { return half_width[index(source)]; }
  /// Whoever designs decides: this half-width, and nothing measured.
  void state(Source source, double value);
  /// Mean of a source error: zero unless measured.
  double mean(Source source) const;
  /// Standard deviation of a source error: T / 3, or T / sqrt(3) when uniform; a normal one cut off at +-T is
  /// narrower by 1.3 %. That of the measured values where there are any.
  double std(Source source) const;
  /// Largest |error| that the drawing admits.
  double largest(Source source) const;
};

/// Fills `assumed` from the half-widths and their origin.
void list_assumed(Tolerances& tolerances, Actuator actuator);

struct Geometry;

/// Every half-width from nobody. For machines whose drawings are not at hand. Position group: encoder offsets about
/// twice the largest of [huang2016, section 5.2.1] (endstops of rails 3 mm), lengths and angles about four times the
/// largest of [huang2016, Table 4]. Struts: 3 mm of each coordinate of a joint and of the zero, 15 mm/m of the drive.
/// Tilt group: [huang2016, Table 2], whose rod and width differences are divided by the parallelogram's width. Errors
/// that the actuator does not feel are exact, but for e_z, which shares its tolerance with e_x and e_y.
Tolerances generous_tolerances(const Geometry& geometry);

}  // namespace paracal
