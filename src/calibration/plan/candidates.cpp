#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/plan/tolerated_reach.hpp"
#include "calibration/readings/length_model.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/error.hpp"
#include "paracal/interruption.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

/// To whole mm where that does not leave the workspace, or the plane: poses that someone may type.
Eigen::Vector3d to_millimetres(const Eigen::Vector3d& place, const Workspace& workspace) {
  const auto inward = [&](int k) { return place[k] > workspace.axis[k] ? std::floor(place[k]) : std::ceil(place[k]); };
  const Eigen::Vector3d whole(inward(0), inward(1), workspace.is_flat() ? place.z() : std::round(place.z()));
  return workspace.contains(whole, 0.0) ? whole : place;
}

/// Anywhere in the workspace; on its wall, its top or its bottom, and at the ends of the rotation, half of the time.
Pose draw_pose(const Workspace& workspace, RandomStream& random) {
  const auto coin = [&] { return random.uniform() < 0.5; };
  const auto between_or_end = [&](double low, double high) {
    if (coin()) return low + (high - low) * random.uniform();
    return coin() ? low : high;
  };
  const double azimuth = 2.0 * std::numbers::pi * random.uniform();
  const double share = coin() ? 1.0 : std::sqrt(random.uniform());
  const double depth = between_or_end(1.0, 0.0);
  const double rotation = between_or_end(workspace.min_rotation, workspace.max_rotation);
  const auto whole_degrees = [](double angle) { return to_radians(std::trunc(to_degrees(angle))); };
  Pose pose{to_millimetres(workspace.at(share, azimuth, depth), workspace), whole_degrees(rotation)};
  for (int axis = 0; axis < 3; ++axis) {
    const double largest = workspace.tilt_about(axis);
    if (largest > 0.0) pose.tilt(axis) = whole_degrees(between_or_end(-largest, largest));
  }
  return pose;
}

/// The nominal robot gets there and holds its plate.
bool holds(const Robot& robot, const Pose& pose) {
  if (robot.is_level()) return error_model(robot, pose).ok();
  const InverseResult nominal = inverse(robot.nominal(), pose);
  return nominal.ok() && exact_jacobian(robot.nominal(), plate_at(robot.nominal(), pose), nominal.joints).ok;
}

/// So that it can be typed.
Eigen::Vector3d to_micrometres(const Eigen::Vector3d& position) { return (position * 1e3).array().round() / 1e3 + 0.0; }

double largest_motion(const Joints& from, const Joints& to) { return (to - from).cwiseAbs().maxCoeff(); }

/// A closed way through points, as their order.
double length_of(const std::vector<Joints>& joints) {
  double length = largest_motion(joints.back(), joints.front());
  for (std::size_t k = 1; k < joints.size(); ++k) length += largest_motion(joints[k - 1], joints[k]);
  return length;
}

/// Reverses the piece of the way that shortens it most often, until none does.
void two_opt(std::vector<std::size_t>& order, const std::vector<Joints>& joints) {
  const auto step = [&](std::size_t a, std::size_t b) { return largest_motion(joints[order[a]], joints[order[b]]); };
  const std::size_t n = order.size();
  for (bool better = true; better;) {
    better = false;
    for (std::size_t a = 0; a + 2 < n; ++a) {
      let_interrupt();
      for (std::size_t b = a + 2; b < n; ++b) {
        const std::size_t after = (b + 1) % n;
        if (step(a, b) + step(a + 1, after) > step(a, a + 1) + step(b, after) - 1e-9) continue;
        std::reverse(order.begin() + static_cast<std::ptrdiff_t>(a) + 1,
                     order.begin() + static_cast<std::ptrdiff_t>(b) + 1);
        better = true;
      }
    }
  }
}

std::vector<std::size_t> nearest_neighbours(const std::vector<Joints>& joints) {
  std::vector<std::size_t> order{0}, left;
  for (std::size_t k = 1; k < joints.size(); ++k) left.push_back(k);
  while (!left.empty()) {
    const auto next = std::ranges::min_element(
        left, {}, [&](std::size_t k) { return largest_motion(joints[order.back()], joints[k]); });
    order.push_back(*next);
    left.erase(next);
  }
  return order;
}

}  // namespace

bool Visibility::sees(const Pose& pose) const {
  const Eigen::AngleAxisd turn(turns_per_phi(mount) * pose.rotation, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d direction = turn * facing.normalized();
  return direction.dot((tracker - pose.position).normalized()) >= std::cos(half_angle);
}

std::vector<Station> candidate_stations(const Robot& robot, int count, std::uint64_t seed,
                                        const std::optional<Visibility>& visibility) {
  constexpr int kLargestTries = 1000;  // a candidate
  RandomStream random(seed);
  const detail::ToleratedReach reaches(robot);
  std::vector<Station> stations{{"P0", {robot.workspace().centre(), 0.0}}};
  for (long tries = 0; static_cast<int>(stations.size()) < count && tries < long{kLargestTries} * count; ++tries) {
    let_interrupt();
    const Pose pose = draw_pose(robot.workspace(), random);
    if (visibility && !visibility->sees(pose)) continue;
    if (!holds(robot, pose) || !reaches(pose)) continue;  // too near to the rim of reach, or singular
    stations.push_back({fmt::format("C{}", stations.size()), pose});
  }
  return stations;
}

std::vector<Station> within_range(const Robot& robot, const std::vector<Station>& candidates,
                                  const PlannedReadings& readings, const LengthRange& range) {
  if (readings.measurand != Measurand::lengths || !(range.shortest < range.longest)) {
    throw InvalidArgument(
        fmt::format("pose selection: expected a range of lengths, got {} to {} mm", range.shortest, range.longest));
  }
  const LengthSeries series{.name = {}, .kind = readings.length, .at = readings.at};
  const detail::LengthModel& model = detail::length_model(readings.length);
  const detail::SetUp set_up = model.typical(robot, series);
  std::vector<double> lengths;
  lengths.reserve(candidates.size());
  for (const Station& one : candidates) lengths.push_back(model.shown(one.commanded.position, set_up, series).length);
  const auto [least, most] = std::ranges::minmax(lengths);
  const detail::ToleratedReach reaches(robot);
  std::vector<Station> kept;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    Station moved = candidates[k];
    Eigen::Vector3d& place = moved.commanded.position;
    const double share = most > least ? (lengths[k] - least) / (most - least) : 0.5;
    const double wanted = range.shortest + share * (range.longest - range.shortest);
    place += (wanted - lengths[k]) * model.shown(place, set_up, series).by_place.transpose();  // a unit vector
    place = to_micrometres(place);
    constexpr double kRounded = 1e-3;  // mm
    if (!robot.workspace().contains(place, kRounded) || !holds(robot, moved.commanded)) continue;
    if (reaches(moved.commanded)) kept.push_back(moved);
  }
  return kept;
}

double shorten_way(const Robot& robot, std::vector<Station>& stations) {
  if (stations.size() < 2) return 0.0;
  std::vector<Joints> joints;
  joints.reserve(stations.size());
  for (const Station& station : stations) joints.push_back(believed_joints(robot, station));
  std::vector<std::size_t> order = nearest_neighbours(joints);
  if (order.size() > 3) two_opt(order, joints);
  std::rotate(order.begin(), std::ranges::find(order, std::size_t{0}), order.end());
  std::vector<Station> ordered;
  std::vector<Joints> way;
  for (const std::size_t k : order) {
    ordered.push_back(stations[k]);
    way.push_back(joints[k]);
  }
  stations = std::move(ordered);
  return length_of(way);
}

}  // namespace paracal
