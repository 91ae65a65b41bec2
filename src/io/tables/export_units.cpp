#include "export_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "columns.hpp"
#include "io/files/letters.hpp"
#include "io/files/utf8.hpp"
#include "paracal/error.hpp"

namespace paracal::io {
namespace {

constexpr std::array<std::string_view, 10> kUnitWords{"unit",  "units",       "einheit", "einheiten", "unit\u00E9",
                                                      "unite", "unit\u00E9s", "unidad",  "unidades",  "unit\u00E0"};

}  // namespace

bool is_unit_word(std::string_view word) { return std::ranges::find(kUnitWords, word) != kUnitWords.end(); }

namespace {

/// "[mm]", "(mm)" and "mm" as mm.
std::optional<double> unit_of_cell(std::string_view cell) { return unit_named(lower_case(trimmed(cell, " []()\t"))); }

/// Words of a line in lower case: letters, digits, and whatever is no ASCII ("Unit M12" states no metres).
std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  bool goes_on = false;
  for (const char c : with_other_bytes_decoded(line)) {
    const bool is_part = is_letter(c) || is_digit(c) || static_cast<unsigned char>(c) >= 0x80;
    if (is_part && !goes_on) words.emplace_back();
    if (is_part) words.back() += lower_case(c);
    goes_on = is_part;
  }
  return words;
}

/// The length unit that a line states: the word behind "unit" or "units".
std::optional<double> unit_of_line(std::string_view line) {
  const std::vector<std::string> words = words_of(line);
  for (std::size_t k = 0; k + 1 < words.size(); ++k) {
    if (!is_unit_word(words[k])) continue;
    if (const auto mm = unit_named(words[k + 1])) return mm;
  }
  return std::nullopt;
}

std::vector<std::string> row_of(const TextFile& file, std::string_view line) {
  return export_fields(with_other_bytes_decoded(line), file.style.decimal_comma);
}

/// The row of units directly below the headings.
std::optional<StatedUnit> unit_below(const TextFile& file, const HeaderRow& row, const FieldColumns& coordinates) {
  const std::vector<std::string_view> lines = lines_of(file.text);
  const auto below = static_cast<std::size_t>(row.line);
  if (below >= lines.size()) return std::nullopt;
  const std::vector<std::string> fields = row_of(file, lines[below]);
  std::optional<double> mm;
  for (std::size_t k = 1; k <= 3; ++k) {
    if (coordinates[k] > fields.size()) return std::nullopt;
    const auto unit = unit_of_cell(fields[coordinates[k] - 1]);
    if (!unit || (mm && *mm != *unit)) return std::nullopt;
    mm = unit;
  }
  return StatedUnit{*mm, row.line + 1, row.line + 1, fmt::format("line {}", row.line + 1)};
}

/// A column with the unit of each row, the same in all.
std::optional<StatedUnit> unit_beside(const TextFile& file, const HeaderRow& row) {
  const auto found = std::ranges::find_if(row.headings, [](const Heading& h) { return is_unit_word(h.whole); });
  if (found == row.headings.end()) return std::nullopt;
  const auto column = static_cast<std::size_t>(found - row.headings.begin());
  std::optional<StatedUnit> stated;
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    if (++number <= row.line || is_export_comment(line)) continue;
    const std::vector<std::string> fields = row_of(file, line);
    const auto mm = column < fields.size() ? unit_of_cell(fields[column]) : std::nullopt;
    if (!mm) return std::nullopt;
    if (stated && stated->mm != *mm) {
      throw InputFileError(file.name, number,
                           fmt::format("expected the unit of line {} in column \"{}\", got \"{}\"", stated->line,
                                       row.fields[column], fields[column]));
    }
    if (!stated) stated = {*mm, number, row.line, fmt::format("column \"{}\"", row.fields[column])};
  }
  return stated;
}

}  // namespace

std::optional<StatedUnit> unit_above(const TextFile& file, int end) {
  std::optional<StatedUnit> stated;
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    const bool is_above = ++number < end;
    if (!is_above && !is_export_comment(line)) break;
    const auto mm = unit_of_line(line);
    if (!mm) continue;
    if (stated && stated->mm != *mm) {
      throw InputFileError(
          file.name, number,
          fmt::format("expected one unit of length above the points, got another one in line {}", stated->line));
    }
    if (!stated) stated = {*mm, number, end, fmt::format("line {}", number)};
  }
  return stated;
}

std::optional<StatedUnit> stated_unit(const TextFile& file, const HeaderRow& row, const FieldColumns& coordinates) {
  if (auto below = unit_below(file, row, coordinates)) return below;
  if (auto beside = unit_beside(file, row)) return beside;
  return unit_above(file, row.line);
}

}  // namespace paracal::io
