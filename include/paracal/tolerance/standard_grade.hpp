#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace paracal {

/// Standard tolerance grades for linear sizes, from fine to coarse [iso286-1].
enum class StandardGrade : std::uint8_t {
  IT01,
  IT0,
  IT1,
  IT2,
  IT3,
  IT4,
  IT5,
  IT6,
  IT7,
  IT8,
  IT9,
  IT10,
  IT11,
  IT12,
  IT13,
  IT14,
  IT15,
  IT16,
  IT17,
  IT18,
};

/// Largest nominal size with grades, mm.
inline constexpr double kLargestGradedSize = 3150.0;

/// "IT8".
std::string_view name(StandardGrade grade);
/// The grade of that name; empty when there is none.
std::optional<StandardGrade> standard_grade_named(std::string_view wanted);

/// Width of the tolerance zone, upper limit less lower limit, mm: by the standard's table, which has priority over
/// its formulae [iso286-1, Table 1]. A range of sizes includes its upper end: 18 mm is of "over 10 up to
/// 18".
///
/// @param size  nominal, mm.
/// @returns     empty where the standard has none: sizes that are not above zero or above 3150 mm, IT01 and IT0 above
///              500 mm, IT14 to IT18 up to 1 mm.
std::optional<double> standard_tolerance(StandardGrade grade, double size);

/// The coarsest grade whose zone is at most this wide (mm) at a size; empty when even the finest is wider.
std::optional<StandardGrade> coarsest_grade(double size, double width);

}  // namespace paracal
