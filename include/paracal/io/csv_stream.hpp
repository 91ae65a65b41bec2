#pragma once

#include <memory>
#include <optional>

#include "paracal/io/csv.hpp"
#include "paracal/io/robot_statement.hpp"

namespace paracal::io {

/// A table as CsvTable has it, but row by row: memory does not grow with the table. Its lines, comments too, are at
/// most 64 KiB long. Whether decimals have a comma is told from the lines that are read at once with the header, which
/// is 256 KiB of them, and from those above the number that is read.
class CsvStream {
 public:
  /// @param in  where nothing is read before the first call.
  explicit CsvStream(const TextStream& in);
  CsvStream(const CsvStream&) = delete;
  CsvStream& operator=(const CsvStream&) = delete;
  ~CsvStream();

  /// What its beginning says, as robot_of_table: of the lines that are read at once, which is 1 MiB of them. Before the
  /// first row is taken.
  std::optional<RobotStatement> robot();
  /// What any line says must be this, from now on.
  void expect(RobotStatement robot);

  /// The table with its next row and no other, until the next call; null behind the last row.
  /// @throws InputFileError as CsvTable, for a line that is too long, a robot that is not the one expected, or a stream
  ///         that cannot be read.
  const CsvTable* next();

 private:
  class Lines;

  std::string name_;
  std::unique_ptr<Lines> lines_;
  std::optional<RobotStatement> expected_;
  CsvTable table_;
};

}  // namespace paracal::io
