#include "paracal/calibration/controller_joints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "controller_comparison.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/error.hpp"

namespace paracal {
namespace {

using detail::Comparison, detail::ControllerSuspect, detail::explain, detail::Explained, detail::nominal_joints,
    detail::shown_by, detail::slopes;

/// Joints that differ by so many roundings are told apart in a display.
constexpr double kTold = 5.0;

/// To whole mm, as somebody enters them; where guides hold z it stays.
Eigen::Vector3d rounded(const Workspace& workspace, const Eigen::Vector3d& place) {
  constexpr double kSmall = 50.0;  // mm: a smaller workspace is not to lose its shape
  if (workspace.radius < kSmall) return place;
  Eigen::Vector3d whole = place.array().round();
  if (workspace.is_flat()) whole.z() = place.z();
  return whole;
}

/// Poses at which controllers that differ show it: first those that no symmetry of the limbs repeats, at the wall and
/// half way to it, then others.
std::vector<Pose> telling_poses(const Robot& robot) {
  constexpr int kAround = 8;
  constexpr double kAside = 0.3;  // rad
  std::vector<Pose> poses;
  const Workspace& workspace = robot.workspace();
  const auto rotation = 0.5 * (workspace.min_rotation + workspace.max_rotation);
  const auto add = [&](const Pose& pose) {
    if (nominal_joints(robot, pose).allFinite()) poses.push_back(pose);
  };
  for (const double share : {1.0, 0.5}) {
    for (int k = 0; k < kAround; ++k) {
      const double azimuth = kAside + 2.0 * std::numbers::pi * k / kAround;
      for (const double depth : {0.2, 0.8}) add({rounded(workspace, workspace.at(share, azimuth, depth)), rotation});
    }
  }
  for (const Pose& one : workspace.rim(kAround)) add(one);
  for (const ComparisonPose& one : comparison_poses(robot)) poses.push_back(one.pose);
  return poses;
}

/// How many roundings apart two explanations have the joints of a pose; 0 where either does not reach it.
double apart(const Explained& one, const Explained& other, const Pose& pose, const Joints& tolerance) {
  const Joints difference = one.joints(pose) - other.joints(pose);
  return difference.allFinite() ? difference.cwiseQuotient(tolerance).cwiseAbs().maxCoeff() : 0.0;
}

/// Explanations that no pose tells apart, as one: "base radius 220.00 mm instead of 210 mm (or plate radius
/// 45.00 mm instead of 55 mm, which gives the same joints)".
std::vector<Explained> merged(const std::vector<Explained>& all, const std::vector<Pose>& poses,
                              const Joints& tolerance) {
  std::vector<Explained> groups;
  for (const Explained& one : all) {
    const auto same = std::ranges::find_if(groups, [&](const Explained& group) {
      return std::ranges::all_of(poses, [&](const Pose& pose) { return apart(one, group, pose, tolerance) < kTold; });
    });
    if (same == groups.end()) {
      groups.push_back(one);
    } else {
      same->text += fmt::format(" (or {}, which gives the same joints)", one.text);
      same->unknowns = std::min(same->unknowns, one.unknowns);
    }
  }
  return groups;
}

/// The pose that tells most pairs of explanations apart, and these most clearly.
std::optional<Pose> deciding_pose(const std::vector<Explained>& groups, const std::vector<Pose>& poses,
                                  const Joints& tolerance) {
  std::optional<Pose> best;
  std::pair<int, double> most{0, 0.0};
  for (const Pose& pose : poses) {
    std::pair<int, double> told{0, HUGE_VAL};
    for (std::size_t one = 0; one < groups.size(); ++one) {
      for (std::size_t other = one + 1; other < groups.size(); ++other) {
        const double distance = apart(groups[one], groups[other], pose, tolerance);
        told.first += distance >= kTold ? 1 : 0;
        told.second = std::min(told.second, distance);
      }
    }
    if (told.first == 0 || told <= most) continue;
    most = told;
    best = pose;
  }
  return best;
}

/// Of poses the one farthest from all that were compared.
Pose another_pose(const std::vector<Pose>& poses, const std::vector<DisplayedJoints>& displayed) {
  const auto distance = [&](const Pose& pose) {
    double nearest = HUGE_VAL;
    for (const DisplayedJoints& one : displayed)
      nearest = std::min(nearest, (pose.position - one.pose.position).norm());
    return nearest;
  };
  return *std::ranges::max_element(poses, {}, distance);
}

/// @param besides  what stands before each explanation.
void add_explanations(const Robot& robot, const std::vector<DisplayedJoints>& displayed, std::string_view besides,
                      ControllerCheck& check) {
  const Comparison comparison(robot, displayed);
  const std::vector<ControllerSuspect> suspects = detail::controller_suspects(robot);
  std::vector<Explained> explained;
  for (const ControllerSuspect& one : suspects) {
    const auto is_case_of = [&](const Explained& e) {  // along z is a case of anywhere
      return e.suspected->is_origin && e.suspected->unknowns < one.unknowns;
    };
    if (one.is_origin && std::ranges::any_of(explained, is_case_of)) continue;
    if (auto found = explain(comparison, one)) explained.push_back(std::move(*found));
  }
  const std::vector<Pose> poses = telling_poses(robot);
  const Joints tolerance = comparison.tolerance();
  const std::vector<Explained> groups = merged(explained, poses, tolerance);
  for (const Explained& one : groups) check.explanations.push_back(fmt::format("{}{}", besides, one.text));
  check.deciding = deciding_pose(groups, poses, tolerance);
  if (groups.size() != 1) return;
  const std::size_t readings = displayed.size() * robot.limb_count();
  check.is_named = readings > static_cast<std::size_t>(groups.front().unknowns);
  if (!check.is_named) check.deciding = another_pose(poses, displayed);
}

/// How clearly the joints at each pose show that a controller differs by a noticeable value, in roundings; HUGE_VAL
/// where it or the robot does not reach the pose.
std::vector<double> clearness(const Robot& robot, const std::vector<DisplayedJoints>& at,
                              const ControllerSuspect& suspected) {
  const Comparison comparison(robot, at);
  const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
  Eigen::MatrixXd changes;
  if (suspected.unknowns > 0) {
    changes = suspected.noticeable * slopes(comparison, suspected, Eigen::VectorXd::Zero(suspected.unknowns));
  } else {
    const auto right = [&](const Pose& pose) { return nominal_joints(robot, pose); };
    changes = comparison.residuals(suspected, {}) - comparison.residuals(right);
  }
  std::vector<double> clear;
  for (Eigen::Index row = 0; row < changes.rows(); row += limbs) {
    const Eigen::MatrixXd change = changes.middleRows(row, limbs);
    clear.push_back(change.allFinite() ? shown_by(change) : HUGE_VAL);
  }
  return clear;
}

/// What joints that agree would not show, although joints at another pose would; and the pose that shows most of it.
void add_unseen(const Robot& robot, const std::vector<DisplayedJoints>& displayed, ControllerCheck& check) {
  const std::vector<Pose> poses = telling_poses(robot);
  std::vector<DisplayedJoints> others(poses.size(), displayed.front());
  for (std::size_t k = 0; k < poses.size(); ++k) others[k].pose = poses[k];
  const auto is_clear = [](double roundings) { return roundings >= kTold && roundings < HUGE_VAL; };
  std::vector<int> shows(poses.size(), 0);
  for (const ControllerSuspect& one : detail::controller_suspects(robot)) {
    if (std::ranges::any_of(clearness(robot, displayed, one), is_clear)) continue;
    const std::vector<double> clear = clearness(robot, others, one);
    if (std::ranges::none_of(clear, is_clear)) continue;
    for (std::size_t k = 0; k < clear.size(); ++k) shows[k] += is_clear(clear[k]) ? 1 : 0;
    if (std::ranges::find(check.unseen, one.name) == check.unseen.end()) check.unseen.push_back(one.name);
  }
  if (check.unseen.empty()) return;
  check.deciding = poses[static_cast<std::size_t>(std::ranges::max_element(shows) - shows.begin())];
}

/// Poses from all of a table, one that is to be among them first: as many as tell what can be told.
std::vector<DisplayedJoints> enough(const std::vector<DisplayedJoints>& displayed, std::size_t first) {
  constexpr std::size_t kEnough = 100;
  std::vector<DisplayedJoints> some{displayed[first]};
  const std::size_t step = 1 + (displayed.size() - 1) / kEnough;
  for (std::size_t k = 0; k < displayed.size(); k += step) {
    if (k != first) some.push_back(displayed[k]);
  }
  return some;
}

/// As a controller that counts its joints the other way means them.
std::vector<DisplayedJoints> turned_round(std::vector<DisplayedJoints> displayed) {
  for (DisplayedJoints& one : displayed) one.joints = -one.joints;
  return displayed;
}

void require_joints(const Robot& robot, const std::vector<DisplayedJoints>& displayed) {
  if (displayed.empty()) throw InvalidArgument("controller joints: expected at least one pose, got none");
  const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
  for (const DisplayedJoints& one : displayed) {
    if (one.joints.size() == limbs && one.rounding.size() == limbs) continue;
    throw InvalidArgument(
        fmt::format("controller joints at \"{}\": expected {}, got {}", one.name, limbs, one.joints.size()));
  }
}

}  // namespace

ControllerCheck check_controller(const Robot& robot, const std::vector<DisplayedJoints>& displayed) {
  require_joints(robot, displayed);
  const Comparison comparison(robot, displayed);
  const auto expected = [&](const DisplayedJoints& one) { return believed_joints(robot, {one.name, one.pose}); };
  ControllerCheck check{.compared = displayed.size()};
  const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
  std::size_t row = 0;
  Eigen::VectorXd left(limbs * static_cast<Eigen::Index>(displayed.size()));
  left = comparison.residuals([&](const Pose&) { return expected(displayed[row++]); });
  for (std::size_t k = 0; k < displayed.size() && check.agrees(); ++k) {
    Eigen::Index worst = 0;
    const double most = left.segment(limbs * static_cast<Eigen::Index>(k), limbs).cwiseAbs().maxCoeff(&worst);
    if (most <= 1.0) continue;
    check.differs = k;
    check.limb = static_cast<std::size_t>(worst);
    check.expected = expected(displayed[k])(worst);
  }
  if (check.agrees()) {
    add_unseen(robot, enough(displayed, 0), check);
    return check;
  }
  const std::vector<DisplayedJoints> some = enough(displayed, *check.differs);
  add_explanations(robot, some, "", check);
  if (check.explanations.empty()) {
    add_explanations(robot, turned_round(some), "joints with the opposite sign, and ", check);
  }
  return check;
}

std::vector<ComparisonPose> comparison_poses(const Robot& robot) {
  const Workspace& workspace = robot.workspace();
  const Eigen::Vector3d home = workspace.centre();
  const auto rim = [&](int axis) { return Pose{home + workspace.half_width(axis) * Eigen::Vector3d::Unit(axis)}; };
  std::vector<ComparisonPose> poses{{"home", Pose{home}, {}}, {"rim along x", rim(0), {}}, {"rim along y", rim(1), {}}};
  for (ComparisonPose& one : poses) one.joints = believed_joints(robot, {one.name, one.pose});
  return poses;
}

}  // namespace paracal
