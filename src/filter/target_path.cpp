#include "target_path.hpp"

#include <algorithm>
#include <cmath>

#include "paracal/units.hpp"

namespace paracal::io {

Pose pose_at(const AxisValues& place, const Eigen::Vector3d& origin) {
  return {origin + Eigen::Vector3d(place[0], place[1], place[2]), to_radians(place[kRotation])};
}

AxisValues place_of(const Pose& pose, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d r = pose.position - origin;
  return {r.x(), r.y(), r.z(), to_degrees(pose.rotation)};
}

AxisValues TargetPath::at(double t) const {
  if (t <= 0.0) return from;
  if (t >= 1.0) return to;
  AxisValues place;
  for (std::size_t axis = 0; axis < kAxes; ++axis) place[axis] = from[axis] + t * (to[axis] - from[axis]);
  if (!is_arc()) return place;
  const double radius = arc.start_radius + t * (arc.end_radius - arc.start_radius);
  const double angle = arc.start_angle + t * arc.sweep;
  place[arc.plane[0]] = arc.centre[0] + radius * std::cos(angle);
  place[arc.plane[1]] = arc.centre[1] + radius * std::sin(angle);
  return place;
}

double TargetPath::length() const {
  double squares = 0.0;
  for (std::size_t axis = 0; axis < kRotation; ++axis) {
    if (is_arc() && (axis == arc.plane[0] || axis == arc.plane[1])) continue;
    squares += (to[axis] - from[axis]) * (to[axis] - from[axis]);
  }
  const double around = is_arc() ? std::abs(arc.sweep) * std::max(arc.start_radius, arc.end_radius) : 0.0;
  return std::sqrt(squares + around * around);
}

}  // namespace paracal::io
