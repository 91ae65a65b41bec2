#pragma once

#include <string_view>

#include "paracal/mechanism/source_errors.hpp"
#include "paracal/units.hpp"

namespace paracal::io {

/// Unit in files and on screens of what is in mm or rad inside the library: "mm" or "deg".
constexpr std::string_view file_unit(Unit unit) { return unit == Unit::rad ? "deg" : "mm"; }

/// From mm or rad to mm or deg, and back.
constexpr double to_file_unit(Unit unit, double value) { return unit == Unit::rad ? to_degrees(value) : value; }
constexpr double from_file_unit(Unit unit, double value) { return unit == Unit::rad ? to_radians(value) : value; }

}  // namespace paracal::io
