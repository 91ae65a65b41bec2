#include "printing.hpp"

#include <fmt/format.h>

#include "calibration_page.hpp"
#include "paracal/error.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/klipper.hpp"
#include "paracal/io/machine_codes.hpp"
#include "paracal/printer/printer_calibration.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

constexpr std::string_view kKlipper = "klipper", kMarlin = "marlin";

/// What the controller should be told, as it is told.
std::string parameters_text(const std::string& write, const DeltaGeometry& geometry) {
  if (write == kKlipper) return io::klipper_save_config(geometry);
  return io::machine_codes(geometry, write == kMarlin ? io::CodeDialect::marlin : io::CodeDialect::reprapfirmware);
}

}  // namespace

CLI::Option* add_printer_options(CLI::App& command, PrinterOptions& options) {
  CLI::Option* file = command.add_option(
      "--printer", options.file,
      "instead: a delta's Klipper printer.cfg (linear or rotary), with what DELTA_CALIBRATE left in it");
  command.add_option("--write", options.write, "with --printer: how to write the new values")
      ->check(CLI::IsMember({"klipper", "reprapfirmware", "marlin"}))
      ->needs(file)
      ->capture_default_str();
  return file;
}

void calibrate_printer_file(const PrinterOptions& options, const std::string& page, Session& session) {
  const io::TextFile file = io::read_file(options.file);
  const io::KlipperDelta printer = io::read_klipper(file);
  if (printer.readings.heights.empty()) {
    throw InputFileError(file.name, 0, "expected heights of the bed (height0 ... in [delta_calibrate]), got none");
  }
  if (options.write == kMarlin && printer.geometry.actuator != Actuator::linear) {
    throw WrongUsage("--write marlin: expected a linear delta, since Marlin knows no rotary ones");
  }
  PrinterCalibration found = calibrate_printer(printer.geometry, printer.readings, printer.print_radius);
  const std::string parameters = parameters_text(options.write, found.advised());
  found.calibration.files = {{file.name, io::sha256(file.text)}};
  io::Json json = io::to_json(found.calibration, now());
  json["printer"] = io::to_json(found);
  json["printer"]["lines"] = parameters;
  if (!page.empty()) write_calibration_page(page, session, found.measurements, found.calibration, json);
  if (found.advice != PrinterAdvice::accept_new) session.exit_code = kVerdictIsNo;
  if (session.json() || !session.out().empty()) session.print_json(json);
  if (session.json()) return;
  std::string text;
  for (const std::string& finding : found.findings) text += fmt::format("- {}\n", finding);
  if (found.advice != PrinterAdvice::keep_saved) text.append("\n").append(parameters);
  print_summary(text);
}

}  // namespace paracal::app
