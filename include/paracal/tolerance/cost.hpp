#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace paracal {

/// How the cost of a part grows as its tolerance T (half-width, mm or rad) shrinks  [hallmann2020].
enum class CostLaw : std::uint8_t {
  reciprocal,         ///< A + B / T            [huang2016, Eq. (12), with 1 / sigma]
  reciprocal_square,  ///< A + B / T^2
  exponential,        ///< A + B exp(-T / C)
  power,              ///< A + B / T^C
  grades,             ///< one of a few processes, each with its tolerance and its price
};

/// A process and what it holds.
struct Grade {
  std::string name;
  double tolerance = 0.0;  ///< half-width, mm or rad
  double cost = 0.0;
};

struct CostCurve {
  CostLaw law = CostLaw::reciprocal;
  double A = 0.0;  ///< cost of a part whatever its tolerance
  double B = 1.0;  ///< cost times the unit that the law asks for
  double C = 1.0;  ///< mm or rad (exponential), or the exponent (power)
  std::vector<Grade> grades = {};

  /// For grades: of the cheapest one that holds T; infinite when none does.
  double cost(double tolerance) const;
  /// d cost / d T, below zero. Not for grades.
  double slope(double tolerance) const;
};

/// "reciprocal", "reciprocal-square", "exponential", "power", "grades".
std::string_view name(CostLaw law);
std::optional<CostLaw> cost_law_named(std::string_view wanted);

}  // namespace paracal
