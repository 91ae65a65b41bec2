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

/// Gauss between the edges of [0, 1] or of a turn: an integrand is smooth there. Weights are lengths.
std::vector<Node> between_edges(const std::vector<double>& edges, int n) {
  std::vector<Node> nodes;
  for (std::size_t k = 1; k < edges.size(); ++k) {
    const double length = edges[k] - edges[k - 1];
    for (const Node& node : gauss_rule(n, edges[k - 1], edges[k])) nodes.push_back({node.place, length * node.weight});
  }
  return nodes;
}

/// Depths with the share of the volume at each.
std::vector<Node> depth_rule(const Workspace& workspace, int n) {
  if (workspace.is_flat()) return {{0.0, 1.0}};
  std::vector<Node> nodes = between_edges(workspace.edge_depths(), n);
  double volume = 0.0;
  for (Node& node : nodes) volume += node.weight *= workspace.layer_area(node.place);
  for (Node& node : nodes) node.weight /= volume;
  return nodes;
}

/// Evenly spaced, which is best for a wall without edges; else Gauss on each side.
std::vector<Node> azimuth_rule(const Workspace& workspace, int n) {
  std::vector<double> edges = workspace.edge_azimuths();
  std::vector<Node> nodes;
  for (int k = 0; edges.empty() && k < n; ++k) nodes.push_back({2.0 * std::numbers::pi * k / n, 1.0 / n});
  if (edges.empty()) return nodes;
  const int of_a_side = n / static_cast<int>(edges.size());
  edges.push_back(edges.front() + 2.0 * std::numbers::pi);
  nodes = between_edges(edges, of_a_side);
  for (Node& node : nodes) node.weight *= 0.5 / std::numbers::pi;
  return nodes;
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
  const Eigen::Vector3d centre = workspace.centre(), half = 0.5 * workspace.bounds().sizes();
  const auto coordinate = [&](int axis, int k) { return centre[axis] + half[axis] * (2.0 * k / (across - 1) - 1.0); };
  const double rounding = 1e-12 * workspace.radius;
  std::vector<WeightedPose> points;
  layers = workspace.layers(layers);
  for (int k = 0; k < layers; ++k) {
    for (int i = 0; i < across; ++i) {
      for (int j = 0; j < across; ++j) {
        const Eigen::Vector3d place(coordinate(0, i), coordinate(1, j), workspace.layer_z(k, layers));
        if (workspace.contains(place, rounding)) points.push_back({{place, 0.0}, 0.0});
      }
    }
  }
  for (WeightedPose& point : points) point.weight = 1.0 / static_cast<double>(points.size());
  return points;
}

std::vector<WeightedPose> volume_rule(const Robot& robot, int level, bool all_rotations) {
  const Workspace& workspace = robot.workspace();
  const int n = 1 << level;
  const std::vector<Node> shares = gauss_rule(4 * n, 0.0, 1.0);
  const std::vector<Node> azimuths = azimuth_rule(workspace, 12 * n);
  const std::vector<Node> depths = depth_rule(workspace, 2 * n);
  const std::vector<WeightedPose> turned = orientation_rule(workspace, 2 * n, all_rotations);
  std::vector<WeightedPose> points;
  points.reserve(shares.size() * depths.size() * turned.size() * azimuths.size());
  for (const Node& depth : depths) {
    for (const Node& share : shares) {
      let_interrupt();
      const double ring = 2.0 * share.weight * share.place * depth.weight;
      for (const Node& azimuth : azimuths) {
        const Eigen::Vector3d place = workspace.at(share.place, azimuth.place, depth.place);
        for (const WeightedPose& one : turned) {
          points.push_back({moved(one.pose, place), ring * azimuth.weight * one.weight});
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
    const double depth = Workspace::layer_depth(k, layers);
    for (const Pose& turned : extreme_orientations(workspace, all_rotations)) {
      poses.push_back(moved(turned, workspace.at(0.0, 0.0, depth)));
      for (int i = 1; i <= grid.radii; ++i) {
        for (int j = 0; j < grid.azimuths; ++j) {
          const double azimuth = 2.0 * std::numbers::pi * j / grid.azimuths;
          const double share = static_cast<double>(i) / grid.radii;
          poses.push_back(moved(turned, workspace.at(share, azimuth, depth)));
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
