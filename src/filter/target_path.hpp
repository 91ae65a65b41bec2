#pragma once

// Private to the filter: the path that the plate takes from one target to the next.

#include <array>
#include <cstddef>

#include "paracal/mechanism/pose.hpp"

namespace paracal::io {

inline constexpr std::size_t kAxes = 4;
inline constexpr std::size_t kRotation = 3;  ///< C, phi; before it X, Y, Z

/// Coordinates as files state them: x, y, z and phi, mm and deg.
using AxisValues = std::array<double, kAxes>;

/// A place and the pose that it is in {O}; `origin` of places in {O}, mm.
Pose pose_at(const AxisValues& place, const Eigen::Vector3d& origin);
AxisValues place_of(const Pose& pose, const Eigen::Vector3d& origin);

/// A turn about an axis of the frame, in the plane of two others, mm and rad. Its radius may change evenly from end to
/// end: what the rounding of a centre leaves.
struct ArcOfPath {
  std::array<std::size_t, 2> plane{0, 1};  ///< axes: a positive sweep turns the first towards the second
  std::array<double, 2> centre{};
  double start_radius = 0.0, end_radius = 0.0;
  double start_angle = 0.0;
  double sweep = 0.0;  ///< 0: there is no arc
};

/// A straight line, or a helix about an axis of the frame; all other axes move evenly along it.
struct TargetPath {
  AxisValues from{}, to{};
  ArcOfPath arc = {};

  bool is_arc() const { return arc.sweep != 0.0; }
  /// Between `from` (t = 0) and `to` (t = 1), both exactly.
  AxisValues at(double t) const;
  /// mm of X, Y and Z.
  double length() const;
};

}  // namespace paracal::io
