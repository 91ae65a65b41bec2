#include "calibration_page.hpp"

#include "paracal/report/error_map.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/report/scene.hpp"
#include "reporting.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

/// Heights above a plane that is sought with the rest do not see how high the machine stands: what is drawn is what
/// they do see.
void level(std::vector<report::ErrorArrow>& arrows) {
  double mean = 0.0;
  for (const report::ErrorArrow& arrow : arrows) mean += arrow.before.z() / static_cast<double>(arrows.size());
  for (report::ErrorArrow& arrow : arrows) arrow.before.z() -= mean;
}

}  // namespace

void write_calibration_page(const std::string& page, const Session& session, const Measurements& measurements,
                            const Calibration& calibration, const io::Json& json,
                            const std::vector<std::string>& files) {
  const Robot& robot = calibration.robot;
  const KnownErrors known = known_errors(calibration);
  std::vector<report::ErrorArrow> arrows = report::measured_arrows(calibration, measurements);
  if (arrows.empty() && calibration.accepted()) {
    arrows = report::predicted_arrows(robot, known.errors, measurements.stations);
    if (!measurements.planes.empty()) level(arrows);
  }
  io::Json figures{{"observability", report::observability(robot)}};
  if (!arrows.empty()) figures["scene"] = report::scene(robot, arrows, known.errors);
  if (calibration.accepted()) figures["error_map"] = report::error_map(robot, known);
  write_report(page, session, robot,
               {.kind = "calibration",
                .results = {{"calibration", json}},
                .figures = std::move(figures),
                .inputs = with_files(calibration.files, session, files)});
}

}  // namespace paracal::app
