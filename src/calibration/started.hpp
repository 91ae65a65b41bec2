#pragma once

// Private to calibration: from where the plate of a station is sought.

#include "paracal/calibration/measurement.hpp"
#include "paracal/kinematics/forward.hpp"

namespace paracal::detail {

/// A plate with six freedoms has many assembly modes: that near the commanded pose is meant. One that stays level has
/// the mode that forward() starts in.
inline ForwardOptions started(const Robot& robot, const Station& station) {
  if (!robot.on_single_rods()) return {};
  return {.start = plate_at(robot.nominal(), station.commanded)};
}

}  // namespace paracal::detail
