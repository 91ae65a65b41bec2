#include "calibration_page.hpp"

#include "paracal/report/error_map.hpp"
#include "paracal/report/plots.hpp"
#include "reporting.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

/// Lengths from a set-up that is sought with the rest do not see how high the machine stands, as heights above a plane:
/// what is drawn is what they do see.
void level(std::vector<report::ErrorArrow>& arrows) {
  double mean = 0.0;
  for (const report::ErrorArrow& arrow : arrows) mean += arrow.before.z() / static_cast<double>(arrows.size());
  for (report::ErrorArrow& arrow : arrows) arrow.before.z() -= mean;
}

}  // namespace

CalibrationPage page_of(const Calibration& calibration, const Measurements& measurements) {
  CalibrationPage page{.arrows = report::measured_arrows(calibration, measurements), .map = calibration.accepted()};
  if (!page.arrows.empty() || !calibration.accepted()) return page;
  page.arrows = report::predicted_arrows(calibration.robot, known_errors(calibration).errors, measurements.stations);
  if (!measurements.lengths.empty()) level(page.arrows);
  return page;
}

void write_calibration_page(const std::string& file, Session& session, const Calibration& calibration,
                            const io::Json& json, const CalibrationPage& page) {
  const Robot& robot = calibration.robot;
  const KnownErrors known = known_errors(calibration);
  io::Json figures = io::Json::object();
  if (page.plan && !robot.on_single_rods()) figures["observability"] = report::observability(robot);
  if (!page.arrows.empty()) figures["scene"] = report::scene(robot, page.arrows, known.errors);
  if (page.map) figures["error_map"] = report::error_map(robot, known);
  write_report(file, session, robot,
               {.kind = "calibration",
                .results = {{"calibration", json}},
                .figures = std::move(figures),
                .inputs = with_files(calibration.files, session, page.files)});
}

}  // namespace paracal::app
