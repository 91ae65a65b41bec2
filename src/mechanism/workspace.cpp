#include "paracal/mechanism/workspace.hpp"

#include <cmath>
#include <numbers>

namespace paracal {

bool Workspace::contains(const Eigen::Vector3d& place, double slack) const {
  return place.head<2>().norm() <= radius + slack && place.z() <= top_z + slack && place.z() >= top_z - height - slack;
}

Eigen::Vector3d Workspace::on_circle(double circle_radius, double azimuth, double z) {
  return {circle_radius * std::cos(azimuth), circle_radius * std::sin(azimuth), z};
}

std::vector<Eigen::Vector3d> Workspace::tilts() const {
  std::vector<Eigen::Vector3d> all{Eigen::Vector3d::Zero()};
  if (max_tilt == 0.0) return all;
  for (int axis = 0; axis < 3; ++axis) {
    all.emplace_back(max_tilt * Eigen::Vector3d::Unit(axis));
    all.emplace_back(-max_tilt * Eigen::Vector3d::Unit(axis));
  }
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto angle = [&](unsigned axis) { return (corner >> axis & 1U) != 0 ? -max_tilt : max_tilt; };
    all.emplace_back(angle(0), angle(1), angle(2));
  }
  return all;
}

std::vector<Pose> Workspace::rim(int points_per_circle) const {
  std::vector<Pose> poses;
  for (const double z : {top_z, top_z - height}) {
    for (const double rotation : {min_rotation, 0.5 * (min_rotation + max_rotation), max_rotation}) {
      for (int k = 0; k < points_per_circle; ++k) {
        const double azimuth = 2.0 * std::numbers::pi * k / points_per_circle;
        for (const Eigen::Vector3d& tilt : tilts()) poses.push_back({on_circle(radius, azimuth, z), rotation, tilt});
      }
    }
  }
  return poses;
}

}  // namespace paracal
