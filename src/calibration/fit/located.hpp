#pragma once

// Private to calibration: what was read, as poses of the plate in the robot's frame.

#include <map>
#include <vector>

#include "placement.hpp"

namespace paracal::detail {

/// A series' points and rotations in the robot's frame.
struct Located {
  std::vector<std::size_t> order;  ///< stations in which they were read, home first
  std::map<std::size_t, std::vector<Pose>> repeats;
  bool rotations = false;
};

/// By the frame and the zero of the rotation that bring the points closest to the predicted poses.
Located locate(const PointSeries& series, const std::vector<Pose>& predicted, const ValidationOptions& options);

/// The same of a body's poses: those of the machine, and what the readings differ from them once frame and body have
/// been fitted.
/// @param series  its place.
Located locate_body(const Placement& placement, std::size_t series);

Pose mean_of(const std::vector<Pose>& poses);

}  // namespace paracal::detail
