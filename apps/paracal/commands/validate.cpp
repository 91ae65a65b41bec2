#include <fmt/format.h>

#include <iterator>
#include <memory>

#include "paracal/report/error_map.hpp"
#include "paracal/report/scene.hpp"
#include "paracal/units.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "validating.hpp"

namespace paracal::app {
namespace {

std::string text_of(const Validation& validation) {
  std::string text = fmt::format("validation: {}\n", validation.accepted ? "accepted" : "not accepted");
  const auto out = std::back_inserter(text);
  for (const std::string& reason : validation.reasons) fmt::format_to(out, "  because {}\n", reason);
  fmt::format_to(out, "  largest errors over {} poses{:>14}{:>11}\n", validation.poses.size(), "before", "after");
  const auto line = [&](const char* what, double before, double after) {
    fmt::format_to(out, "  {:<38}{:>8.3f}{:>11.3f}\n", what, before, after);
  };
  const PoseErrorSummary &before = validation.before, &after = validation.after;
  line("distance to home, mm", before.max_abs_distance, after.max_abs_distance);
  line("position relative to home, mm", before.max_volumetric, after.max_volumetric);
  line("position after best alignment, mm", before.max_volumetric_aligned, after.max_volumetric_aligned);
  if (before.max_abs_rotation) {
    line("rotation relative to home, deg", to_degrees(*before.max_abs_rotation), to_degrees(*after.max_abs_rotation));
  }
  if (!validation.iso9283.poses.empty()) {
    const Iso9283& iso = validation.iso9283;
    fmt::format_to(out, "  ISO 9283, uncompensated, worst pose: AP {:.3f}, RP {:.3f}, AD {:.3f}, RD {:.3f} mm\n",
                   iso.max_AP, iso.max_RP, iso.max_AD, iso.max_RD);
  }
  for (const LimitCheck& check : validation.checks) {
    fmt::format_to(out, "  {}: {:.4g}, U {:.2g} (k = 2), limit {:.4g}: {}\n", check.quantity, check.error,
                   check.uncertainty, check.limit, name(check.conformity));
  }
  return text;
}

void run(const ValidatingOptions& options, const std::string& report, Session& session) {
  const Robot robot = session.robot(options.robot_sources());
  const KnownErrors known = io::read_calibration(input_file(options.calibration), robot).known();
  const Measurements measurements = options.measuring.read(robot.joint_space());
  const Validation validation = validate(robot, known, measurements, options.options());
  const io::Json json = io::to_json(validation);
  if (!report.empty()) {
    write_report(report, session, robot,
                 {.kind = "validation",
                  .results = {{"validation", json}},
                  .figures = {{"scene", report::scene(robot, report::measured_arrows(validation), known.errors)},
                              {"error_map", report::error_map(robot, known)}},
                  .inputs = with_files(measurements.files, session, {options.calibration})});
  }
  session.json() ? session.print_json(json) : session.print(text_of(validation));
  if (!validation.accepted) session.exit_code = kVerdictIsNo;
}

}  // namespace

void add_validate(Command& program, Session& session) {
  Command* command = session.add_command(program, "validate", "Calibrate a machine",
                                         "a calibration on poses that it has not seen; ISO 9283 from repeats");
  const auto options = std::make_shared<ValidatingOptions>();
  add_validating_options(*command, *options);
  const std::shared_ptr<std::string> report = add_report_option(*command, session);
  command->callback([&session, options, report] { run(*options, *report, session); });
}

}  // namespace paracal::app
