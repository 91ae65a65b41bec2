#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>

#include "measuring.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/klipper.hpp"
#include "paracal/io/machine_codes.hpp"
#include "paracal/printer/printer_calibration.hpp"
#include "paracal/report/error_map.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/report/scene.hpp"
#include "paracal/units.hpp"
#include "reporting.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

constexpr std::size_t kLongestTable = 60;  // lines; --json has them all

struct Options {
  MeasuringOptions measuring;
  std::string stage = "auto", method = "best", tolerances, printer, write = "klipper";
  std::vector<std::string> fixed, free;
  bool keep_outliers = false;
  std::shared_ptr<std::string> report;
};

bool listed(const std::vector<SourceSelector>& selectors, std::size_t limb, Source source) {
  return std::ranges::any_of(selectors, [&](const SourceSelector& one) { return one.matches(limb, source); });
}

/// --fix must leave something to seek, and nothing that --free names.
void check_selection(const CalibrationOptions& options, std::size_t limb_count) {
  bool seeks = false;
  for (std::size_t limb = 0; limb < limb_count; ++limb) {
    for (const Source source : all_sources()) {
      const bool fixed = listed(options.fixed, limb, source);
      if (fixed && listed(options.free, limb, source)) {
        throw WrongUsage(fmt::format("--fix and --free: both name {} of limb {}", name(source), limb + 1));
      }
      seeks |= !fixed && (options.stage != Stage::rough || source == Source::theta_offset);
    }
  }
  if (!seeks) throw WrongUsage("--fix: expected something to be left to seek, got every source error of the stage");
}

CalibrationOptions calibration_options(const Options& options, const Robot& robot) {
  CalibrationOptions calibration;
  calibration.method = options.method == "paper" ? Method::paper : Method::best;
  calibration.stage = options.stage == "rough"  ? Stage::rough
                      : options.stage == "fine" ? Stage::fine
                                                : Stage::automatic;
  calibration.noise = options.measuring.noise();
  calibration.noise_is_known = options.measuring.sigma_known;
  calibration.frame = options.measuring.frame_kind();
  calibration.rotation_zero = options.measuring.rotation_kind();
  calibration.reflectors = options.measuring.mount();
  if (!options.tolerances.empty())
    calibration.tolerances = read_priors(io::read_file(options.tolerances), robot.actuator());
  calibration.fixed = source_selectors(options.fixed, robot.limb_count());
  calibration.free = source_selectors(options.free, robot.limb_count());
  calibration.exclude_outliers = !options.keep_outliers;
  check_selection(calibration, robot.limb_count());
  return calibration;
}

std::string residual_table(const Calibration& calibration) {
  std::string text;
  const auto out = std::back_inserter(text);
  if (!calibration.distances.empty() && calibration.distances.size() <= kLongestTable) {
    fmt::format_to(out, "  measured minus predicted, mm       distance     before      after\n");
    for (const DistanceResidual& residual : calibration.distances) {
      fmt::format_to(out, "  {:<32}{:>11.3f}{:>11.3f}{:>11.3f}\n", residual.from + " - " + residual.to,
                     residual.distance, residual.distance_before, residual.distance_after);
    }
  }
  if (!calibration.points.empty() && calibration.points.size() <= kLongestTable) {
    fmt::format_to(out, "  measured minus predicted, mm         before  after x        y        z\n");
    for (const PointResidual& residual : calibration.points) {
      fmt::format_to(out, "  {:<32}{:>11.3f}{:>9.3f}{:>9.3f}{:>9.3f}{}\n", residual.station, residual.before.norm(),
                     residual.after.x(), residual.after.y(), residual.after.z(), residual.excluded ? "  left out" : "");
    }
  }
  return text;
}

/// Predictions of a machine that was not found would mislead: they are drawn for accepted calibrations only.
void write_page(const Options& options, const Session& session, const Measurements& measurements,
                const Calibration& calibration, const io::Json& json) {
  const Robot& robot = calibration.robot;
  const KnownErrors known = known_errors(calibration);
  std::vector<report::ErrorArrow> arrows = report::measured_arrows(calibration, measurements);
  if (arrows.empty() && calibration.accepted()) {
    arrows = report::predicted_arrows(robot, known.errors, measurements.stations);
  }
  io::Json figures{{"observability", report::observability(robot)}};
  if (!arrows.empty()) figures["scene"] = report::scene(robot, arrows, known.errors);
  if (calibration.accepted()) figures["error_map"] = report::error_map(robot, known);
  write_report(*options.report, session, robot,
               {.kind = "calibration",
                .results = {{"calibration", json}},
                .figures = std::move(figures),
                .inputs = with_files(calibration.files, session, {options.tolerances})});
}

io::Json json_of(const DeltaGeometry& geometry) {
  io::Json angles = io::Json::array();
  for (const double angle : geometry.tower_angle) angles.push_back(to_degrees(angle));
  return {{"delta_radius_mm", geometry.radius},
          {"tower_angle_deg", angles},
          {"arm_length_mm", geometry.arm},
          {"position_endstop_mm", geometry.endstop}};
}

io::Json json_of(const DeltaAccuracy& accuracy) {
  return {{"absolute_rms_mm", accuracy.absolute_rms},
          {"absolute_max_mm", accuracy.absolute_max},
          {"shape_rms_mm", accuracy.shape_rms},
          {"shape_max_mm", accuracy.shape_max}};
}

