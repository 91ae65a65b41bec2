#pragma once

#include <vector>

#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// A pose and its share of the workspace; the weights of a set add up to 1.
struct WeightedPose {
  Pose pose;
  double weight = 0.0;
};

/// Equally weighted points of a Cartesian grid over the box around the cylinder, those within the cylinder: 21 x 21 x 5
/// without rotation reproduce [huang2016, Table 2].
std::vector<WeightedPose> cartesian_grid(const Robot& robot, int across = 21, int layers = 5);

/// A rule that integrates over the cylinder: Gauss in radius (weight r), height and, where asked for, rotation or, on
/// struts, the three tilts; equidistant in azimuth. Each level has twice the points in every direction.
std::vector<WeightedPose> cylinder_rule(const Robot& robot, int level, bool all_rotations);

/// Points of polar circles in equidistant layers, surface included, without weights: where maxima are looked for.
struct PolarGrid {
  int radii = 5;      ///< circles, the outermost on the rim; the axis comes on top
  int azimuths = 24;  ///< points a circle
  int layers = 5;
};
std::vector<Pose> polar_grid(const Robot& robot, const PolarGrid& grid, bool all_rotations);

/// The rim and the axis on top, middle and bottom of the workspace with extremes of rotation and tilt, as densely as a
/// machine's largest error asks for: between 48 azimuths it is passed by some 2 %.
std::vector<Pose> surface_poses(const Robot& robot);

}  // namespace paracal
