#pragma once

// Private to calibration: from where the plate of a station is sought.

#include <string>

#include "paracal/calibration/measurement.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"

namespace paracal::detail {

/// A plate with six freedoms has many assembly modes: that near the commanded pose is meant. One that stays level has
/// the mode that forward() starts in.
inline ForwardOptions started(const Robot& robot, const Station& station) {
  if (robot.is_level()) return {};
  return {.start = plate_at(robot.nominal(), station.commanded)};
}

/// Why no fit begins: the first station where the machine does not close with the joints believed there.
inline Unreachable not_closed(const Robot& robot, const Machine& machine, const std::vector<Station>& stations) {
  for (const Station& station : stations) {
    const ForwardResult found = forward(machine, believed_joints(robot, station), started(robot, station));
    if (found.usable()) continue;
    return Unreachable{named(station) + ": no solution with the commanded joints: " + why_no_pose(machine, found)};
  }
  return Unreachable{"no solution: the machine does not close with the commanded joints"};
}

}  // namespace paracal::detail
