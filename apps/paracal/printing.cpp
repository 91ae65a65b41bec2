#include "printing.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>

#include "inputs.hpp"
#include "paracal/error.hpp"
#include "paracal/io/klipper.hpp"
#include "paracal/io/machine_codes.hpp"
#include "paracal/io/printer_tables.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/printer/printer_calibration.hpp"
#include "reporting.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

constexpr std::string_view kKlipper = "klipper", kReprap = "reprapfirmware", kMarlin = "marlin";

Rule any_firmware() { return one_of({std::string(kKlipper), std::string(kReprap), std::string(kMarlin)}); }

io::CodeDialect dialect_of(std::string_view firmware) {
  return firmware == kMarlin ? io::CodeDialect::marlin : io::CodeDialect::reprapfirmware;
}

/// What the controller should be told, as it is told.
std::string parameters_text(const std::string& firmware, const DeltaGeometry& geometry) {
  if (firmware == kKlipper) return io::klipper_save_config(geometry);
  return io::machine_codes(geometry, dialect_of(firmware));
}

/// Adds what is not there to the last digit: a row that was pasted twice is one reading.
/// @returns how many were there.
template <typename Reading>
std::size_t add_new(const std::vector<Reading>& more, std::vector<Reading>& all) {
  std::size_t known = 0;
  for (const Reading& one : more) {
    if (std::ranges::find(all, one) == all.end()) {
      all.push_back(one);
    } else {
      ++known;
    }
  }
  return known;
}

/// Readings without a height, which show no error of the tower angles and radii by themselves.
std::string what_lacks(const PrinterOptions& options, const DeltaReadings& readings) {
  std::string expected = "expected heights of the bed";
  if (!readings.distances.empty()) expected += " beside the distances";
  expected += ", got none: ";
  if (options.printer.firmware == kKlipper) expected += "run DELTA_CALIBRATE and SAVE_CONFIG, or ";
  const char* how = options.readings.empty() ? "add --readings with" : "add a table with";
  return fmt::format("{}{} the columns x_mm, y_mm, z_mm (where the nozzle touched the bed)", expected, how);
}

/// What distances alone say: the size of prints, with the saved values.
std::string size_alone(const PrinterState& printer) {
  double too_large = 0.0;
  const std::vector<PrintedDistance>& all = printer.readings.distances;
  for (const PrintedDistance& one : all) {
    const auto from = nozzle(printer.geometry, one.from), to = nozzle(printer.geometry, one.to);
    if (from && to) too_large += (one.distance / (*to - *from).norm() - 1.0) / static_cast<double>(all.size());
  }
  if (all.empty()) return {};
  return fmt::format(". By the distances alone, the size of prints is {:+.2f} %; new values also need the bed",
                     1e2 * too_large);
}

/// The printer with what its owner read on it besides.
PrinterState with_readings(const PrinterOptions& options) {
  PrinterState printer = read_printer(options.printer);
  for (const std::string& name : options.readings) {
    const io::TextFile file = input_table(name, options.style);
    InputFile stamp{file.name, io::sha256(file)};
    const auto known = std::ranges::find(printer.files, stamp.sha256, &InputFile::sha256);
    if (known != printer.files.end()) {  // a reading left out would still be there, and tell of itself
      throw InputFileError(
          file.name, 0,
          fmt::format("expected other readings, got those of {} again: name each file once", known->name));
    }
    const DeltaReadings more = io::read_printer_table(file, printer.geometry);
    DeltaReadings& all = printer.readings;
    const std::size_t again = add_new(more.heights, all.heights) + add_new(more.distances, all.distances);
    if (again > 0) {
      printer.notes.push_back(fmt::format("{}: {} rows repeat other rows exactly and count once", file.name, again));
    }
    printer.files.push_back(std::move(stamp));
  }
  if (printer.readings.heights.empty()) {
    throw InputFileError(printer.files.front().name, 0, what_lacks(options, printer.readings) + size_alone(printer));
  }
  return printer;
}

/// Where the calibration says that the nozzle is, against where the firmware believes it with its saved values.
std::vector<report::ErrorArrow> arrows_of(const PrinterCalibration& found, const DeltaReadings& readings) {
  std::vector<JointDrops> drops;
  for (const BedReading& reading : readings.heights) drops.push_back(reading.drops);
  for (const PrintedDistance& reading : readings.distances) drops.insert(drops.end(), {reading.from, reading.to});
  const Calibration& calibration = found.programs.calibration;
  const Machine machine = build(calibration.robot, calibration.errors());
  std::vector<report::ErrorArrow> arrows;
  for (std::size_t k = 0; k < drops.size(); ++k) {
    const Station& station = found.programs.measurements.stations[k];  // in the same order
    const auto believed = nozzle(found.saved.geometry, drops[k]);
    const ForwardResult taken = forward(machine, found.programs.printer.joints_at(drops[k]));
    if (!believed || !taken.ok()) continue;
    arrows.push_back(
        {station.name, station.commanded, taken.plate.position - calibration.robot.controller_origin() - *believed});
  }
  return arrows;
}

