#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "paracal/mechanism/pose.hpp"

namespace paracal {

/// Where the plate works, in mm and rad: a cylinder about z [huang2016, Table 1], a box, or a body of revolution about
/// z between circles. It hangs below the base: z runs from top_z (negative) down to top_z - height. (Table 1's H is the
/// depth of the top; docs/paper-slips.md.) That of a plate on limbs with one rod may stand above it; where guides hold
/// the plate in a plane it is flat, without height.
///
/// Places are said by at(): other code need not know the shape. Make boxes and levels by their functions.
struct Workspace {
  struct Box {
    std::array<double, 2> x{}, y{}, z{};  ///< smallest, largest
  };
  struct Level {
    double z = 0.0, radius = 0.0;
  };
  /// What files call the sizes of a shape: for messages.
  struct Keys {
    const char *radius, *height, *top;
  };

  double radius = 0.0;  ///< of the cylinder around it, about its own axis
  double height = 0.0;
  double top_z = 0.0;
  double min_rotation = 0.0;  ///< of the end-effector; both zero for a rigid plate
  double max_rotation = 0.0;
  double max_tilt = 0.0;  ///< each angle that is free, either way, of a plate on limbs with one rod; 0 of the others
  std::array<bool, 3> tilts_about{true, true, true};  ///< which angles are free; Robot says it
  Eigen::Vector2d axis = Eigen::Vector2d::Zero();     ///< x, y of its vertical axis
  std::optional<Box> box = {};                        ///< the shape, if it is a box
  std::vector<Level> levels = {};                     ///< circles from the top down with cones between; else a cylinder

  static Workspace of_box(const Box& box);
  static Workspace of_levels(std::vector<Level> levels);
  /// A cylinder of at most this radius and height below its centre, with the same angles.
  Workspace about_centre(double size) const;

  Keys keys() const;
  /// @throws InvalidArgument for ranges that are none, and levels that do not go down; naming the key.
  void check_shape() const;

  /// P_0: the home position of calibrations.
  Eigen::Vector3d centre() const { return {axis.x(), axis.y(), top_z - 0.5 * height}; }

  /// The place at a share of the distance from the axis to the wall, in a direction, and at a share of the way down.
  /// Azimuth in rad from x towards y; of a box 45 deg is its corner, and each side a quarter turn. Evenly drawn
  /// azimuths and squares of the share are evenly spread over a layer.
  Eigen::Vector3d at(double share, double azimuth, double depth) const;
  /// What at() is given to get there: share, azimuth, depth. Outside of the shape shares may lie outside of [0, 1].
  Eigen::Vector3d shares_of(const Eigen::Vector3d& place) const;
  /// Whether a place lies inside, or within `slack` (mm) of it.
  bool contains(const Eigen::Vector3d& place, double slack) const;
  Eigen::AlignedBox3d bounds() const;
  /// From the centre to the wall along x or y, at that height.
  double half_width(int along) const;
  /// No place is farther from the origin, mm.
  double farthest() const;

  bool is_flat() const { return height == 0.0; }
  /// How many of that many layers lie apart.
  int layers(int wanted) const { return is_flat() ? 1 : wanted; }
  /// Depth of layer k of so many, from the top, for at(); of one, the middle.
  static double layer_depth(int k, int layers) { return layers > 1 ? static_cast<double>(k) / (layers - 1) : 0.5; }
  double layer_z(int k, int layers) const { return top_z - height * layer_depth(k, layers); }
  /// Depths of edges of the wall, top and bottom among them.
  std::vector<double> edge_depths() const;
  /// Azimuths of upright edges of the wall, in increasing order: of a box four, of others none.
  std::vector<double> edge_azimuths() const;
  /// Area of the layer there, relative to that of another.
  double layer_area(double depth) const;

  /// How far one of the three angles goes, either way.
  double tilt_about(int turning) const { return tilts_about[static_cast<std::size_t>(turning)] ? max_tilt : 0.0; }

  /// Point on the axis-parallel circle of a layer: azimuth in rad from x towards y.
  static Eigen::Vector3d on_circle(double circle_radius, double azimuth, double z);

  /// Level, and tilted as far as it goes: about each axis that is free, both ways, and about all of them.
  std::vector<Eigen::Vector3d> tilts() const;

  /// Poses on all level edges at the extreme and middle rotations and at all tilts: where reach is worst. At a share of
  /// the way out.
  std::vector<Pose> rim(int points_per_circle, double share = 1.0) const;

 private:
  double radius_at(double z) const;
};

}  // namespace paracal
