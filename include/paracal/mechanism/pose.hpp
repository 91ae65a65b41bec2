#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace paracal {

/// At most this many limbs: fixed-capacity types keep pose evaluations free of heap allocation.
inline constexpr int kMaxLimbs = 8;

/// Names of the possible degrees of freedom of a plate on limbs with one rod.
inline constexpr std::array<std::string_view, 6> kPlateCoordinates{"x", "y", "z", "tilt_x", "tilt_y", "tilt_z"};

/// Degrees of freedom that guides or parallelograms leave to a plate, of x, y, z, tilt_x, tilt_y, tilt_z. A five-bar
/// moves in x and y, a Delta in x, y and z. There are at least as many limbs as degrees of freedom.
struct PlateFreedoms {
  std::array<bool, 6> free{true, true, true, true, true, true};

  constexpr std::size_t count() const { return static_cast<std::size_t>(std::ranges::count(free, true)); }
  constexpr bool are_all() const { return count() == free.size(); }
  constexpr bool holds_z() const { return !free[2]; }
  constexpr bool tilt() const { return free[3] || free[4] || free[5]; }
  bool operator==(const PlateFreedoms&) const = default;
};

/// Of a plate that parallelograms keep level.
inline constexpr PlateFreedoms kLevelPlate{{true, true, true, false, false, false}};

/// A commanded pose: position of the plate centre O', and rotation of the end-effector or of the plate itself.
///
///   position   r, mm, in the base frame {O}: origin at the base centre, z up, so the workspace of a hanging plate has
///              z < 0
///   rotation   phi = s / r_g, rad, of the end-effector relative to the plate about z; 0 for a rigid plate
///   tilt       (tilt_x, tilt_y, tilt_z), rad, of a plate on limbs with one rod: R = Rot(x, tilt_x) Rot(y, tilt_y)
///   Rot(z,
///              tilt_z), as far as its guides leave it free; 0 for the others, which can only stay level
struct Pose {
  Eigen::Vector3d position;
  double rotation = 0.0;
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();
};

/// Actuated joint coordinates q, one a limb (rad of revolute actuators, mm of linear ones), without heap allocation.
using Joints = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxLimbs, 1>;

}  // namespace paracal