/// The firmwares whose M-codes a file holds, as --firmware names them; Marlin's M503 says "echo:" before its lines.
std::vector<std::string_view> firmwares_of(const io::TextFile& file) {
  std::vector<std::string_view> readable;
  for (const std::string_view firmware : {kMarlin, kReprap}) {
    if (firmware == kReprap && file.text.find("echo:") != std::string::npos) continue;
    try {
      (void)io::read_machine_codes(file, dialect_of(firmware));
      readable.push_back(firmware);
    } catch (const InputFileError&) {
      continue;
    }
  }
  return readable;
}

io::KlipperDelta klipper_of(const io::TextFile& file) {
  try {
    return io::read_klipper(file);
  } catch (const InputFileError&) {
    for (const char* section : {"[printer]", "[include "}) {
      if (file.text.find(section) != std::string::npos) throw;
    }
    const std::vector<std::string_view> firmwares = firmwares_of(file);
    if (firmwares.empty()) throw;
    throw InputFileError(file.name, 0,
                         fmt::format("expected Klipper's printer.cfg, got the settings of another firmware; add "
                                     "--firmware {}",
                                     fmt::join(firmwares, " or --firmware ")));
  }
}

}  // namespace

Option* add_printer_option(Command& command, PrinterFile& file) {
  return command.add_option("--printer", file.name, "configuration of a delta printer, instead of --robot")
      ->excludes(command.get_option("--robot"));
}

Option* add_firmware_option(Command& command, PrinterFile& file) {
  return command.add_option("--firmware", file.firmware, "firmware of the printer")->check(any_firmware());
}

PrinterState read_printer(const PrinterFile& file) {
  const io::TextFile text = io::read_file(file.name);
  if (file.firmware != kKlipper) {
    const DeltaGeometry geometry = io::read_machine_codes(text, dialect_of(file.firmware));
    return {.files = {{text.name, io::sha256(text)}},
            .geometry = geometry,
            .print_radius = io::print_radius_of_codes(text, dialect_of(file.firmware)),
            .text = text};
  }
  io::KlipperDelta klipper = klipper_of(text);
  return {.files = std::move(klipper.files),
          .geometry = klipper.geometry,
          .print_radius = klipper.print_radius,
          .readings = std::move(klipper.readings),
          .notes = std::move(klipper.notes),
          .text = text};
}

std::vector<Option*> add_printer_options(Command& command, PrinterOptions& options, Outputs& outputs) {
  Option* const readings = command
                               .add_option("--readings", options.readings,
                                           "further readings (CSV): heights of the bed, distances on printed parts")
                               ->lists("FILE,...");
  Option* const write =
      command
          .add_option("--write", options.write, "firmware that the new values are written for (default: as --firmware)")
          ->check(any_firmware());
  Option* const config = outputs.declare(
      command.add_option("--config", options.config, "write the whole printer.cfg with the new values to this file"));
  Option* const apply = command.add_flag(
      "--apply", options.apply, "change the printer.cfg itself, show the changed lines, and keep a backup beside it");
  Option* const shift =
      command.add_flag("--accept-shift", options.accept_shift,
                       "let the new values follow the common shift of all heights, because the bed has moved; "
                       "otherwise the shift is only reported");
  Option* const details = command.add_flag("--details", options.details, "also state what the advice rests on");
  return {add_firmware_option(command, options.printer), readings, write, config, apply, shift, details};
}

