#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <utility>

#include "controller.hpp"
#include "measuring.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/source_selection.hpp"
#include "paracal/io/file.hpp"
#include "printing.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "settings.hpp"

namespace paracal::app {
namespace {

struct CalibrateArguments {
  MeasuringOptions measuring;
  Settings<io::CalibrationSettings> settings;
  ControllerOptions controller;
  PrinterOptions printer;
  std::shared_ptr<std::string> report;
};

CalibrationOptions calibration_options(const CalibrateArguments& options, const Robot& robot) {
  CalibrationOptions calibration;
  options.settings.put_into(calibration, robot);
  if (calibration.noise.joint > 0.0 && robot.nominal().gap_count() == 0) {
    throw WrongUsage(
        "--joint-sigma: expected a robot with more limbs than degrees of freedom and one rod on each, got " +
        robot.name());
  }
  try {
    check_selection(calibration, robot.joint_space());
  } catch (const InvalidArgument& refused) {
    throw WrongUsage(std::string("--fix, --free: ") + refused.what());
  }
  return calibration;
}

/// The ten largest residuals, largest first.
/// @param size  of a residual.
/// @param line  of the table.
template <typename Residual, typename Size, typename Line>
std::string largest_of(const std::vector<Residual>& all, const std::string& head, Size&& size, Line&& line) {
  constexpr std::size_t kMost = 10;
  std::vector<std::pair<double, std::string>> sized;
  for (const Residual& one : all) {
    const double of = size(one);  // none where a reading overflows
    const std::string excluded = one.excluded ? "  excluded" : "";
    sized.emplace_back(std::isfinite(of) ? of : std::numeric_limits<double>::max(), line(one) + excluded + '\n');
  }
  if (sized.empty()) return {};
  std::ranges::stable_sort(sized, std::greater{}, &std::pair<double, std::string>::first);
  std::string text = "  measured minus predicted, mm" + head + '\n';
  for (std::size_t k = 0; k < std::min(sized.size(), kMost); ++k) text += sized[k].second;
  if (sized.size() <= kMost) return text;
  return text + fmt::format("  the {} largest of {}; --json, --out and --report have all\n", kMost, sized.size());
}

std::string residual_table(const Calibration& calibration) {
  std::string text = largest_of(
      calibration.distances, "       distance     before      after",
      [](const DistanceResidual& one) { return std::abs(one.distance_after); },
      [](const DistanceResidual& one) {
        return fmt::format("  {:<32}{:>11.3f}{:>11.3f}{:>11.3f}", one.from + " - " + one.to, one.distance,
                           one.distance_before, one.distance_after);
      });
  for (const LengthWords& kind : length_kinds()) {
    std::vector<LengthResidual> lengths;
    std::ranges::copy_if(calibration.lengths, std::back_inserter(lengths),
                         [&](const LengthResidual& one) { return one.kind == kind.kind; });
    text += largest_of(
        lengths, fmt::format("{:>15}     before      after", kind.name),
        [](const LengthResidual& one) { return std::abs(one.after); },
        [](const LengthResidual& one) {
          return fmt::format("  {:<32}{:>11.3f}{:>11.3f}{:>11.3f}", one.station, one.length, one.before, one.after);
        });
  }
  return text + largest_of(
                    calibration.points, "         before  after x        y        z",
                    [](const PointResidual& one) { return one.after.norm(); },
                    [](const PointResidual& one) {
                      return fmt::format("  {:<32}{:>11.3f}{:>9.3f}{:>9.3f}{:>9.3f}", one.station, one.before.norm(),
                                         one.after.x(), one.after.y(), one.after.z());
                    });
}

void run(const CalibrateArguments& options, Session& session) {
  if (!options.printer.printer.name.empty()) {
    PrinterOptions printer = options.printer;
    printer.style = options.measuring.style;
    return calibrate_printer_file(printer, *options.report, session);
  }
  if (options.measuring.files.empty())
    throw WrongUsage("expected --measurements FILE, got none; see paracal calibrate --help");
  const Robot robot = session.robot({.tables = options.measuring.tables()});
  const auto [measurements, controller] =
      read_commanded(options.measuring, options.controller, stated_controller(options.controller, robot), robot);
  CalibrationOptions wanted = calibration_options(options, robot);
  wanted.controller = controller;
  if (measurements.series.empty()) wanted.frame = Frame::unknown;  // distances have none
  const Calibration calibration = calibrate(robot, measurements, wanted);
  const io::Json file = io::to_json(calibration, now());
  if (!options.report->empty()) {
    CalibrationPage page = page_of(calibration, measurements);
    page.files = options.settings.option("tolerances")->values();
    write_calibration_page(*options.report, session, calibration, file, page);
  }
  if (!session.out().empty()) session.print_json(file);
  if (session.json()) {
    if (session.out().empty()) session.print_json(file);
  } else {
    const std::string written = session.out().empty() ? "" : fmt::format("  written to {}\n", session.out());
    session.print_verdict(calibration.brief() + residual_table(calibration) + written, calibration.accepted());
  }
  if (!calibration.accepted()) session.exit_code = kVerdictIsNo;
}

}  // namespace

void add_calibrate(Command& program, Session& session) {
  Command* command =
      session.add_command(program, "calibrate", "Calibrate a machine",
                          "estimate the machine's errors from measurements; --out saves the calibration (JSON)");
  const auto options = std::make_shared<CalibrateArguments>();
  add_measuring_options(*command, options->measuring);
  Option* measurements = command->get_option("--measurements");
  measurements->required(false);
  options->settings.declare(*command);
  add_controller_options(*command, options->controller);
  add_controller_robot_option(*command, options->controller);
  command->heading(kHidden);  // shown by paracal printer
  Option* const printer = add_printer_option(*command, options->printer.printer)->excludes(measurements);
  for (Option* one : add_printer_options(*command, options->printer, session.outputs)) one->needs(printer);
  command->heading("Results");
  options->report = add_report_option(*command, session);
  command->example("Calibrate from a laser tracker's points and save the result",
                   "paracal calibrate --measurements measured.csv --out calibration.json");
  command->example("Use distances between named poses",
                   "paracal calibrate --measurements bar.csv --poses bar_plan.csv");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
