#pragma once

// Private to io: the header row of an instrument's export.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "export_fields.hpp"

namespace paracal::io {

struct LengthUnit {
  std::string_view name;
  double mm;
};
inline constexpr std::array<LengthUnit, 4> kLengthUnits{{{"mm", 1.0}, {"m", 1000.0}, {"um", 0.001}, {"inch", 25.4}}};

/// What somebody says of each field: a number from 1, a heading, or nothing.
using Places = std::array<std::string, kExportFields.size()>;

/// As header rows and the lines above them name it.
/// @param name  in lower case.
std::optional<double> unit_named(std::string_view name);

/// "X [mm]", "X (mm)", "X_mm", "X mm" as x and 1 mm; so are "Measured X [mm]", "X Actual (mm)" and "Meas_X_mm".
struct Heading {
  std::string whole;  ///< in lower case, as the word
  std::string word;
  std::optional<double> mm = {};
  std::string meaning = {};  ///< words between single blanks, without those that say "measured"
  bool is_measured = false;  ///< has such a word
};

/// A line with headings, and which of them are which field.
struct HeaderRow {
  int line = 0;
  std::vector<std::string> fields;
  std::vector<Heading> headings;
  std::array<std::vector<std::size_t>, kExportFields.size()> columns;  ///< from 1
  bool is_first = true;                                                ///< but for comments
};

/// What a heading says of its column.
Heading heading_of(std::string_view field);

/// The column of names, from 1, by the words of header rows: all columns that have the likeliest of these words.
std::vector<std::size_t> name_columns(const std::vector<Heading>& headings);

/// The first line that names x, y and z.
/// @param wanted  headings; where one is empty, the field's own word.
/// A word that is not known ("Nominal X", "dX") makes another column of it.
std::optional<HeaderRow> find_header(const TextFile& file, const Places& wanted);

/// Whether --ignore-columns names it.
bool is_ignored(const TextFile& file, const std::string& heading);

/// @param taken   from 1.
/// @param wanted  headings that somebody chose.
/// @throws InputFileError for numbers in other columns, unless their headings say that they are for people (nominal
/// values, deviations, dates) or they are to be ignored.
void check_others(const TextFile& file, const HeaderRow& row, const std::vector<std::size_t>& taken,
                  const Places& wanted);

}  // namespace paracal::io
