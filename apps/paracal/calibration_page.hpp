#pragma once

#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/io/json.hpp"
#include "paracal/report/scene.hpp"

namespace paracal::app {

class Session;

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
