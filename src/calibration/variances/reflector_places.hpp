#pragma once

// Private to calibration: a reflector that is beside the axis or the centre that it was put on.

#include <string>
#include <vector>

#include "linear_readings.hpp"
#include "paracal/calibration/measurement.hpp"

namespace paracal::detail {

/// A mount that turns in these readings, and would show the place of the reflector on it.
struct ReflectorPlace {
  ReflectorMount mount;
  std::string subject;     ///< "the reflector is beside the axis of phi"
  Eigen::MatrixXd effect;  ///< readings by its place, 1/mm
};

/// None where the reflector may be anywhere already, or orientations or a second reflector are read.
std::vector<ReflectorPlace> reflector_places(const StageFit& fit, const Measurements& measurements,
                                             const LinearReadings& readings);

}  // namespace paracal::detail
