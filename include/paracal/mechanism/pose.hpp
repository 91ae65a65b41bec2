#pragma once

#include <Eigen/Core>

namespace paracal {

/// At most this many limbs: fixed-capacity types keep pose evaluations free of heap allocation.
inline constexpr int kMaxLimbs = 6;

/// What a controller commands: where the plate centre O' goes and how far the end-effector turns, or the plate itself.
///
///   position   r, mm, in the base frame {O}: origin at the base centre, z up, so the workspace of a hanging plate has
///              z < 0
///   rotation   phi = s / r_g, rad, of the end-effector relative to the plate about z; 0 for a rigid plate
///   tilt       (tilt_x, tilt_y, tilt_z), rad, of a plate with six freedoms: R = Rot(x, tilt_x) Rot(y, tilt_y) Rot(z,
///              tilt_z); 0 for the others, which can only stay level
struct Pose {
  Eigen::Vector3d position;
  double rotation = 0.0;
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();
};

/// Actuated joint coordinates q, one a limb (rad of revolute actuators, mm of linear ones), without heap allocation.
using Joints = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxLimbs, 1>;

}  // namespace paracal
