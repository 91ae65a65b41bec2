#include "export_fields.hpp"

#include <fmt/format.h>

#include "columns.hpp"

namespace paracal::io {

FieldColumns field_columns(const ColumnMap& map) { return {map.name, map.x, map.y, map.z, map.sigma.value_or(0)}; }

std::string text_of(const FieldColumns& places) {
  std::string text;
  for (std::size_t k = 0; k < kExportFields.size(); ++k) {
    if (places[k] != 0) text += fmt::format("{}{}={}", text.empty() ? "" : ",", kExportFields[k], places[k]);
  }
  return text;
}

bool is_export_comment(std::string_view line) {
  const std::size_t start = line.find_first_not_of(" \t");
  if (start == std::string_view::npos || line.substr(start).starts_with("//") || line[start] == '#') return true;
  return line.find_first_not_of("-=_+|*;, \t") == std::string_view::npos;
}

namespace {

char separator_of(std::string_view line, bool decimal_comma) {
  const std::vector<std::string_view> by_quotes = split(line, '"');  // every second part is inside
  for (const char separator : {'\t', ';', ','}) {
    if (separator == ',' && decimal_comma) continue;
    for (std::size_t k = 0; k < by_quotes.size(); k += 2) {
      if (by_quotes[k].find(separator) != std::string_view::npos) return separator;
    }
  }
  return ' ';
}

/// Takes a field off the front of a line; a doubled quotation mark inside quotation marks is one.
std::string take_field(std::string_view& rest, char separator) {
  std::string field;
  bool is_quoted = false;
  while (!rest.empty() && (is_quoted || rest.front() != separator)) {
    const char c = rest.front();
    rest.remove_prefix(1);
    if (c != '"') {
      field += c;
    } else if (is_quoted && rest.starts_with('"')) {
      field += c;
      rest.remove_prefix(1);
    } else {
      is_quoted = !is_quoted;
    }
  }
  return std::string(trimmed(field, " "));
}

}  // namespace

std::vector<std::string> export_fields(std::string_view line, bool decimal_comma) {
  const char separator = separator_of(line, decimal_comma);
  std::vector<std::string> fields;
  for (std::string_view rest = trimmed(line, " ");; rest.remove_prefix(1)) {
    if (separator == ' ') rest = trimmed(rest, " ");  // any number of blanks separate
    fields.push_back(take_field(rest, separator));
    if (rest.empty()) return fields;
  }
}

}  // namespace paracal::io
