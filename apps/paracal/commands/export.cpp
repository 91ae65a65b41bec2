#include "paracal/compensation/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "controller.hpp"
#include "export_filter.hpp"
#include "output_folder.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/compensation/pose_correction.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

struct ExportArguments {
  std::string calibration;
  std::string target;
  ControllerOptions controller = {};
  std::string variant = "exact";
  bool rigid = false;
  std::optional<std::string> folder = {};  ///< of a whole configuration; without it the exported text alone
  FilterOptions filter;
};

/// Targets that are texts made of the calibration alone.
using WriteText = std::string(const Robot&, const SourceErrors&, const ExportOrigin&, const DriveCurves&);

/// LinuxCNC's own kinematics have no place for uneven drives.
std::string even_genhexkins(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin,
                            const DriveCurves& /*even*/) {
  return genhexkins(robot, errors, origin);
}

const std::map<std::string, WriteText*> kTexts{
    {"c99", c99_header}, {"linuxcnc", linuxcnc_component}, {"st", structured_text}, {"genhexkins", even_genhexkins}};

/// A machine as a target holds it.
struct HeldMachine {
  const Robot& robot;
  SourceErrors errors;
  DriveCurves drives;
};

const std::map<std::string, ExportVariant> kVariants{
    {"exact", ExportVariant::exact}, {"one-step", ExportVariant::one_step}, {"float", ExportVariant::single}};

/// What joints depend on: who computed those of the calibration, and joints to compare.
struct JointTruth {
  const Robot& robot;
  const ControllerModel& controller;
  double loss = 0.0;  ///< mm, by omitting the drives

  std::vector<std::string> assumed() const {
    std::vector<std::string> lines = controller_assumptions(controller, robot);
    if (loss > 0.0) {
      lines.push_back(
          fmt::format("even drives: the smooth errors of the drives are omitted, which costs up to {:.2g} mm in "
                      "distances to home",
                      loss));
    }
    return lines;
  }

  /// Lines for the head of an exported text.
  std::vector<std::string> remarks() const {
    std::vector<std::string> lines;
    const auto add = [&](std::string_view label, const std::string& text) {
      lines.push_back(fmt::format("{:<13}{}", label, text));
    };
    for (const std::string& one : assumed()) add("assumed", one);
    for (const std::string& one : comparison_lines(robot, controller)) add("compare", one);
    return lines;
  }

  void add_to(io::Json& json) const {
    json["assumed"] = assumed();
    json["nominal_joints"] = comparison_json(robot, controller);
  }
};

void export_text(const std::string& target, const HeldMachine& held, const ExportOrigin& origin,
                 const JointTruth& truth, Session& session) {
  const std::string text = kTexts.at(target)(held.robot, held.errors, origin, held.drives);
  if (!session.json()) return session.print(text);
  io::Json json{{"target", target}};
  json.update(io::to_json(held.robot, origin));
  truth.add_to(json);
  json["text"] = text;
  session.print_json(json);
}

std::string listed(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "  " + line + "\n";
  return text;
}

/// The folder of a controller's whole configuration, and what is to be done in it.
void export_configuration(const OutputFolder& folder, const HeldMachine& held, const ExportOrigin& origin,
                          const JointTruth& truth, Session& session) {
  const std::map<std::string, std::string> files = linuxcnc_configuration(held.robot, held.errors, origin, held.drives);
  const std::string name = folder.path().string();
  if (session.json()) {
    io::Json json{{"target", "linuxcnc"}};
    json.update(io::to_json(held.robot, origin));
    truth.add_to(json);
    json["folder"] = name;
    for (const auto& [file, text] : files) json["files"].push_back(file);
    session.print_json(json);
  } else {
    session.print(fmt::format("{} files are in {}; README.md there states what to change.\nTo start: cd {} && sudo "
                              "halcompile --install paracal_kins.comp && linuxcnc paracal.ini\n",
                              files.size(), name, shell_word(name)) +
                  assumed_lines(truth.assumed()) + listed(comparison_lines(truth.robot, truth.controller)));
  }
  folder.write(files);
}

