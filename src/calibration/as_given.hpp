#pragma once

// Private to calibration.

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"

namespace paracal::detail {

/// calibrate() of an input that is taken to be right.
Calibration calibrate_as_given(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options);

}  // namespace paracal::detail
