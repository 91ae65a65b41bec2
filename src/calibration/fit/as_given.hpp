#pragma once

// Private to calibration.

#include <cstdint>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"

namespace paracal::detail {

/// What is told of a fit. Of hundreds of virtual machines nobody reads the rest, which costs as much as some
/// iterations.
enum class Told : std::uint8_t {
  errors,   ///< the values of the parameters, and no verdict
  verdict,  ///< the same, with their covariance and the verdict
  everything,
};

/// calibrate() of an input that is taken to be right.
/// @param causes  that are known already.
Calibration calibrate_as_given(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
                               Told told = Told::everything, std::vector<Component> causes = {});

}  // namespace paracal::detail
