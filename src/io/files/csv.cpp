#include "paracal/io/csv.hpp"

#include <csv.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "io/tables/columns.hpp"
#include "letters.hpp"
#include "paracal/error.hpp"
#include "paracal/spelling.hpp"
#include "utf8.hpp"

namespace paracal::io {
namespace {

/// Splits one line with libcsv: quotes, doubled quotes, blanks around fields, apostrophes before formulas.
std::vector<std::string> split(const std::string& file, int line_number, std::string_view line, char separator) {
  csv_parser parser;
  csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI);
  csv_set_delim(&parser, static_cast<unsigned char>(separator));
  std::vector<std::string> fields;
  const auto add = [](void* text, std::size_t size, void* into) {
    std::string_view field(static_cast<const char*>(text), size);
    if (field.starts_with(kNoFormula) && begins_as_formula(field)) field.remove_prefix(1);
    static_cast<std::vector<std::string>*>(into)->emplace_back(field);
  };
  const bool good = csv_parse(&parser, line.data(), line.size(), add, nullptr, &fields) == line.size() &&
                    csv_fini(&parser, add, nullptr, &fields) == 0;
  csv_free(&parser);
  if (!good) throw InputFileError(file, line_number, "expected closed quotation marks around a field, got an open one");
  return fields;
}

/// Those of comma, semicolon and tab that stand outside quotation marks, each once.
std::string separators_in(std::string_view line) {
  constexpr std::string_view kSeparators = ",;\t";
  std::string found;
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    const bool separates = !is_quoted && kSeparators.find(c) != std::string_view::npos;
    if (separates && found.find(c) == std::string::npos) found += c;
  }
  return found;
}

std::string_view name_of(char separator) {
  return separator == ',' ? "commas" : separator == ';' ? "semicolons" : "tabs";
}

/// That of a header line; a comma where there is none.
char separator_of(const std::string& file, int line_number, std::string_view header) {
  const std::string found = separators_in(header);
  if (found.size() < 2) return found.empty() ? ',' : found.front();
  throw InputFileError(file, line_number,
                       fmt::format("expected one kind of separator in the header line, got {} and {}",
                                   name_of(found[0]), name_of(found[1])));
}

bool is_skipped(std::string_view line) {
  return line.starts_with('#') || line.find_first_not_of(" \t") == std::string_view::npos;
}

void refuse_control_characters(const std::string& file, int line_number, std::string_view line) {
  const std::string_view control = control_character(line);
  if (control.empty()) return;
  throw InputFileError(file, line_number, fmt::format("expected text, got the control character {}", escaped(control)));
}

}  // namespace

CsvTable::CsvTable(const TextFile& file) : CsvTable(file.name, file.style) {
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) add(++number, line);
  finish();
}

bool CsvTable::add(int number, std::string_view line) {
  if (is_skipped(line)) return false;
  std::string decoded;
  if (!is_utf8(line)) line = decoded = decode(number, line);
  refuse_control_characters(name_, number, line);
  if (!has_header()) separator_ = separator_of(name_, number, line);
  Row row = row_of(number, line);
  if (row.fields.empty()) return false;
  if (!has_header()) {
    take_header(std::move(row));
    return false;
  }
  if (row.fields.size() != header_.fields.size()) refuse_count(row);
  look_at(row);
  rows_.push_back(std::move(row));
  return true;
}

/// Its fields, but for empty ones behind those of the header; none where all are empty.
CsvTable::Row CsvTable::row_of(int number, std::string_view line) const {
  Row row{number, split(name_, number, line, separator_)};
  const auto is_empty = [](const std::string& field) { return field.empty(); };
  if (std::ranges::all_of(row.fields, is_empty)) row.fields.clear();
  while (row.fields.size() > header_.fields.size() && row.fields.back().empty()) row.fields.pop_back();
  return row;
}

void CsvTable::refuse_count(const Row& row) const {
  const bool may_be_decimals = separator_ == ',' && row.fields.size() > header_.fields.size();
  throw InputFileError(
      name_, row.line,
      fmt::format("expected {} fields as in the header, got {}{}", header_.fields.size(), row.fields.size(),
                  may_be_decimals ? " (with decimal commas, separate fields by semicolons or tabs)" : ""));
}

