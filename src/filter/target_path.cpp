#include "target_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "paracal/mechanism/coordinates.hpp"
#include "paracal/units.hpp"

namespace paracal::io {

RobotAxes::RobotAxes(const Robot& robot, Eigen::Vector3d origin)
    : freedoms_(robot.nominal().freedoms),
      guided_z_(robot.nominal().guided_z),
      origin_(std::move(origin)),
      moved_(commanded_coordinates(robot.nominal())) {
  for (const std::size_t axis : moved_) is_moved_[axis] = true;
}

Pose RobotAxes::pose_at(const AxisValues& place) const {
  Pose pose{origin_ + Eigen::Vector3d(place[0], place[1], place[2])};
  if (freedoms_.holds_z()) pose.position.z() = guided_z_;
  for (Eigen::Index about = 0; about < 3; ++about) {
    const std::size_t axis = kFirstTurn + static_cast<std::size_t>(about);
    if (freedoms_.free[axis]) pose.tilt(about) = to_radians(place[axis]);
  }
  if (!freedoms_.free.back()) pose.rotation = to_radians(place.back());
  return pose;
}

AxisValues RobotAxes::place_of(const Pose& pose) const {
  const Eigen::Vector3d r = pose.position - origin_;
  const double about_z = freedoms_.free.back() ? pose.tilt.z() : pose.rotation;
  AxisValues place{r.x(), r.y(), r.z(), to_degrees(pose.tilt.x()), to_degrees(pose.tilt.y()), to_degrees(about_z)};
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (!is_moved_[axis]) place[axis] = 0.0;
  }
  return place;
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
  for (std::size_t axis = 0; axis < kFirstTurn; ++axis) {
    if (is_arc() && (axis == arc.plane[0] || axis == arc.plane[1])) continue;
    squares += (to[axis] - from[axis]) * (to[axis] - from[axis]);
  }
  const double around = is_arc() ? std::abs(arc.sweep) * std::max(arc.start_radius, arc.end_radius) : 0.0;
  return std::sqrt(squares + around * around);
}

double TargetPath::turned() const { return std::hypot(to[3] - from[3], to[4] - from[4], to[5] - from[5]); }

}  // namespace paracal::io
