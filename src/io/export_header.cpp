#include "export_header.hpp"

#include <algorithm>
#include <cctype>
#include <span>
#include <utility>

#include "columns.hpp"
#include "utf8.hpp"

namespace paracal::io {
namespace {

/// What header rows say besides.
constexpr std::array<LengthUnit, 3> kOtherUnits{{{"in", 25.4}, {"\u00B5m", 0.001}, {"\u03BCm", 0.001}}};

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

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
  if (at == std::string_view::npos || at == 0) return {whole, whole};
  std::string_view unit = text.substr(at + 1);
  if (has_brackets) unit.remove_suffix(1);
  const std::optional<double> mm = unit_named(trimmed(unit));
  return {whole, mm ? std::string(trimmed(text.substr(0, at))) : whole, mm};
}

constexpr std::array<std::string_view, 6> kNameWords{"name", "point", "point name", "target", "label", "pose"};

bool is_wanted(const Heading& heading, std::size_t field, const Places& wanted) {
  if (!wanted[field].empty()) {
    const std::string asked = lower_case(wanted[field]);
    return heading.whole == asked || heading.word == asked;
  }
  if (kExportFields[field] != "name") return heading.word == kExportFields[field];
  return std::ranges::find(kNameWords, heading.word) != kNameWords.end();
}

/// @param wanted  headings; where one is empty, the field's own word.
HeaderRow header_row(int line, std::string_view text, const TableStyle& style, const Places& wanted) {
  HeaderRow row{line, export_fields(with_other_bytes_escaped(text), style.decimal_comma), {}, {}, true};
  for (const std::string& field : row.fields) row.headings.push_back(heading_of(field));
  for (std::size_t k = 0; k < row.headings.size(); ++k) {
    for (std::size_t field = 0; field < kExportFields.size(); ++field) {
      if (is_wanted(row.headings[k], field, wanted)) row.columns[field].push_back(k + 1);
    }
  }
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
    HeaderRow row = header_row(number, line, file.style, wanted);
    row.is_first = std::exchange(is_first, false);
    if (!row.columns[1].empty() && !row.columns[2].empty() && !row.columns[3].empty()) return row;
  }
  return std::nullopt;
}

}  // namespace paracal::io
