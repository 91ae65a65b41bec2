#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "paracal/tolerance/drawn_feature.hpp"
#include "paracal/tolerance/standard_grade.hpp"

namespace paracal {

/// Half-width T (mm or rad) of a drawing statement for a geometric error:
///
///     IT8 or 375 IT8          a size   T = width of the grade at the nominal size / 2         [iso286-1]
///     375 +- 0.04             a size   T = 0.04, about the robot's nominal size
///     parallelism 0.02/100    a turn   T = asin(0.02 / 100); also perpendicularity, angularity [iso1101]
///     position dia 0.05       a place  T = 0.05 / 2 along each axis                            [iso1101]
///
/// T of the difference of two such parts is twice as wide. Zones t1/L1 + t2/L2 and dia t1 + dia t2 of a chain of
/// parts add up. docs/tolerance.md derives them. "±", "+/-", "Ø" and "⌀" are also accepted. If limbs differ, a
/// grade applies to the size where it is widest.
///
/// @throws InvalidArgument with the expected and actual statement, and the reason.
double half_width_of(std::string_view statement, const DrawnFeature& feature);

/// Largest rotation (rad) of a line within a zone as on drawings, "0.1/100": asin(0.1 / 100). Empty if invalid.
std::optional<double> turn_within(std::string_view text);

/// Drawing statement of a half-width: never wider (except for 1e-12 of it), three digits.
struct DrawingStatement {
  /// Statement for half_width_of(), "375 +- 0.0446"; empty if there is none.
  std::string statement = {};
  /// Size: the coarsest grade within the half-width; empty if there is none.
  std::optional<StandardGrade> grade = {};
  /// With the feature and the grade in words: "bore distance of the arm 375 +- 0.0446 (IT8)". Without a
  /// statement: the reason.
  std::string text = {};
};

/// @param half_width  mm or rad, above zero.
DrawingStatement on_a_drawing(double half_width, const DrawnFeature& feature);
/// The same for a robot's tolerance; empty if it is zero.
std::optional<DrawingStatement> on_a_drawing(const Tolerances& tolerances, Source source, const Robot& robot);

}  // namespace paracal
