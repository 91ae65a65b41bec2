#include <fmt/format.h>

#include <iterator>
#include <memory>

#include "paracal/io/measurement_files.hpp"
#include "paracal/report/scene.hpp"
#include "paracal/units.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "validating.hpp"

namespace paracal::app {
namespace {

std::string text_of(const Validation& validation) {
  const bool has_verdict = validation.accepted.has_value();
  std::string text = !has_verdict ? "validation: no verdict, because no limit is set (--limit-mm)\n"
                                  : fmt::format("validation: {}\n", *validation.accepted ? "accepted" : "not accepted");
  const auto out = std::back_inserter(text);
  for (const std::string& reason : validation.reasons) {
    fmt::format_to(out, "  {} {}\n", has_verdict ? "because" : "against the calibration:", reason);
  }
  for (const std::string& note : validation.notes) fmt::format_to(out, "  note: {}\n", note);
  text += assumed_lines(validation.assumed);
  if (validation.agreement) {
    const Agreement& one = *validation.agreement;
    const std::string verdict =
        one.contradicts() ? "not consistent" : fmt::format("consistent (p-value {:.2g})", one.chance);
    fmt::format_to(out, "  uncertainty of the calibration: chi-square {:.1f} for {:.0f} degrees of freedom, {}\n",
                   one.chi_square, one.freedom, verdict);
  }
  const bool points = !validation.poses.empty();
  const std::string heading = points ? fmt::format("largest errors over {} poses", validation.poses.size())
                                     : fmt::format("largest errors over {} readings", validation.readings.size());
  fmt::format_to(out, "  {:<38}{:>8}{:>11}\n", heading, "before", "after");
  const auto line = [&](std::string_view what, double before, double after) {
    fmt::format_to(out, "  {:<38}{:>8.3f}{:>11.3f}\n", what, before, after);
  };
  const PoseErrorSummary &before = validation.before, &after = validation.after;
  if (points) {
    line("distance to home, mm", before.max_abs_distance, after.max_abs_distance);
    line("position relative to home, mm", before.max_volumetric, after.max_volumetric);
    line("aligned position, mm", before.max_volumetric_aligned, after.max_volumetric_aligned);
  } else if (after.reads_distances) {
    line("distance, mm", before.max_abs_distance, after.max_abs_distance);
  }
  for (const auto& [kind, rms] : before.rms_lengths) {
    line(fmt::format("{}, root mean square, mm", words(kind).noun), rms, after.rms_lengths.at(kind));
  }
  if (before.max_abs_rotation) {
    line("rotation relative to home, deg", to_degrees(*before.max_abs_rotation), to_degrees(*after.max_abs_rotation));
  }
  if (before.max_orientation && after.max_orientation) {
    line("orientation of the body, deg", to_degrees(*before.max_orientation), to_degrees(*after.max_orientation));
  }
  for (const CheckedReading& one : validation.readings) {
    fmt::format_to(out, "  {:<38}{:>8.3f}{:>11.3f}  U {:.3f} (k = 2)\n", one.text + ", mm", one.before, one.after,
                   one.U);
  }
  if (!validation.iso9283.poses.empty()) {
    const Iso9283& iso = validation.iso9283;
    fmt::format_to(out, "  ISO 9283, uncompensated, worst pose: AP {:.3f}, RP {:.3f}, AD {:.3f}, RD {:.3f} mm\n",
                   iso.max_AP, iso.max_RP, iso.max_AD, iso.max_RD);
  }
  for (const LimitCheck& check : validation.checks) {
    fmt::format_to(out, "  {}: {:.4g}, U {:.2g} (k = {:.3g}), at least {:.2g}, limit {:.4g}: {}\n", check.quantity,
                   check.error, check.uncertainty, check.coverage, check.at_least, check.limit, name(check.conformity));
  }
  return text;
}

void run(const ValidatingOptions& options, const std::string& report, Session& session) {
  const Robot robot = session.robot(options.robot_sources());
  const io::JsonFile& file = session.calibration_file(options.calibration);
  const io::CalibratedMachine machine = checked_calibration(file, options.controller, robot, options.measuring.style);
  io::require_inputs(file);
  const KnownErrors known = machine.known();
  const CommandedReadings read = options.read(machine, robot);
  const Measurements& measurements = read.measurements;
  Validation validation = validate(robot, known, measurements, options.options(read, robot));
  for (const std::string& own : options.own(machine, measurements)) {
    validation.refuse(io::confirms_nothing(own));
  }
  const io::Json json = io::to_json(validation);
  if (!report.empty()) {
    ReportContent content{
        .kind = "validation",
        .results = {{"validation", json}},
        .figures = {{"scene", report::scene(robot, report::measured_arrows(validation), known.errors)}},
        .inputs = with_files(measurements.files, session, {options.calibration})};
    add_error_map(robot, known, content);
    write_report(report, session, robot, content);
  }
  if (session.json()) {
    session.print_json(json);
  } else if (validation.accepted && session.out().empty()) {
    session.print_verdict(text_of(validation), *validation.accepted);
  } else {
    session.print(text_of(validation));
  }
  if (validation.accepted == false) session.exit_code = kVerdictIsNo;
}

}  // namespace

void add_validate(Command& program, Session& session) {
  Command* command =
      session.add_command(program, "validate", "Calibrate a machine",
                          "check a calibration against measurements it has not used; ISO 9283 from repeats");
  const auto options = std::make_shared<ValidatingOptions>();
  add_validating_options(*command, *options);
  command->heading("Results");
  command->example("Check against a limit of 0.15 mm",
                   "paracal validate --calibration calibration.json --measurements check.csv --limit-mm 0.15");
  const std::shared_ptr<std::string> report = add_report_option(*command, session);
  command->callback([&session, options, report] { run(*options, *report, session); });
}

}  // namespace paracal::app
