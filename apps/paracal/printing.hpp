#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace paracal::app {

class Session;

/// A printer's own configuration and how its owner wants to be answered.
struct PrinterOptions {
  std::string file, write = "klipper";
};

/// --printer and --write.
/// @returns --printer.
CLI::Option* add_printer_options(CLI::App& command, PrinterOptions& options);

/// Calibrates a printer from its own file, which has all that is needed: geometry, readings, and what was read at.
/// @param page  report to write; empty: none.
void calibrate_printer_file(const PrinterOptions& options, const std::string& page, Session& session);

}  // namespace paracal::app
