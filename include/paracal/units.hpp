#pragma once

#include <cstdint>
#include <numbers>
#include <string_view>

namespace paracal {

/// Inside the library lengths are in mm and angles in rad; files and output use degrees.
constexpr double to_radians(double degrees) { return degrees * (std::numbers::pi / 180.0); }
constexpr double to_degrees(double radians) { return radians * (180.0 / std::numbers::pi); }

enum class Unit : std::uint8_t { mm, rad, mm_per_m };

/// Unit in files and on screens of what has this one inside the library: "mm", "deg", "mm/m".
constexpr std::string_view file_unit(Unit unit) {
  if (unit == Unit::mm_per_m) return "mm/m";
  return unit == Unit::rad ? "deg" : "mm";
}

/// From the unit inside to that in files, and back.
constexpr double to_file_unit(Unit unit, double value) { return unit == Unit::rad ? to_degrees(value) : value; }
constexpr double from_file_unit(Unit unit, double value) { return unit == Unit::rad ? to_radians(value) : value; }

}  // namespace paracal