void export_json(const HeldMachine& held, const ExportOrigin& origin, const JointTruth& truth, Session& session) {
  const auto& [robot, errors, drives] = held;
  const CompensatorParameters<double> parameters = compensator_parameters(robot, errors, drives);
  const ExportedSet set = exported_set(robot, errors, drives);
  io::Json json{{"format", "paracal compensator 1"}, {"target", "json"}};
  json.update(io::to_json(robot, origin));
  truth.add_to(json);
  json.update(io::to_json(parameters));
  json["set"] = {{"names", set.names}, {"numbers", set.set}};
  for (const SelfTestCase& wanted : self_test(robot, build(robot, errors), drives)) {
    json["self_test"].push_back(io::to_json(wanted, robot.actuator(), robot.commands_tilt()));
  }
  session.print_json(json);
}

/// What --config asks for.
/// @throws WrongUsage where another target was, or a file for it, too.
std::optional<OutputFolder> configuration_folder(const ExportArguments& options, const Session& session) {
  if (!options.folder) return std::nullopt;
  if (options.target != "linuxcnc") {
    throw WrongUsage(fmt::format("--config: expected with --target linuxcnc, got --target {}", options.target));
  }
  if (!session.out().empty()) {
    throw WrongUsage("--config: expected no --out, because the folder also contains the component, got " +
                     session.out());
  }
  return OutputFolder("--config", *options.folder);
}

void run(const ExportArguments& options, Session& session) {
  const std::optional<OutputFolder> folder = configuration_folder(options, session);
  const Robot robot = session.robot({.calibrations = {options.calibration}});
  const io::JsonFile& file = session.calibration_file(options.calibration);
  const io::CalibratedMachine machine = checked_calibration(file, options.controller, robot);
  if (options.variant != "exact" && (options.target == "genhexkins" || !kTexts.contains(options.target))) {
    throw WrongUsage(fmt::format("--variant: expected with --target c99, linuxcnc or st, got {}", options.target));
  }
  if (options.variant == "float" && options.target == "st") {
    throw WrongUsage("--variant float: expected with --target c99 or linuxcnc, got st: use one-step");
  }
  ExportOrigin origin{.calibration = std::filesystem::path(options.calibration).filename().string(),
                      .sha256 = io::sha256(file.text),
                      .date = io::utc(now())};
  const ControllerModel controller = checked_controller(options.controller, machine.controller, robot, {});
  if (options.target == "gcode" || options.target == "csv") {
    const KnownErrors known = options.rigid ? machine.rigid() : machine.known();
    return filter_file(options.target, options.filter,
                       {robot, known.errors, controller.computes_with(robot), known.drives()}, origin, session);
  }
  if (!options.filter.is_empty()) {
    throw WrongUsage(
        "--input, --origin, --start, --chord-mm, --dialect, --work-offsets, --tools, --harmless, --harmless-words, "
        "--in-place, --partial, --check and --header: expected only with --target gcode or csv");
  }
  origin.variant = kVariants.at(options.variant);
  const bool is_rigid = options.rigid || options.target == "genhexkins";
  const KnownErrors known = is_rigid ? machine.rigid() : machine.known();
  const JointTruth truth{robot, controller,
                         is_rigid ? loss_without_drives(robot, machine.known(), machine.errors) : 0.0};
  origin.remarks = truth.remarks();
  const HeldMachine held{robot, known.errors, known.drives()};
  if (folder) return export_configuration(*folder, held, origin, truth, session);
  options.target == "json" ? export_json(held, origin, truth, session)
                           : export_text(options.target, held, origin, truth, session);
}

void add_dialect_option(Command& command, std::optional<io::GcodeDialect>& dialect) {
  std::vector<std::string> names;
  names.reserve(kDialects.size());
  for (const auto& [name, one] : kDialects) names.emplace_back(name);
  const auto choose = [&dialect](const std::string& wanted) {
    dialect = std::ranges::find(kDialects, wanted, [](const auto& one) { return one.first; })->second;
  };
  command
      .add_choice(
          "--dialect", choose,
          "controller that reads the program (rrf: RepRapFirmware); without it, codes that differ between controllers "
          "stay unchanged")
      ->check(one_of(names));
}

}  // namespace

