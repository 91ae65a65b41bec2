#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "paracal/tolerance/drawn_feature.hpp"
#include "paracal/tolerance/standard_grade.hpp"

namespace paracal {

/// Half-width T (mm or rad) of what a drawing says of a source error:
///
///     IT8 or 375 IT8          a size   T = width of the grade at the nominal size / 2         [iso286-1]
///     375 +- 0.04             a size   T = 0.04, about the robot's nominal size
///     parallelism 0.02/100    a turn   T = asin(0.02 / 100); also perpendicularity, angularity [iso1101]
///     position dia 0.05       a place  T = 0.05 / 2 along each axis                            [iso1101]
///
/// An error that is the difference of two parts of a size lies within twice as much. Zones t1/L1 + t2/L2 and dia t1 +
/// dia t2 of a chain of parts add up. docs/tolerance.md derives them. "±", "+/-", "Ø" and "⌀" are read, too. Where
/// limbs are unlike, a grade counts at the size that it leaves widest.
///
/// @throws InvalidArgument with what can be said of this error, what was, and why that cannot be.
double half_width_of(std::string_view statement, const DrawnFeature& feature);

/// Largest turn (rad) of a line within a zone as drawings write it, "0.1/100": asin(0.1 / 100). Empty where it is none.
std::optional<double> turn_within(std::string_view text);

/// What a half-width is on a drawing: never wider (but for 1e-12 of itself), three digits.
struct DrawingStatement {
  /// As half_width_of() reads it, "375 +- 0.0446"; empty where nothing can be said.
  std::string statement = {};
  /// Of a size: the coarsest within it; empty where none is or the size has none.
  std::optional<StandardGrade> grade = {};
  /// With the feature and the grade in words: "bore distance of the arm 375 +- 0.0446 (IT8)". Where there is no
  /// statement: why.
  std::string text = {};
};

/// @param half_width  mm or rad, above zero.
DrawingStatement on_a_drawing(double half_width, const DrawnFeature& feature);
/// The same of a robot's tolerance; empty where a source is exact.
std::optional<DrawingStatement> on_a_drawing(const Tolerances& tolerances, Source source, const Robot& robot);

}  // namespace paracal
