#pragma once

#include <memory>
#include <optional>

#include "paracal/io/csv.hpp"
#include "paracal/io/robot_statement.hpp"

namespace paracal::io {

/// A table like CsvTable, but row by row: memory does not grow with the table. Its lines, comments included, are at
/// most 64 KiB long. The decimal sign is found from the first 256 KiB, which are read together with the header, and
/// from the lines above a number.
class CsvStream {
 public:
  /// @param in  nothing is read from it before the first call.
  explicit CsvStream(const TextStream& in);
  CsvStream(const CsvStream&) = delete;
  CsvStream& operator=(const CsvStream&) = delete;
  ~CsvStream();

  /// The robot stated at the beginning, as robot_of_table: in the first 1 MiB. To be called before the first row is
  /// taken.
  std::optional<RobotStatement> robot();
  /// From now on every line that states a robot must state this one.
  void expect(RobotStatement robot);

  /// The table with its next row and no other, until the next call; null after the last row.
  /// @throws InputFileError as CsvTable, for a line that is too long, for another robot than expected, or for a stream
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
