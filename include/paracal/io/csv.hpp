#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paracal/io/file.hpp"

namespace paracal::io {

/// A comma-separated table with a header line; lines that begin with # and empty lines are skipped. Bytes that are no
/// UTF-8 stand in fields as \xE9. Every complaint names file and line.
class CsvTable {
 public:
  /// @throws InputFileError for no header, no row, a column twice, or a row with more or fewer fields than the header.
  explicit CsvTable(const TextFile& file);

  /// A table without lines yet, for one that is not held as a whole.
  /// @param name  of its file, for messages.
  explicit CsvTable(std::string name) : name_(std::move(name)) {}

  /// Takes the next line, without its end.
  /// @returns whether it is a row; else it is the header or is skipped.
  /// @throws InputFileError as above for a header or a row.
  bool add(int number, std::string_view line);

  /// Says that this was the last line.
  /// @throws InputFileError for no header, or no row ever.
  void finish() const;

  /// Drops the rows so far, which go on to count.
  void drop_rows();

  /// @throws InputFileError when a column is not one of `known`: a misspelt one would otherwise be ignored in silence.
  void allow_only(const std::vector<std::string_view>& known) const;

  /// What a careful reader should know of how the lines so far were read.
  std::vector<std::string> notes() const;

  std::size_t row_count() const { return rows_.size(); }
  int line(std::size_t row) const { return rows_[row].line; }
  /// From 1, with the rows that were dropped.
  std::size_t number_of(std::size_t row) const { return dropped_ + row + 1; }
  bool has(std::string_view column) const { return find(column).has_value(); }

  /// @throws InputFileError when the column is missing.
  const std::string& text(std::size_t row, std::string_view column) const;

  /// @throws InputFileError when the column is missing or the field is not a finite number.
  double number(std::size_t row, std::string_view column) const;

  /// Empty when the column is absent or the field is blank.
  std::optional<double> optional_number(std::size_t row, std::string_view column) const;

  [[noreturn]] void fail(std::size_t row, const std::string& complaint) const;

 private:
  struct Row {
    int line;
    std::vector<std::string> fields;
  };

  std::string escape(int number, std::string_view line);
  bool has_header() const { return header_.line > 0; }
  void take_header(Row header);
  std::optional<std::size_t> find(std::string_view column) const;

  std::string name_;
  Row header_{};
  int first_escaped_ = 0;  ///< line; 0: none
  std::size_t dropped_ = 0;
  std::vector<Row> rows_;
};

}  // namespace paracal::io
