#include "paracal/tolerance/workspace_samples.hpp"

#include <array>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>
#include <numbers>

#include "paracal/interruption.hpp"

namespace paracal {
namespace {

struct Node {
  double place = 0.0, weight = 0.0;
};

/// Gauss and Legendre's rule of n points on [low, high], weights adding up to 1.
std::vector<Node> gauss_rule(int n, double low, double high) {
  std::vector<Node> nodes;
  const auto add = [&](double x) {
    const double slope = boost::math::legendre_p_prime(n, x);
    nodes.push_back({low + 0.5 * (high - low) * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)});
  };
  for (const double zero : boost::math::legendre_p_zeros<double>(n)) {
    add(zero);
    if (zero > 0.0) add(-zero);
  }
  return nodes;
}

std::vector<Node> rotation_rule(const Workspace& workspace, int n) {
  if (workspace.min_rotation == workspace.max_rotation) return {{0.0, 1.0}};
  return gauss_rule(n, workspace.min_rotation, workspace.max_rotation);
}

/// One of the three angles.
std::vector<Node> tilt_rule(const Workspace& workspace, int axis, int n) {
  const double largest = workspace.tilt_about(axis);
  return largest == 0.0 ? std::vector<Node>{{0.0, 1.0}} : gauss_rule(n, -largest, largest);
}

std::vector<Node> height_rule(const Workspace& workspace, int n) {
  if (workspace.is_flat()) return {{workspace.top_z, 1.0}};
  return gauss_rule(n, workspace.top_z - workspace.height, workspace.top_z);
}

/// Poses at the origin, each with its share.
std::vector<WeightedPose> orientation_rule(const Workspace& workspace, int n, bool all_rotations) {
  if (!all_rotations) return {{.pose = {Eigen::Vector3d::Zero()}, .weight = 1.0}};
  std::vector<WeightedPose> turned;
  const std::array tilts{tilt_rule(workspace, 0, n), tilt_rule(workspace, 1, n), tilt_rule(workspace, 2, n)};
  for (const Node& rotation : rotation_rule(workspace, n)) {
    for (const Node& x : tilts[0]) {
      for (const Node& y : tilts[1]) {
        for (const Node& z : tilts[2]) {
          turned.push_back({{Eigen::Vector3d::Zero(), rotation.place, {x.place, y.place, z.place}},
                            rotation.weight * x.weight * y.weight * z.weight});
        }
      }
    }
  }
  return turned;
}

/// Poses at the origin.
std::vector<Pose> extreme_orientations(const Workspace& workspace, bool all_rotations) {
  if (!all_rotations) return {{Eigen::Vector3d::Zero()}};
  std::vector<double> rotations{0.0};
  if (workspace.min_rotation != workspace.max_rotation) {
    rotations = {workspace.min_rotation, 0.0, workspace.max_rotation};
  }
  std::vector<Pose> turned;
  for (const double rotation : rotations) {
    for (const Eigen::Vector3d& tilt : workspace.tilts()) turned.push_back({Eigen::Vector3d::Zero(), rotation, tilt});
  }
  return turned;
}

Pose moved(Pose pose, const Eigen::Vector3d& place) {
  pose.position = place;
  return pose;
}

}  // namespace

std::vector<WeightedPose> cartesian_grid(const Robot& robot, int across, int layers) {
  const Workspace& workspace = robot.workspace();
  const auto coordinate = [&](int k) { return workspace.radius * (2.0 * k / (across - 1) - 1.0); };
  const double reach = workspace.radius * (1.0 + 1e-12);
  std::vector<WeightedPose> points;
  layers = workspace.layers(layers);
  for (int k = 0; k < layers; ++k) {
    for (int i = 0; i < across; ++i) {
      for (int j = 0; j < across; ++j) {
        const double x = coordinate(i), y = coordinate(j);
        if (std::hypot(x, y) <= reach) points.push_back({{{x, y, workspace.layer_z(k, layers)}, 0.0}, 0.0});
      }
    }
  }
  for (WeightedPose& point : points) point.weight = 1.0 / static_cast<double>(points.size());
  return points;
}

std::vector<WeightedPose> cylinder_rule(const Robot& robot, int level, bool all_rotations) {
  const Workspace& workspace = robot.workspace();
  const int n = 1 << level, azimuths = 12 * n;
  const std::vector<Node> radii = gauss_rule(4 * n, 0.0, workspace.radius);
  const std::vector<Node> heights = height_rule(workspace, 2 * n);
  const std::vector<WeightedPose> turned = orientation_rule(workspace, 2 * n, all_rotations);
  std::vector<WeightedPose> points;
  points.reserve(radii.size() * heights.size() * turned.size() * static_cast<std::size_t>(azimuths));
  for (const Node& height : heights) {
    for (const Node& radius : radii) {
      let_interrupt();
      const double ring = 2.0 * radius.weight * radius.place / workspace.radius / azimuths;
      for (int k = 0; k < azimuths; ++k) {
        const double azimuth = 2.0 * std::numbers::pi * k / azimuths;
        const Eigen::Vector3d position = Workspace::on_circle(radius.place, azimuth, height.place);
        for (const WeightedPose& one : turned) {
          points.push_back({moved(one.pose, position), ring * height.weight * one.weight});
        }
      }
    }
  }
  return points;
}

std::vector<Pose> polar_grid(const Robot& robot, const PolarGrid& grid, bool all_rotations) {
  const Workspace& workspace = robot.workspace();
  std::vector<Pose> poses;
  const int layers = workspace.layers(grid.layers);
  for (int k = 0; k < layers; ++k) {
    const double z = workspace.layer_z(k, layers);
    for (const Pose& turned : extreme_orientations(workspace, all_rotations)) {
      poses.push_back(moved(turned, {0.0, 0.0, z}));
      for (int i = 1; i <= grid.radii; ++i) {
        for (int j = 0; j < grid.azimuths; ++j) {
          const double azimuth = 2.0 * std::numbers::pi * j / grid.azimuths;
          poses.push_back(moved(turned, Workspace::on_circle(workspace.radius * i / grid.radii, azimuth, z)));
        }
      }
    }
  }
  return poses;
}

std::vector<Pose> surface_poses(const Robot& robot) {
  return polar_grid(robot, {.radii = 1, .azimuths = 48, .layers = 3}, true);
}

}  // namespace paracal