void add_export(Command& program, Session& session) {
  Command* command = session.add_command(program, "export", "Compensate a machine",
                                         "write the compensation for a controller, or a file with corrected targets");
  const auto options = std::make_shared<ExportArguments>();
  command->add_option("--calibration", options->calibration, "calibration of the machine (JSON)")->required();
  command
      ->add_option(
          "--target", options->target,
          "c99: C and C++ header; linuxcnc: kinematics component (paracal_kins.comp); st: IEC 61131-3 Structured Text; "
          "genhexkins: HAL lines for LinuxCNC's hexapod kinematics; json: parameters; gcode, csv: part program or pose "
          "table with corrected targets")
      ->required()
      ->check(one_of({"c99", "linuxcnc", "st", "genhexkins", "json", "gcode", "csv"}));
  command
      ->add_option("--variant", options->variant,
                   "c99, linuxcnc, st: how the tilt of a plate on parallelograms is found: exact; one-step, in bounded "
                   "time; float, for controllers that compute with float; each states its largest error")
      ->check(one_of({"exact", "one-step", "float"}));
  command
      ->add_choice(
          "--config", [options](const std::string& folder) { options->folder = folder; },
          "linuxcnc: write a complete configuration with simulated motors into this new or empty folder")
      ->takes("FOLDER");
  add_controller_options(*command, options->controller);
  command->add_flag("--rigid", options->rigid, "omit the smooth errors of the drives, as genhexkins always does");
  command->heading("Part programs and tables (--target gcode, csv)");
  command->add_option("--input", options->filter.input, "file to correct (default: standard input)");
  command->heading("Part programs (--target gcode)");
  command
      ->add_option(
          "--origin", options->filter.origin,
          "the program's origin in the robot's frame, mm (default: controller.origin_mm of the robot file, or 0)")
      ->lists("X,Y,Z", 3)
      ->check(within(plausible::length(kLargestReach)));
  command
      ->add_option("--start", options->filter.start,
                   "position before the first line of the program, mm and deg; for plates that tilt also X,Y,Z,A,B,C")
      ->lists("X,Y,Z[,PHI]", 3, 6)
      ->check(within(plausible::length(kLargestReach)));
  command->heading("Part programs and tables (--target gcode, csv)");
  command->add_flag(
      "--partial", options->filter.partial,
      "correct the lines that can be corrected and list the others (exit code 1); otherwise such a file is "
      "refused");
  command->heading("Part programs (--target gcode)");
  command->add_option("--chord-mm", options->filter.chord_mm,
                      "largest deviation of the pieces that replace an arc or a bent line (default: 0.01)");
  add_dialect_option(*command, options->filter.dialect);
  command->add_option("--work-offsets", options->filter.work_offsets,
                      "LinuxCNC parameter file (linuxcnc.var, in mm) with the offsets G54 to G59.3");
  command->add_option(
      "--tools", options->filter.tools,
      "LinuxCNC tool table (tool.tbl, in mm) with the lengths for G43; --origin then refers to a tool of length "
      "0");
  command
      ->add_option(
          "--harmless", options->filter.harmless,
          "a macro or code that moves nothing and changes no mode, such as TIMELAPSE_TAKE_FRAME or G187; may be "
          "given several times")
      ->takes("NAME");
  command->add_option("--harmless-words", options->filter.harmless_words,
                      "file with such names, one per line; # starts a comment");
  command->heading("Part programs and tables (--target gcode, csv)");
  command->add_flag(
      "--in-place", options->filter.in_place,
      "replace the input file, as a slicer's post-processing script does; exit code 0 if only approach and "
      "retreat stay uncorrected");
  command->add_flag(
      "--check", options->filter.check,
      "write nothing; report what would happen and the largest corrections; exit code 1 if the file would be "
      "refused or corrected only in part");
  command->add_flag("--header", options->filter.header, "start the output with comments on its origin");
  command->example("A C header", "paracal export --calibration calibration.json --target c99 --out compensator.h");
  command->example("Correct a part program",
                   "paracal export --calibration calibration.json --target gcode --input part.ngc --out corrected.ngc");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
