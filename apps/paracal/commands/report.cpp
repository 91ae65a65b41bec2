#include <memory>

#include "paracal/calibration/plan.hpp"
#include "paracal/io/measurement_files.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/report/scene.hpp"
#include "reporting.hpp"
#include "session.hpp"
#include "validating.hpp"

namespace paracal::app {
namespace {

/// The calibration's own page, with what other measurements say of it where they are given.
void run(const ValidatingOptions& options, Session& session) {
  const Robot robot = session.robot(options.robot_sources());
  const io::JsonFile& file = session.calibration_file(options.calibration);
  const io::CalibratedMachine machine = io::read_calibration(file, robot);
  const KnownErrors known = machine.known();
  ReportContent content{.kind = "calibration", .results = {{"calibration", file.json}}};
  std::vector<report::ErrorArrow> arrows;
  std::vector<Station> stations = validation_stations(robot);
  std::vector<InputFile> inputs{{file.text.name, io::sha256(file.text)}};
  if (!options.measuring.files.empty()) {
    io::require_inputs(file);
    const CommandedReadings read = options.read(machine, robot);
    const Measurements& measurements = read.measurements;
    inputs.insert(inputs.end(), measurements.files.begin(), measurements.files.end());
    stations = measurements.stations;
    if (options.own(machine, measurements).empty()) {
      const Validation validation = validate(robot, known, measurements, options.options(read, robot));
      if (validation.accepted == false) session.exit_code = kVerdictIsNo;
      content.results["validation"] = io::to_json(validation);
      arrows = report::measured_arrows(validation);
    }
  }
  if (arrows.empty()) arrows = report::predicted_arrows(robot, machine.errors, stations);
  content.figures = {{"scene", report::scene(robot, arrows, machine.errors)}};
  add_error_map(robot, known, content);
  if (robot.is_level()) content.figures["observability"] = report::observability(robot);
  content.inputs = with_files(std::move(inputs), session, {});
  const io::Json data = report_data(session, robot, content);
  session.json() ? session.print_json(data) : session.print(report_page(data));
}

}  // namespace

void add_report(Command& program, Session& session) {
  Command* command = session.add_command(program, "report", "Calibrate a machine",
                                         "write an HTML report of a calibration, with --out FILE");
  const auto options = std::make_shared<ValidatingOptions>();
  add_validating_options(*command, *options)->required(false);
  command->example("A report with a validation",
                   "paracal report --calibration calibration.json --measurements check.csv --out report.html");
  command->callback([&session, options] { run(*options, session); });
}

}  // namespace paracal::app