io::Json json_of(const DeltaFit& fit) {
  return {{"cost_mm2", fit.cost},
          {"rms_height_mm", fit.rms_height},
          {"rms_distance_mm", fit.rms_distance},
          {"parameters", fit.parameters},
          {"geometry", json_of(fit.geometry)}};
}

io::Json json_of(const PredictionErrors& errors) {
  return {{"height_mm", errors.height}, {"distance_mm", errors.distance}};
}

io::Json printer_json(const PrinterCalibration& found) {
  io::Json json = io::to_json(found.calibration, now());
  json["printer"] = {{"recommended", found.recommended},
                     {"findings", found.findings},
                     {"saved", json_of(found.saved)},
                     {"firmware", json_of(found.firmware)},
                     {"new", json_of(found.projection.geometry)},
                     {"accuracy_saved", json_of(found.accuracy_before)},
                     {"accuracy_new", json_of(found.projection.accuracy)},
                     {"left_out", json_of(found.predicted)},
                     {"left_out_firmware", json_of(found.by_firmware)}};
  return json;
}

/// What the controller should be told, as it is told.
std::string parameters_text(const Options& options, const DeltaGeometry& geometry) {
  if (options.write == "klipper") return io::klipper_save_config(geometry);
  return io::machine_codes(geometry,
                           options.write == "marlin" ? io::CodeDialect::marlin : io::CodeDialect::reprapfirmware);
}

/// A printer's own file has all that is needed: geometry, readings, and what was read at.
void run_printer(const Options& options, Session& session) {
  const io::TextFile file = io::read_file(options.printer);
  const io::KlipperDelta printer = io::read_klipper(file);
  if (printer.readings.heights.empty()) {
    throw InputFileError(file.name, 0, "expected heights of the bed (height0 ... in [delta_calibrate]), got none");
  }
  PrinterCalibration found = calibrate_printer(printer.geometry, printer.readings, printer.print_radius);
  found.calibration.files = {{file.name, io::sha256(file.text)}};
  if (!found.recommended) session.exit_code = kVerdictIsNo;
  if (session.json() || !session.out().empty()) session.print_json(printer_json(found));
  if (session.json()) return;
  std::string text;
  for (const std::string& finding : found.findings) text += fmt::format("- {}\n", finding);
  print_summary(text + "\n" + parameters_text(options, found.projection.geometry));
}

void run(const Options& options, Session& session) {
  if (!options.printer.empty()) return run_printer(options, session);
  if (options.measuring.files.empty()) throw WrongUsage("expected --measurements or --printer");
  const Robot robot = session.robot();
  const Measurements measurements = options.measuring.read(robot.joint_space());
  CalibrationOptions wanted = calibration_options(options, robot);
  if (measurements.series.empty()) wanted.frame = Frame::unknown;  // distances have none
  const Calibration calibration = calibrate(robot, measurements, wanted);
  const io::Json file = io::to_json(calibration, now());
  if (!options.report->empty()) write_page(options, session, measurements, calibration, file);
  if (!session.out().empty()) session.print_json(file);
  if (session.json()) {
    if (session.out().empty()) session.print_json(file);
  } else {
    print_summary(calibration.brief() + residual_table(calibration) +
                  (session.out().empty() ? "" : fmt::format("  written to {}\n", session.out())));
  }
  if (!calibration.accepted()) session.exit_code = kVerdictIsNo;
}

}  // namespace

void add_calibrate(CLI::App& app, Session& session) {
  CLI::App* command =
      session.add_command(app, "calibrate", "Calibrate a machine",
                          "identify source errors from measurements; --out keeps the calibration (JSON)");
  const auto options = std::make_shared<Options>();
  add_measuring_options(*command, options->measuring);
  CLI::Option* measurements = command->get_option("--measurements");
  measurements->required(false);
  command
      ->add_option("--printer", options->printer,
                   "instead: a linear delta's Klipper printer.cfg, with what DELTA_CALIBRATE left in it")
      ->excludes(measurements);
  command->add_option("--write", options->write, "with --printer: how to write the new values")
      ->check(CLI::IsMember({"klipper", "reprapfirmware", "marlin"}))
      ->capture_default_str();
  command->add_flag("--sigma-known", options->measuring.sigma_known,
                    "--sigma-mm and --sigma-deg are facts: the residuals do not correct them");
  command->add_option("--reflectors", options->measuring.reflectors, "what the second reflector is mounted on")
      ->check(CLI::IsMember({"plate", "end-effector"}))
      ->capture_default_str();
  command
      ->add_option("--stage", options->stage,
                   "rough: the encoder offsets; fine: everything; auto: as far as the data carry")
      ->check(CLI::IsMember({"rough", "fine", "auto"}))
      ->capture_default_str();
  command->add_option("--method", options->method, "best: exact model, full covariance, priors; paper: Eqs. 19 and 21")
      ->check(CLI::IsMember({"best", "paper"}))
      ->capture_default_str();
  command->add_option("--tolerances", options->tolerances, "priors (TOML); default: the robot's tolerances");
  command->add_option("--fix", options->fixed, "source errors held at zero, e.g. alpha0,e_x2")->delimiter(',');
  command->add_option("--free", options->free, "source errors sought without a prior")->delimiter(',');
  command->add_flag("--keep-outliers", options->keep_outliers,
                    "name readings that contradict the others, but use them");
  options->report = add_report_option(*command);
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
