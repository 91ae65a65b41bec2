#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace paracal {

/// Cost of a part against its tolerance T (half-width, mm or rad)  [hallmann2020].
enum class CostLaw : std::uint8_t {
  reciprocal,         ///< A + B / T            [huang2016, Eq. (12), with 1 / sigma]
  reciprocal_square,  ///< A + B / T^2
  exponential,        ///< A + B exp(-T / C)
  power,              ///< A + B / T^C
  grades,             ///< one of several processes, each with its tolerance and cost
};

/// A process with its tolerance and cost.
struct Grade {
  std::string name;
  double tolerance = 0.0;  ///< half-width, mm or rad
  double cost = 0.0;
};

struct CostCurve {
  CostLaw law = CostLaw::reciprocal;
  double A = 0.0;  ///< cost of a part independent of its tolerance
  double B = 1.0;  ///< cost times the unit of the law
  double C = 1.0;  ///< mm or rad (exponential), or the exponent (power)
  std::vector<Grade> grades = {};

  /// For grades: the cheapest one within T; infinite if there is none.
  double cost(double tolerance) const;
  /// d cost / d T, below zero. Not for grades.
  double slope(double tolerance) const;
};

/// "reciprocal", "reciprocal-square", "exponential", "power", "grades".
std::string_view name(CostLaw law);
std::optional<CostLaw> cost_law_named(std::string_view wanted);

}  // namespace paracal
