#pragma once

#include <string>
#include <vector>

#include "arguments.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/io/file.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal::app {

class Outputs;
class Session;

/// A printer's own configuration: a file and whose it is.
struct PrinterFile {
  std::string name, firmware = "klipper";
};

Option* add_printer_option(Command& command, PrinterFile& file);
Option* add_firmware_option(Command& command, PrinterFile& file);

/// What it says.
struct PrinterState {
  std::vector<InputFile> files;  ///< the configuration, then what it includes
  DeltaGeometry geometry;
  double print_radius = 0.0;  ///< mm; 0: not stated
  DeltaReadings readings = {};
  std::vector<std::string> notes = {};  ///< on how the file is to be read
  io::TextFile text = {};               ///< the configuration itself
};

/// @throws InputFileError for a file that is none of this firmware.
PrinterState read_printer(const PrinterFile& file);

/// What the owner of a printer asks of a calibration.
struct PrinterOptions {
  PrinterFile printer;
  std::vector<std::string> readings;
  io::TableStyle style = {};  ///< of the readings
  std::string write;          ///< empty: as the printer's firmware
  std::string config;         ///< file for the whole changed configuration; empty: none
  bool apply = false;         ///< change the configuration itself, and keep what it was beside it
  bool accept_shift = false;  ///< a common shift of all heights is the bed's
  bool details = false;       ///< also what the advice rests on
};

/// --firmware, --readings, --write, --config, --apply, --accept-shift and --details.
std::vector<Option*> add_printer_options(Command& command, PrinterOptions& options, Outputs& outputs);

/// Calibrates a printer from its own file, and from what else was read on it.
/// @param page  report to write; empty: none.
void calibrate_printer_file(const PrinterOptions& options, const std::string& page, Session& session);

}  // namespace paracal::app
