#include "sticking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "numerics/median.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

/// A visit about the median visit of its pose, in standard deviations of its readings.
struct VisitOff {
  Eigen::VectorXd off;
  Eigen::MatrixXd by_joint;
};

/// Of poses with at least three visits by points.
std::vector<VisitOff> visits_off(const StageFit& fit) {
  constexpr std::size_t kFewest = 3;
  constexpr Eigen::Index kCoordinates = 3;  // a length by itself lies along every joint
  const Observation& observation = fit.observation();
  const Eigen::VectorXd& unknowns = fit.fit().parameters;
  const auto states = observation.stations(unknowns);
  const auto joints = static_cast<Eigen::Index>(observation.robot().limb_count());
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<VisitOff>> poses;
  for (const Group& group : observation.groups()) {
    if (group.is_relative() || group.at_wrong_pose) continue;
    Eigen::MatrixXd rows, by_joint;
    observation.rows(group, *states, unknowns, rows, &by_joint);
    if (rows.rows() < kCoordinates || observation.series_of(group).follows_gaps()) continue;
    poses[{group.series, group.station}].push_back(
        {rows.rightCols<1>().topRows(kCoordinates), by_joint.topLeftCorner(kCoordinates, joints)});
  }
  std::vector<VisitOff> all;
  for (auto& [pose, visits] : poses) {
    if (visits.size() < kFewest) continue;
    std::vector<Eigen::Vector3d> each;
    for (const VisitOff& one : visits) each.emplace_back(one.off);
    const Eigen::Vector3d middle = median(each);
    for (VisitOff& one : visits) {
      one.off -= middle;
      all.push_back(std::move(one));
    }
  }
  return all;
}

/// How far a joint would have to stop elsewhere.
double along(const VisitOff& one, Eigen::Index joint) {
  const auto h = one.by_joint.col(joint);
  return h.squaredNorm() > 0.0 ? h.dot(one.off) / h.squaredNorm() : 0.0;
}

}  // namespace

bool StickingJoint::may_be_often() const {
  constexpr double kLeftOut = 0.05;
  const auto count = static_cast<double>(stuck);
  return count + 2.0 * std::sqrt(count) + 2.0 > kLeftOut * static_cast<double>(visits);  // about the 97.5 % bound
}

std::optional<StickingJoint> sticking_joint(const StageFit& fit) {
  constexpr double kFar = 3.5;          // times the median size of a visit: of Gaussian visits one in 100
  constexpr std::size_t kFewest = 3;    // two in one direction may be chance
  constexpr double kNowAndThen = 0.15;  // of the visits: one that stands on either side is far at a quarter of them
  constexpr double kExplained = 0.8;    // of the squares
  constexpr double kByChance = 0.106;   // probability that a direction in space is as close to another
  const std::vector<VisitOff> all = visits_off(fit);
  if (all.size() < 2 * kFewest) return std::nullopt;
  std::vector<double> sizes;
  sizes.reserve(all.size());
  for (const VisitOff& one : all) sizes.push_back(one.off.norm());
  const double usual = median(sizes);
  std::vector<const VisitOff*> far;
  for (const VisitOff& one : all) {
    if (one.off.norm() > kFar * usual) far.push_back(&one);
  }
  if (far.size() < kFewest || static_cast<double>(far.size()) > kNowAndThen * static_cast<double>(all.size()))
    return std::nullopt;
  double squares = 0.0;
  for (const VisitOff* one : far) squares += one->off.squaredNorm();
  StickingJoint best{.stuck = far.size(), .visits = all.size()};
  double most = 0.0;
  const Eigen::Index joints = all.front().by_joint.cols();
  for (Eigen::Index joint = 0; joint < joints; ++joint) {
    double explained = 0.0, offsets = 0.0;
    for (const VisitOff* one : far) {
      const double off = along(*one, joint);
      explained += off * off * one->by_joint.col(joint).squaredNorm();
      offsets += off * off;
    }
    if (explained <= most) continue;
    most = explained;
    best.joint = joint;
    best.size = std::sqrt(offsets / static_cast<double>(far.size()));
  }
  if (most < kExplained * squares) return std::nullopt;
  best.probability = 1.0 - static_cast<double>(joints) * std::pow(kByChance, static_cast<double>(far.size()));
  return best;
}

std::string text_of(const StickingJoint& found, const Robot& robot) {
  const Unit unit = joint_unit(robot.actuator());
  return fmt::format(
      "the joint of limb {} sticks: it stood about {:.2g} {} elsewhere at {} of {} visits. U of a single visit {} "
      "this. "
      "Possible causes: friction, a damaged bearing or belt",
      found.joint + 1, to_file_unit(unit, found.size), file_unit(unit), found.stuck, found.visits,
      found.may_be_often() ? "includes" : "does not cover");
}

}  // namespace paracal::detail
