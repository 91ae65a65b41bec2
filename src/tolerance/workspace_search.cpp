#include "workspace_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "optimizer.hpp"
#include "paracal/interruption.hpp"

namespace paracal::detail {
namespace {

constexpr std::size_t kStarts = 6;
constexpr int kMostRefinements = 10;
constexpr double kGain = 1e-6;  // relative, below which the best is not begun anew
constexpr double kStep = 1e-4;  // relative, where the refinement ends: the maximum is flat there or on the surface

/// Share of the way out, azimuth, depth and rotation, each over its range but the azimuth, which may turn freely; then,
/// where the plate tilts, its three angles over max_tilt.
struct Cylindrical {
  const Workspace& workspace;

  double turn() const { return workspace.max_rotation - workspace.min_rotation; }
  bool tilts() const { return workspace.max_tilt > 0.0; }

  Pose pose(const std::vector<double>& x) const {
    Pose pose{workspace.at(x[0], 2.0 * std::numbers::pi * x[1], x[2]), workspace.min_rotation + turn() * x[3]};
    for (int axis = 0; tilts() && axis < 3; ++axis) {
      pose.tilt(axis) = workspace.tilt_about(axis) * x[4 + static_cast<std::size_t>(axis)];
    }
    return pose;
  }

  std::vector<double> coordinates(const Pose& pose) const {
    const Eigen::Vector3d place = workspace.shares_of(pose.position);
    std::vector<double> x{share(place[0]), 0.5 * place[1] / std::numbers::pi, share(place[2]),
                          turn() > 0.0 ? share((pose.rotation - workspace.min_rotation) / turn()) : 0.0};
    for (int axis = 0; tilts() && axis < 3; ++axis) {
      x.push_back(std::clamp(pose.tilt(axis) / workspace.max_tilt, -1.0, 1.0));
    }
    return x;
  }

  std::vector<double> lower() const { return filled({0.0, -2.0, 0.0, 0.0}, -1.0); }
  std::vector<double> upper() const { return filled({1.0, 2.0, 1.0, 1.0}, 1.0); }
  std::vector<double> first_step() const { return filled({0.1, 0.02, 0.1, 0.1}, 0.1); }

 private:
  static double share(double value) { return std::clamp(value, 0.0, 1.0); }

  std::vector<double> filled(std::vector<double> x, double of_tilts) const {
    if (tilts()) x.insert(x.end(), 3, of_tilts);
    return x;
  }
};

ValueAtPose refined(const Cylindrical& coordinates, const ValueAtPose& start,
                    const std::function<double(const Pose&)>& value) {
  const Minimization search{
      .algorithm = Minimization::Algorithm::subplex,
      .objective = [&](const std::vector<double>& x, std::vector<double>&) { return -value(coordinates.pose(x)); },
      .lower = coordinates.lower(),
      .upper = coordinates.upper(),
      .first_step = coordinates.first_step(),
      .step_tolerance = kStep,
      .max_evaluations = 100 * static_cast<int>(coordinates.lower().size())};
  const Minimum end = minimize(search, coordinates.coordinates(start.pose));
  return -end.value > start.value ? ValueAtPose{coordinates.pose(end.x), -end.value} : start;
}

/// Places and attitudes of which one would be refined into the other.
bool are_near(const Pose& one, const Pose& other, const Workspace& workspace) {
  constexpr double kNear = 0.6;  // of the radius: two or three of the grid's azimuths on the rim
  const Eigen::Vector3d way = one.position - other.position;
  return way.head<2>().norm() < kNear * workspace.radius && std::abs(way.z()) <= kNear * workspace.height &&
         one.rotation == other.rotation && one.tilt == other.tilt;
}

/// The largest values of a grid, no two near each other.
/// @param grid  largest first.
std::vector<ValueAtPose> tops_of(const std::vector<ValueAtPose>& grid, const Workspace& workspace) {
  std::vector<ValueAtPose> tops;
  for (const ValueAtPose& one : grid) {
    const auto is_near = [&](const ValueAtPose& top) { return are_near(one.pose, top.pose, workspace); };
    if (std::ranges::none_of(tops, is_near)) tops.push_back(one);
    if (tops.size() == kStarts) break;
  }
  return tops;
}

}  // namespace

ValueAtPose largest_in_workspace(const Robot& robot, const std::function<double(const Pose&)>& value) {
  std::vector<ValueAtPose> grid;
  for (const Pose& pose : polar_grid(robot, {.radii = 5, .azimuths = 24, .layers = 3}, true)) {
    let_interrupt();
    grid.push_back({pose, value(pose)});
  }
  std::ranges::stable_sort(grid, std::greater(), &ValueAtPose::value);
  const std::vector<ValueAtPose> candidates = tops_of(grid, robot.workspace());
  const Cylindrical coordinates{robot.workspace()};
  ValueAtPose best = candidates.front();
  for (const ValueAtPose& start : candidates) {
    const ValueAtPose end = refined(coordinates, start, value);
    if (end.value > best.value) best = end;
  }
  // The search may stop early on the surface of the workspace.
  for (int attempt = 0; attempt < kMostRefinements; ++attempt) {
    const double before = best.value;
    best = refined(coordinates, best, value);
    if (!(best.value > (1.0 + kGain) * before)) break;
  }
  return best;
}

}  // namespace paracal::detail