namespace {

/// Complaints of numbers that cannot be meant name the file that they came from.
PrinterCalibration calibrate(const PrinterState& printer, const PrinterOptions& options) {
  const std::string& file = options.printer.name;
  try {
    return calibrate_printer(printer.geometry, printer.readings,
                             {.print_radius = printer.print_radius, .accepts_shift = options.accept_shift});
  } catch (const InvalidArgument& complaint) {
    throw InputFileError(file, 0, complaint.what());
  } catch (const Unreachable& complaint) {
    throw Unreachable(fmt::format("{}: {}", file, complaint.what()));
  }
}

/// What differs, line by line, as patches show it. Lines are changed or added at the end, none taken away.
std::string changed_lines(const std::string& before, const std::string& after) {
  std::istringstream old(before), changed(after);
  std::string text, one, other;
  for (int line = 1; std::getline(changed, other); ++line) {
    const bool is_there = static_cast<bool>(std::getline(old, one));
    if (is_there && one == other) continue;
    text += is_there ? fmt::format("{}: -{}\n", line, one) : std::string();
    text += fmt::format("{}: +{}\n", line, other);
  }
  return text;
}

/// printer-20261122_221500.cfg beside printer.cfg, as the firmware itself names what it keeps.
std::filesystem::path kept_path(const std::filesystem::path& path) {
  const std::time_t seconds = now();
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> stamp{};
  std::strftime(stamp.data(), stamp.size(), "-%Y%m%d_%H%M%S", &utc);
  return path.parent_path() / (path.stem().string() + stamp.data() + path.extension().string());
}

/// Writes the configuration with the advised values, where it is asked for and anything is advised.
/// @returns what to tell of it.
std::string write_configuration(const PrinterOptions& options, const PrinterState& printer,
                                const PrinterCalibration& found, Session& session) {
  if (options.config.empty() && !options.apply) return {};
  if (!found.is_advised()) return "\nNo configuration is written, because no new values are advised.\n";
  const std::string changed = io::klipper_config(printer.text, found.advised());
  const std::string encoded = io::encoded(changed, printer.text.encoding);
  if (!options.config.empty()) session.outputs.store.write(options.config, encoded);
  if (!options.apply) {
    session.say_when_done(fmt::format("written: {}\n", options.config));
    return {};
  }
  std::filesystem::path file = options.printer.name;
  if (is_symlink(file)) file = canonical(file);  // what it was is kept beside it
  const std::filesystem::path kept = kept_path(file);
  session.outputs.store.write(file, encoded, {.sha256 = io::sha256(printer.text), .kept_as = kept.filename()});
  session.say_when_done(
      fmt::format("changed: {}; backup: {}; restart the firmware\n", options.printer.name, kept.string()));
  return "\n" + changed_lines(printer.text.text, changed);
}

/// What to do, the values to paste, the notes.
std::string answer(const PrinterCalibration& found, bool has_details, const std::string& parameters) {
  std::string text = found.findings.front() + "\n";
  if (!parameters.empty()) text += "\n" + parameters + "\n";
  for (const std::string& one : std::span(found.findings).subspan(1)) text += "- " + one + "\n";
  if (has_details) {
    for (const std::string& one : found.details) text += "- " + one + "\n";
  } else if (!found.details.empty()) {
    text += "What this rests on: --details\n";
  }
  return text;
}

void check_configuration_options(const PrinterOptions& options, const Session& session) {
  for (const auto& [is_given, option] :
       {std::pair{options.apply, "--apply"}, {options.accept_shift, "--accept-shift"}}) {
    if (!is_given || session.out().empty()) continue;
    throw WrongUsage(
        fmt::format("{}: expected no --out with it: the calibration would refer to the replaced values; {}, then "
                    "calibrate again with --out",
                    option, options.apply ? "apply the new values" : "put the new values into the firmware"));
  }
  const char* name = options.apply ? "--apply" : "--config";
  if (!options.apply && options.config.empty()) return;
  if (options.printer.firmware != kKlipper) {
    throw WrongUsage(
        fmt::format("{}: expected Klipper's printer.cfg, got --firmware {}: send the printed M-codes and save with "
                    "M500 (in config.g, replace the lines)",
                    name, options.printer.firmware));
  }
}

}  // namespace

void calibrate_printer_file(const PrinterOptions& options, const std::string& page, Session& session) {
  check_configuration_options(options, session);
  const PrinterState printer = with_readings(options);
  const std::string write = options.write.empty() ? options.printer.firmware : options.write;
  if (write == kMarlin && printer.geometry.actuator != Actuator::linear) {
    throw WrongUsage("--write marlin: expected a linear delta, got a rotary one, which Marlin does not support");
  }
  PrinterCalibration found = calibrate(printer, options);
  found.details.insert(found.details.begin(), printer.notes.begin(), printer.notes.end());
  const std::string parameters = parameters_text(write, found.advised());
  found.programs.calibration.files = printer.files;
  std::vector<std::string> read;
  for (const InputFile& file : printer.files) read.push_back(file.name);
  session.outputs.keep_off(read);
  const std::string written = write_configuration(options, printer, found, session);
  io::Json json = io::to_json(found.programs.calibration, now());
  json["printer"] = io::to_json(found);
  json["printer"]["lines"] = parameters;
  if (!page.empty()) {
    write_calibration_page(page, session, found.programs.calibration, json,
                           {.arrows = arrows_of(found, printer.readings), .plan = false});
  }
  const bool is_met = found.is_advised();
  if (!is_met) session.exit_code = kVerdictIsNo;
  if (session.json() || !session.out().empty()) session.print_json(json);
  if (session.json()) return;
  session.print_verdict(answer(found, options.details, is_met ? parameters : std::string()) + written, is_met);
}

}  // namespace paracal::app
