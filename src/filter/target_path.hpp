#pragma once

// Private to the filter: the path that the plate takes from one target to the next.

#include <array>
#include <cstddef>
#include <vector>

#include "paracal/filter/target_filter.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::io {

/// Coordinates as files state them.
using AxisValues = ProgramAxes;
inline constexpr std::size_t kAxes = std::tuple_size_v<AxisValues>;
inline constexpr std::size_t kFirstTurn = 3;  ///< A, B, C; before them X, Y, Z

/// The axes that a robot moves, and the poses in {O} that their places are. X, Y and Z move the plate, A, B and C tilt
/// it; C turns an end-effector. Files state other axes, too: a pen that is lifted along Z above a plate in a plane.
class RobotAxes {
 public:
  /// @param origin  of places in {O}, mm.
  explicit RobotAxes(const Robot& robot, Eigen::Vector3d origin = Eigen::Vector3d::Zero());

  const std::vector<std::size_t>& moved() const { return moved_; }
  bool moves(std::size_t axis) const { return is_moved_[axis]; }
  bool tilt_plate() const { return freedoms_.tilt(); }

  /// Guides hold z and tilts wherever other axes are; a rotation that a plate cannot have stays, and is out of reach.
  Pose pose_at(const AxisValues& place) const;
  /// 0 along other axes.
  AxisValues place_of(const Pose& pose) const;

 private:
  PlateFreedoms freedoms_;
  double guided_z_;
  Eigen::Vector3d origin_;
  std::array<bool, kAxes> is_moved_{};
  std::vector<std::size_t> moved_;
};

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
  /// deg of A, B and C, as controllers count them together.
  double turned() const;
};

}  // namespace paracal::io
