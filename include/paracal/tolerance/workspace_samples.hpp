#pragma once

#include <vector>

#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// A pose and its weight; the sum of the weights is 1.
struct WeightedPose {
  Pose pose;
  double weight = 0.0;
};

/// Equally weighted points of a Cartesian grid over the box around the workspace, those within it: 21 x 21 x 5 without
/// rotation reproduce [huang2016, Table 2].
std::vector<WeightedPose> cartesian_grid(const Robot& robot, int across = 21, int layers = 5);

/// A rule that integrates over the workspace: Gauss outward (weight r), in depth and, where asked for, in rotation or,
/// on struts, the three tilts; equidistant in azimuth, or Gauss between upright edges. Each level has twice the points
/// in every direction.
std::vector<WeightedPose> volume_rule(const Robot& robot, int level, bool all_rotations);

/// Points of polar circles in equidistant layers, including the surface, without weights: to search for maxima.
struct PolarGrid {
  int radii = 5;      ///< circles, the outermost on the rim; the axis comes on top
  int azimuths = 24;  ///< points per circle
  int layers = 5;
};
std::vector<Pose> polar_grid(const Robot& robot, const PolarGrid& grid, bool all_rotations);

/// Rim and axis in the top, middle and bottom layers, at the extremes of rotation and tilt. With 48 azimuths the
/// largest error of a machine between them is about 2 % larger.
std::vector<Pose> surface_poses(const Robot& robot);

}  // namespace paracal
