#pragma once

#include <memory>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/io/json.hpp"
#include "paracal/report/scene.hpp"

namespace paracal::app {

class Session;

/// What a report shows.
struct ReportContent {
  std::string kind;                       ///< what was done: "calibration", "validation", ...
  io::Json results;                       ///< by command, as --json prints them
  io::Json figures = io::Json::object();  ///< what drawings need beyond
  std::vector<InputFile> inputs = {};
};

/// --report FILE; empty when it was not asked for.
std::shared_ptr<std::string> add_report_option(Command& command, Session& session);

/// Files that were read and are not in `inputs` yet, with the robot's; empty names are passed over.
std::vector<InputFile> with_files(std::vector<InputFile> inputs, const Session& session,
                                  const std::vector<std::string>& files);

/// The content with all that is needed to repeat it: what the page reads.
io::Json report_data(const Session& session, const Robot& robot, const ReportContent& content);

/// One HTML file that shows these data.
std::string report_page(const io::Json& data);

/// Writes the page, whole or not at all.
void write_report(const std::string& file, Session& session, const Robot& robot, const ReportContent& content);

/// Adds the map of errors over the workspace. A machine that does not reach all of its poses has none: a note says so.
void add_error_map(const Robot& robot, const KnownErrors& known, ReportContent& content);

/// What the page of a calibration draws besides its numbers. Predictions of a machine that was not found would mislead:
/// they are drawn for accepted calibrations only.
struct CalibrationPage {
  std::vector<report::ErrorArrow> arrows = {};
  bool map = false;  ///< of errors against the nominal robot, over the workspace
  bool plan = true;  ///< how many points a circle would do; owners of printers and of struts measure no circles
  std::vector<std::string> files = {};  ///< that were read besides the measurements
};

/// Errors as measured, or where these have no direction as the calibration predicts them of the nominal robot.
CalibrationPage page_of(const Calibration& calibration, const Measurements& measurements);

/// @param json  of the calibration, as --json prints it.
void write_calibration_page(const std::string& file, Session& session, const Calibration& calibration,
                            const io::Json& json, const CalibrationPage& page);

}  // namespace paracal::app
