#include "paracal/io/csv.hpp"

#include <csv.h>
#include <fmt/format.h>

#include <algorithm>

#include "columns.hpp"
#include "paracal/error.hpp"
#include "utf8.hpp"

namespace paracal::io {
namespace {

/// Splits one line with libcsv: quotes, doubled quotes, blanks around fields.
std::vector<std::string> split(const std::string& file, int line_number, std::string_view line) {
  csv_parser parser;
  csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI);
  std::vector<std::string> fields;
  const auto add = [](void* text, std::size_t size, void* into) {
    static_cast<std::vector<std::string>*>(into)->emplace_back(static_cast<const char*>(text), size);
  };
  const bool good = csv_parse(&parser, line.data(), line.size(), add, nullptr, &fields) == line.size() &&
                    csv_fini(&parser, add, nullptr, &fields) == 0;
  csv_free(&parser);
  if (!good) throw InputFileError(file, line_number, "expected closed quotation marks around a field, got an open one");
  return fields;
}

std::string joined(const auto& names) {
  std::string text;
  for (const auto& name : names) text.append(text.empty() ? "" : ", ").append(name);
  return text;
}

}  // namespace

CsvTable::CsvTable(const TextFile& file) : name_(file.name) {
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) add(++number, line);
  finish();
}

bool CsvTable::add(int number, std::string_view line) {
  if (line.starts_with('#') || line.find_first_not_of(" \t") == std::string_view::npos) return false;
  std::string escaped;
  if (!is_utf8(line)) line = escaped = escape(number, line);
  if (const auto at = control_character(line)) {
    const auto code = static_cast<unsigned char>(line[*at]);
    throw InputFileError(name_, number, fmt::format("expected text, got the control character {:#04x}", code));
  }
  Row row{number, split(name_, number, line)};
  if (!has_header()) {
    take_header(std::move(row));
    return false;
  }
  if (row.fields.size() != header_.fields.size()) {
    throw InputFileError(
        name_, number,
        fmt::format("expected {} fields as in the header, got {}", header_.fields.size(), row.fields.size()));
  }
  rows_.push_back(std::move(row));
  return true;
}

std::string CsvTable::escape(int number, std::string_view line) {
  if (first_escaped_ == 0) first_escaped_ = number;
  return with_other_bytes_escaped(line);
}

std::vector<std::string> CsvTable::notes() const {
  std::vector<std::string> notes;
  if (first_escaped_ > 0) notes.push_back(note_of_escapes(first_escaped_));
  return notes;
}

void CsvTable::take_header(Row header) {
  for (const std::string& column : header.fields) {
    if (std::ranges::count(header.fields, column) > 1) {
      throw InputFileError(name_, header.line,
                           fmt::format("expected a header line with every column once, got \"{}\" twice", column));
    }
  }
  header_ = std::move(header);
}

void CsvTable::finish() const {
  if (!has_header()) throw InputFileError(name_, 0, "expected a header line, got no line");
  if (dropped_ + rows_.size() == 0) {
    throw InputFileError(name_, 0, "expected at least one row below the header, got none");
  }
}

void CsvTable::drop_rows() {
  dropped_ += rows_.size();
  rows_.clear();
}

void CsvTable::allow_only(const std::vector<std::string_view>& known) const {
  for (const std::string& column : header_.fields) {
    if (std::ranges::find(known, column) != known.end()) continue;
    throw InputFileError(name_, header_.line,
                         fmt::format("expected only the columns {}; got \"{}\"", joined(known), column));
  }
}

std::optional<std::size_t> CsvTable::find(std::string_view column) const {
  const auto found = std::ranges::find(header_.fields, column);
  if (found == header_.fields.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header_.fields.begin());
}

const std::string& CsvTable::text(std::size_t row, std::string_view column) const {
  const std::optional<std::size_t> position = find(column);
  if (!position) {
    throw InputFileError(name_, header_.line,
                         fmt::format("expected a column \"{}\", got {}", column, joined(header_.fields)));
  }
  return rows_[row].fields[*position];
}

double CsvTable::number(std::size_t row, std::string_view column) const {
  const std::string& field = text(row, column);
  const std::optional<double> value = finite_number(field);
  if (!value) {
    fail(row, fmt::format("expected a finite number in column {}, got \"{}\"", column, field));
  }
  return *value;
}

std::optional<double> CsvTable::optional_number(std::size_t row, std::string_view column) const {
  if (!has(column) || text(row, column).empty()) return std::nullopt;
  return number(row, column);
}

void CsvTable::fail(std::size_t row, const std::string& complaint) const {
  throw InputFileError(name_, rows_[row].line, complaint);
}

}  // namespace paracal::io
