#include "paracal/tolerance/cost.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace paracal {
namespace {

constexpr std::array<std::string_view, 5> kLaws{"reciprocal", "reciprocal-square", "exponential", "power", "grades"};

double cheapest_grade(const std::vector<Grade>& grades, double tolerance) {
  double cheapest = std::numeric_limits<double>::infinity();
  for (const Grade& grade : grades) {
    if (grade.tolerance <= tolerance) cheapest = std::min(cheapest, grade.cost);
  }
  return cheapest;
}

}  // namespace

double CostCurve::cost(double tolerance) const {
  switch (law) {
    case CostLaw::reciprocal:
      return A + B / tolerance;
    case CostLaw::reciprocal_square:
      return A + B / (tolerance * tolerance);
    case CostLaw::exponential:
      return A + B * std::exp(-tolerance / C);
    case CostLaw::power:
      return A + B * std::pow(tolerance, -C);
    case CostLaw::grades:
      return cheapest_grade(grades, tolerance);
  }
  return 0.0;
}

double CostCurve::slope(double tolerance) const {
  switch (law) {
    case CostLaw::reciprocal:
      return -B / (tolerance * tolerance);
    case CostLaw::reciprocal_square:
      return -2.0 * B / (tolerance * tolerance * tolerance);
    case CostLaw::exponential:
      return -B / C * std::exp(-tolerance / C);
    case CostLaw::power:
      return -C * B * std::pow(tolerance, -C - 1.0);
    case CostLaw::grades:
      break;
  }
  return 0.0;
}

std::string_view name(CostLaw law) { return kLaws[static_cast<std::size_t>(law)]; }

std::optional<CostLaw> cost_law_named(std::string_view wanted) {
  const auto* const found = std::ranges::find(kLaws, wanted);
  if (found == kLaws.end()) return std::nullopt;
  return static_cast<CostLaw>(found - kLaws.begin());
}

}  // namespace paracal