void CsvTable::look_at(const Row& row) {
  if (decimals_.is_known()) return;
  for (std::size_t k = 0; k < std::min(row.fields.size(), roles_.size()); ++k) {
    if (roles_[k] == Role::number) decimals_.look(row.fields[k], row.line);
  }
}

void CsvTable::look_ahead(int number, std::string_view line) {
  if (!decimals_.is_known() && !is_skipped(line)) look_at(row_of(number, line));
}

std::string CsvTable::decode(int number, std::string_view line) {
  if (first_decoded_ == 0) first_decoded_ = number;
  return with_other_bytes_decoded(line);
}

std::vector<std::string> CsvTable::notes() const {
  std::vector<std::string> notes;
  if (first_decoded_ > 0) notes.push_back(note_of_decoding(first_decoded_));
  const std::vector<std::string> ignored = columns(true);
  if (!ignored.empty()) notes.push_back(fmt::format("columns ignored, as requested: {}", fmt::join(ignored, ", ")));
  return notes;
}

std::vector<std::string> CsvTable::columns(bool ignored) const {
  std::vector<std::string> columns;
  for (std::size_t k = 0; k < roles_.size(); ++k) {
    if ((roles_[k] == Role::ignored) == ignored) columns.push_back(header_.fields[k]);
  }
  return columns;
}

CsvTable::Role CsvTable::role_of(const std::string& column) const {
  constexpr std::array<std::string_view, 3> kNames{"pose", "from", "to"};
  if (std::ranges::find(style_.ignored_columns, column) != style_.ignored_columns.end()) return Role::ignored;
  return std::ranges::find(kNames, column) != kNames.end() ? Role::text : Role::number;
}

void CsvTable::take_header(Row header) {
  for (const std::string& column : header.fields) {
    roles_.push_back(role_of(column));
    if (roles_.back() == Role::ignored || std::ranges::count(header.fields, column) == 1) continue;
    throw InputFileError(name_, header.line,
                         fmt::format("expected a header line with every column once, got \"{}\" twice", column));
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
  std::vector<std::string> missing;
  for (const std::string_view column : known) {
    if (!has(column)) missing.emplace_back(column);
  }
  std::vector<std::string> others, shown;
  for (const std::string& column : columns(false)) {
    if (std::ranges::find(known, column) != known.end()) continue;
    others.push_back(column);
    shown.push_back(fmt::format("\"{}\"{}", column, did_you_mean(column, missing)));
  }
  if (others.empty()) return;
  throw InputFileError(name_, header_.line,
                       fmt::format("expected only the columns {}; got {} (to ignore these: --ignore-columns \"{}\")",
                                   fmt::join(known, ", "), fmt::join(shown, ", "), fmt::join(others, ",")));
}

std::optional<std::size_t> CsvTable::find(std::string_view column) const {
  for (std::size_t k = 0; k < header_.fields.size(); ++k) {
    if (header_.fields[k] == column && roles_[k] != Role::ignored) return k;
  }
  return std::nullopt;
}

const std::string& CsvTable::text(std::size_t row, std::string_view column) const {
  const std::optional<std::size_t> position = find(column);
  if (!position) {
    throw InputFileError(name_, header_.line,
                         fmt::format("expected a column \"{}\", got {}", column, fmt::join(columns(false), ", ")));
  }
  return rows_[row].fields[*position];
}

double CsvTable::number(std::size_t row, std::string_view column, const plausible::Range& range) const {
  const std::string& field = text(row, column);
  const std::optional<double> value = decimals_.number(field);
  if (!value) {
    fail(row,
         fmt::format("expected a finite number in column {}, got \"{}\"{}", column, field, decimals_.why_not(field)));
  }
  if (const auto complaint = plausible::complaint(column, *value, range)) fail(row, *complaint);
  return *value;
}

std::optional<double> CsvTable::optional_number(std::size_t row, std::string_view column,
                                                const plausible::Range& range) const {
  if (!has(column) || text(row, column).empty()) return std::nullopt;
  return number(row, column, range);
}

void CsvTable::fail(std::size_t row, const std::string& complaint) const {
  throw InputFileError(name_, rows_[row].line, complaint);
}

}  // namespace paracal::io
