#pragma once

#include <Eigen/Core>
#include <vector>

#include "paracal/mechanism/pose.hpp"

namespace paracal {

/// Cylindrical task workspace about the z axis, in mm and rad [huang2016, Table 1]. It hangs below the base:
/// z runs from top_z (negative) down to top_z - height. (Table 1's H is the depth of the top; docs/paper-slips.md.)
/// That of a plate on struts may stand above it.
struct Workspace {
  double radius = 0.0;
  double height = 0.0;
  double top_z = 0.0;
  double min_rotation = 0.0;  ///< of the end-effector; both zero for a rigid plate
  double max_rotation = 0.0;
  double max_tilt = 0.0;  ///< each of the three angles, either way, of a plate with six freedoms; 0 of the others

  /// P_0: the centre of the cylinder, the home position of calibrations.
  Eigen::Vector3d centre() const { return {0.0, 0.0, top_z - 0.5 * height}; }

  /// Whether a place lies in the cylinder, or within `slack` (mm) of it.
  bool contains(const Eigen::Vector3d& place, double slack) const;

  /// Point on the axis-parallel circle of a layer: azimuth in rad from x towards y.
  static Eigen::Vector3d on_circle(double circle_radius, double azimuth, double z);

  /// Level, and tilted as far as it goes: about each axis, both ways, and about all three.
  std::vector<Eigen::Vector3d> tilts() const;

  /// Poses on both rims at the extreme and middle rotations and at all tilts: where reach is worst.
  std::vector<Pose> rim(int points_per_circle) const;
};

}  // namespace paracal
