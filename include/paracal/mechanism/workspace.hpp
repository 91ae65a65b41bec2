#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "paracal/mechanism/pose.hpp"

namespace paracal {

/// Cylindrical task workspace about the z axis, in mm and rad [huang2016, Table 1]. It hangs below the base:
/// z runs from top_z (negative) down to top_z - height. (Table 1's H is the depth of the top; docs/paper-slips.md.)
/// That of a plate on limbs with one rod may stand above it; where guides hold the plate in a plane it is a disk there,
/// without height.
struct Workspace {
  double radius = 0.0;
  double height = 0.0;
  double top_z = 0.0;
  double min_rotation = 0.0;  ///< of the end-effector; both zero for a rigid plate
  double max_rotation = 0.0;
  double max_tilt = 0.0;  ///< each angle that is free, either way, of a plate on limbs with one rod; 0 of the others
  std::array<bool, 3> tilts_about{true, true, true};  ///< which angles are free; Robot says it

  /// P_0: the centre of the cylinder, the home position of calibrations.
  Eigen::Vector3d centre() const { return {0.0, 0.0, top_z - 0.5 * height}; }

  bool is_flat() const { return height == 0.0; }
  /// How many of that many layers lie apart.
  int layers(int wanted) const { return is_flat() ? 1 : wanted; }
  /// Depth of layer k of so many, from the top; of one, the middle.
  double layer_z(int k, int layers) const;

  /// How far one of the three angles goes, either way.
  double tilt_about(int axis) const { return tilts_about[static_cast<std::size_t>(axis)] ? max_tilt : 0.0; }

  /// Whether a place lies in the cylinder, or within `slack` (mm) of it.
  bool contains(const Eigen::Vector3d& place, double slack) const;

  /// Point on the axis-parallel circle of a layer: azimuth in rad from x towards y.
  static Eigen::Vector3d on_circle(double circle_radius, double azimuth, double z);

  /// Level, and tilted as far as it goes: about each axis that is free, both ways, and about all of them.
  std::vector<Eigen::Vector3d> tilts() const;

  /// Poses on both rims at the extreme and middle rotations and at all tilts: where reach is worst.
  std::vector<Pose> rim(int points_per_circle) const;
};

}  // namespace paracal
