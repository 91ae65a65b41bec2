#pragma once

#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/io/json.hpp"

namespace paracal::app {

class Session;

/// The page of a calibration. Predictions of a machine that was not found would mislead: they are drawn for accepted
/// calibrations only.
/// @param json  of the calibration, as --json prints it.
/// @param files  that were read besides the measurements.
void write_calibration_page(const std::string& page, const Session& session, const Measurements& measurements,
                            const Calibration& calibration, const io::Json& json,
                            const std::vector<std::string>& files = {});

}  // namespace paracal::app
