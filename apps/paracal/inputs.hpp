#pragma once

#include <memory>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "paracal/io/csv_stream.hpp"
#include "paracal/io/file.hpp"

namespace paracal::app {

/// A table that is read row by row, and so from a pipe, too.
struct RowInput {
  /// @throws InputFileError when the file cannot be opened.
  RowInput(const std::string& name, const io::TableStyle& style)
      : file(io::open_file(name)), rows({name, *file, style}) {}

  std::unique_ptr<std::istream> file;
  io::CsvStream rows;
};

/// A table's text, which input_table() will take: what comes through a pipe cannot be read twice.
const io::TextFile& look_into(const std::string& name);

/// A table's text, read now unless somebody has looked into it.
io::TextFile input_table(const std::string& name, const io::TableStyle& style);

/// --decimal-comma and --ignore-columns: for commands that read tables.
void add_table_options(Command& command, io::TableStyle& style);

/// Input files that may say which robot they are of; empty names are passed over.
struct RobotSources {
  std::vector<std::string> calibrations = {};  ///< JSON, which carries its robot
  std::vector<std::string> tables = {};        ///< with a line "# robot: NAME", or without
  io::CsvStream* rows = nullptr;               ///< such a table that is read row by row
};

/// Whether --errors names a calibration (.json) rather than source errors (TOML), which do not say of which robot.
bool is_calibration(const std::string& errors_file);

/// What --errors names, if it is a calibration, and a table.
RobotSources sources_of(const std::string& errors_file, std::string table);
RobotSources sources_of(const std::string& errors_file, io::CsvStream& rows);

}  // namespace paracal::app
