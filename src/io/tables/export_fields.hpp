#pragma once

// Private to io: the lines of an instrument's export, and where they hold what is needed.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/io/points.hpp"

namespace paracal::io {

inline constexpr std::array<std::string_view, 5> kExportFields{"name", "x", "y", "z", "sigma"};
using FieldColumns = std::array<std::size_t, kExportFields.size()>;  ///< 0: none

FieldColumns field_columns(const ColumnMap& map);

/// As the user gives them: "name=3,x=4,y=5,z=6".
std::string text_of(const FieldColumns& places);

/// @throws InvalidArgument where something is missing or stands twice.
void check_map(const ColumnMap& map);

/// One that begins with // or #, and one without letters and digits: empty, a ruled line, nothing but separators.
bool is_export_comment(std::string_view line);

/// A line's fields, without quotation marks and blanks around them. Tabs, semicolons, commas or blanks separate them:
/// the first of these that the line holds outside quotation marks.
/// @param decimal_comma  commas do not separate.
std::vector<std::string> export_fields(std::string_view line, bool decimal_comma);

}  // namespace paracal::io
