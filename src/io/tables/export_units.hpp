#pragma once

// Private to io: where an instrument's export states the unit of its coordinates, if not in their headings.

#include <optional>
#include <string>
#include <string_view>

#include "export_header.hpp"

namespace paracal::io {

struct StatedUnit {
  double mm;          ///< per unit
  int line;           ///< that states it
  int data_after;     ///< the last line above the points
  std::string where;  ///< for a note
};

/// The unit of the coordinates, by the first of these that the export has:
///   a row of units below the header row: ";[mm];[mm];[mm]"
///   a column of units: "Unit", "Einheit"
///   a line above, or a comment: "Units: Millimeters", "Length Unit;mm;Angle Unit;deg"
/// @param coordinates  columns from 1.
/// @throws InputFileError for a column, or lines above, with two units.
std::optional<StatedUnit> stated_unit(const TextFile& file, const HeaderRow& row, const FieldColumns& coordinates);

bool is_unit_word(std::string_view word);  ///< "unit", "einheit", ..., in lower case

/// The unit that lines above `end`, and comments, state.
std::optional<StatedUnit> unit_above(const TextFile& file, int end);

}  // namespace paracal::io
