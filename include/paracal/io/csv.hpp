#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/io/decimal_sign.hpp"
#include "paracal/io/file.hpp"
#include "paracal/mechanism/plausible.hpp"

namespace paracal::io {

/// A table with a header line. All lines use the separator of the header (comma, semicolon or tab). Lines that begin
/// with # and lines that contain only separators are skipped, and so are empty fields after the last column. Decimals
/// may have a comma (DecimalSign). Bytes that are not UTF-8 become \xE9 in fields. Every message names file and
/// line.
class CsvTable {
 public:
  /// @throws InputFileError for no header, a header with two kinds of separators or a column twice; for no row, or a
  /// row with more or fewer fields than the header.
  explicit CsvTable(const TextFile& file);

  /// A table without lines yet, for a table that is not in memory as a whole.
  /// @param name  of its file, for messages.
  explicit CsvTable(std::string name, TableStyle style = {})
      : name_(std::move(name)), style_(std::move(style)), decimals_(style_.decimal_comma) {}

  /// Takes the next line, without its end.
  /// @returns whether it is a row; else it is the header or is skipped.
  /// @throws InputFileError as above for a header or a row.
  bool add(int number, std::string_view line);

  bool has_header() const { return header_.line > 0; }

  /// Finds the decimal sign from a later line: after the header, before a number is read.
  void look_ahead(int number, std::string_view line);

  /// To be called after the last line.
  /// @throws InputFileError for no header, or no row.
  void finish() const;

  /// Drops the rows so far, which still count.
  void drop_rows();

  /// @throws InputFileError for a column that is not in `known` and not to be ignored: a misspelt one would otherwise
  /// be ignored silently.
  void allow_only(const std::vector<std::string_view>& known) const;

  /// Notes about how the lines so far were read.
  std::vector<std::string> notes() const;

  std::size_t row_count() const { return rows_.size(); }
  int line(std::size_t row) const { return rows_[row].line; }
  /// "plan.csv:3": file and line, for messages.
  std::string place(std::size_t row) const { return name_ + ":" + std::to_string(line(row)); }
  /// From 1, with the rows that were dropped.
  std::size_t number_of(std::size_t row) const { return dropped_ + row + 1; }
  bool has(std::string_view column) const { return find(column).has_value(); }

  /// @throws InputFileError when the column is missing.
  const std::string& text(std::size_t row, std::string_view column) const;

  /// @throws InputFileError when the column is missing or the field is not a number in the range.
  double number(std::size_t row, std::string_view column, const plausible::Range& range) const;

  /// Empty when the column is absent or the field is blank.
  std::optional<double> optional_number(std::size_t row, std::string_view column, const plausible::Range& range) const;

  [[noreturn]] void fail(std::size_t row, const std::string& complaint) const;

 private:
  struct Row {
    int line;
    std::vector<std::string> fields;
  };

  /// What a column is for.
  enum class Role : std::uint8_t { number, text, ignored };

  std::string decode(int number, std::string_view line);
  Row row_of(int number, std::string_view line) const;
  std::vector<std::string> columns(bool ignored) const;
  Role role_of(const std::string& column) const;
  void take_header(Row header);
  [[noreturn]] void refuse_count(const Row& row) const;
  void look_at(const Row& row);
  std::optional<std::size_t> find(std::string_view column) const;

  std::string name_;
  TableStyle style_;
  DecimalSign decimals_;
  char separator_ = ',';
  Row header_{};
  std::vector<Role> roles_ = {};
  int first_decoded_ = 0;  ///< line; 0: none
  std::size_t dropped_ = 0;
  std::vector<Row> rows_;
};

}  // namespace paracal::io
