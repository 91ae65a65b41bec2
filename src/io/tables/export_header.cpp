#include "export_header.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "columns.hpp"
#include "io/files/letters.hpp"
#include "io/files/utf8.hpp"

namespace paracal::io {
namespace {

/// What header rows say besides.
constexpr std::array<LengthUnit, 12> kOtherUnits{{{"in", 25.4},
                                                  {"inches", 25.4},
                                                  {"\u00B5m", 0.001},
                                                  {"\u03BCm", 0.001},
                                                  {"millimeter", 1.0},
                                                  {"millimeters", 1.0},
                                                  {"millimetre", 1.0},
                                                  {"millimetres", 1.0},
                                                  {"meter", 1000.0},
                                                  {"meters", 1000.0},
                                                  {"metre", 1000.0},
                                                  {"metres", 1000.0}}};

constexpr std::array<std::string_view, 11> kMeasuredWords{
    "measured", "meas", "actual", "act", "ist", "istwert", "messwert", "gemessen", "mesur\u00E9", "medido", "misurato"};

/// What they say besides of a coordinate.
constexpr std::array<std::string_view, 7> kEmptyWords{"wert",       "value",           "coord",   "coordinate",
                                                      "koordinate", "coordonn\u00E9e", "position"};

/// Says what the word of a heading means.
Heading with_meaning(Heading heading) {
  constexpr std::string_view kBetween = " _-.:()[]";
  std::string_view rest = heading.word;
  while (true) {
    rest.remove_prefix(std::min(rest.find_first_not_of(kBetween), rest.size()));
    if (rest.empty()) return heading;
    const std::string_view word = rest.substr(0, rest.find_first_of(kBetween));
    rest.remove_prefix(word.size());
    if (std::ranges::find(kMeasuredWords, word) != kMeasuredWords.end()) {
      heading.is_measured = true;
    } else if (std::ranges::find(kEmptyWords, word) == kEmptyWords.end()) {
      heading.meaning.append(heading.meaning.empty() ? "" : " ").append(word);
    }
  }
}

/// Headings of the column of names. The first group of which a header row has any counts: an object may be of a
/// feature, and a running number is a name only where nothing else is.
constexpr std::array<std::string_view, 15> kNames{
    "name",      "point", "point name", "pointname", "target",       "target name",  "label",         "pose",
    "pose name", "punkt", "punktname",  "messpunkt", "nom du point", "nombre punto", "nome del punto"};
constexpr std::array<std::string_view, 16> kObjects{
    "object",  "object name",  "object id",  "point id", "pointid", "pt id",       "target id", "point label",
    "feature", "feature name", "feature id", "punkt id", "merkmal", "bezeichnung", "element",   "element name"};
constexpr std::array<std::string_view, 12> kNumbers{
    "id", "no", "nr", "number", "point no", "point nr", "point number", "punktnr", "punkt nr", "pt", "pnt", "#"};

bool is_name(const Heading& heading, std::span<const std::string_view> words) {
  return std::ranges::find(words, heading.meaning) != words.end();
}

}  // namespace

std::optional<double> unit_named(std::string_view name) {
  for (const auto& units : {std::span<const LengthUnit>(kLengthUnits), std::span<const LengthUnit>(kOtherUnits)}) {
    for (const LengthUnit& unit : units) {
      if (unit.name == name) return unit.mm;
    }
  }
  return std::nullopt;
}

Heading heading_of(std::string_view field) {
  const std::string whole = lower_case(field);
  std::string_view text = whole;
  const bool has_brackets = text.ends_with(']') || text.ends_with(')');
  const std::size_t at = text.find_last_of(has_brackets ? "[(" : "_ ");
  if (at == std::string_view::npos || at == 0) return with_meaning({whole, whole});
  std::string_view unit = text.substr(at + 1);
  if (has_brackets) unit.remove_suffix(1);
  const std::optional<double> mm = unit_named(trimmed(unit));
  return with_meaning({whole, mm ? std::string(trimmed(text.substr(0, at))) : whole, mm});
}

std::vector<std::size_t> name_columns(const std::vector<Heading>& headings) {
  std::vector<std::size_t> columns;
  for (const auto& words : {std::span<const std::string_view>(kNames), std::span<const std::string_view>(kObjects),
                            std::span<const std::string_view>(kNumbers)}) {
    for (std::size_t k = 0; k < headings.size(); ++k) {
      if (is_name(headings[k], words)) columns.push_back(k + 1);
    }
    if (!columns.empty()) break;
  }
  return columns;
}

namespace {

bool is_wanted(const Heading& heading, std::size_t field, const Places& wanted) {
  if (!wanted[field].empty()) {
    const std::string asked = lower_case(wanted[field]);
    return heading.whole == asked || heading.word == asked;
  }
  return kExportFields[field] != "name" && heading.meaning == kExportFields[field];
}

/// @param wanted  headings; where one is empty, the field's own word.
HeaderRow header_row(int line, std::string_view text, const TextFile& file, const Places& wanted) {
  HeaderRow row{line, export_fields(with_other_bytes_decoded(text), file.style.decimal_comma), {}, {}, true};
  for (const std::string& field : row.fields) {
    row.headings.push_back(is_ignored(file, field) ? Heading() : heading_of(field));
  }
  for (std::size_t k = 0; k < row.headings.size(); ++k) {
    for (std::size_t field = 0; field < kExportFields.size(); ++field) {
      if (is_wanted(row.headings[k], field, wanted)) row.columns[field].push_back(k + 1);
    }
  }
  if (wanted[0].empty()) row.columns[0] = name_columns(row.headings);
  return row;
}

}  // namespace

std::optional<HeaderRow> find_header(const TextFile& file, const Places& wanted) {
  constexpr int kLongestHead = 1000;
  int number = 0;
  bool is_first = true;
  for (const std::string_view line : lines_of(file.text)) {
    if (++number > kLongestHead) break;
    if (is_export_comment(line)) continue;
    HeaderRow row = header_row(number, line, file, wanted);
    row.is_first = std::exchange(is_first, false);
    if (!row.columns[1].empty() && !row.columns[2].empty() && !row.columns[3].empty()) return row;
  }
  return std::nullopt;
}

}  // namespace paracal::io
