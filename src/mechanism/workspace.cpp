#include "paracal/mechanism/workspace.hpp"

#include <cmath>
#include <numbers>

namespace paracal {

double Workspace::layer_z(int k, int layers) const {
  return top_z - height * (layers > 1 ? static_cast<double>(k) / (layers - 1) : 0.5);
}

bool Workspace::contains(const Eigen::Vector3d& place, double slack) const {
  return place.head<2>().norm() <= radius + slack && place.z() <= top_z + slack && place.z() >= top_z - height - slack;
}

Eigen::Vector3d Workspace::on_circle(double circle_radius, double azimuth, double z) {
  return {circle_radius * std::cos(azimuth), circle_radius * std::sin(azimuth), z};
}

std::vector<Eigen::Vector3d> Workspace::tilts() const {
  std::vector<Eigen::Vector3d> all{Eigen::Vector3d::Zero()};
  if (max_tilt == 0.0) return all;
  const unsigned held = (tilts_about[0] ? 0U : 1U) | (tilts_about[1] ? 0U : 2U) | (tilts_about[2] ? 0U : 4U);
  for (int axis = 0; axis < 3; ++axis) {
    if (!tilts_about[static_cast<std::size_t>(axis)]) continue;
    all.emplace_back(max_tilt * Eigen::Vector3d::Unit(axis));
    all.emplace_back(-max_tilt * Eigen::Vector3d::Unit(axis));
  }
  for (unsigned corner = 0; corner < 8 && all.size() > 3; ++corner) {  // about one axis both corners are there already
    if ((corner & held) != 0) continue;
    const auto angle = [&](int axis) { return (corner >> axis & 1U) != 0 ? -max_tilt : tilt_about(axis); };
    all.emplace_back(angle(0), angle(1), angle(2));
  }
  return all;
}

std::vector<Pose> Workspace::rim(int points_per_circle) const {
  std::vector<Pose> poses;
  for (int layer = 0; layer < layers(2); ++layer) {
    const double z = layer_z(layer, layers(2));
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
