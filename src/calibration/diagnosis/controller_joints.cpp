#include "paracal/calibration/controller_joints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>
#include <utility>

#include "dimensions.hpp"
#include "numerics/dense.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

using detail::Dimension;

/// mm at the elbow that the single-precision arithmetic of a controller may lose: 2^-24 of a metre, squared and
/// subtracted a few times.
constexpr double kArithmetic = 1e-4;
/// A fitted dimension spreads the rounding of one joint over others: no joint is off by more than its own and as much.
constexpr double kFitted = 2.0;
/// Joints that differ by so many roundings are told apart in a display.
constexpr double kTold = 5.0;
/// No dimension of a robot file that was meant for the machine is off by more of itself, or of the base's radius.
constexpr double kFarthest = 0.3;

/// Joints of a controller at a pose, mm or rad; NaN where it does not reach it.
using PoseJoints = std::function<Joints(const Pose&)>;

/// A controller that differs from the robot in one thing.
struct Suspected {
  int unknowns = 1;
  bool is_origin = false;
  std::function<PoseJoints(const Eigen::VectorXd& values)> controller;
  std::function<bool(const Eigen::VectorXd& values)> is_believable;
  /// @param resolution  of the values, by the rounding of the joints.
  std::function<std::string(const Eigen::VectorXd& values, double resolution)> text;
};

/// What a fit to the displayed joints leaves of it.
struct Explained {
  const Suspected* suspected = nullptr;
  PoseJoints joints;
  std::string text;
};

Joints nowhere(const Robot& robot) {
  return Joints::Constant(static_cast<Eigen::Index>(robot.limb_count()), std::nan(""));
}

Joints nominal_joints(const Robot& robot, const Pose& pose) {
  const InverseResult found = inverse(robot.nominal(), pose);
  return found.ok() ? found.joints : nowhere(robot);
}

/// "720.00": as many decimals as the joints show, two of mm and three of deg at most.
std::string shown(double value, double resolution, int most) {
  const int decimals = resolution > 0.0 ? static_cast<int>(std::ceil(-std::log10(resolution))) : most;
  return fmt::format("{:.{}f}", value, std::clamp(decimals, 0, most));
}

std::string shown_length(double value, double resolution) { return shown(value, resolution, 2) + " mm"; }
std::string shown_angle(double value, double resolution) {
  return shown(to_degrees(value), to_degrees(resolution), 3) + " deg";
}

/// "limb azimuth of limb 2", of "limb_azimuth_deg of limb 2".
std::string in_words(std::string key) {
  for (const std::string_view unit : {"_mm", "_deg"}) {
    if (const std::size_t at = key.find(unit); at != std::string::npos) key.erase(at, unit.size());
  }
  std::ranges::replace(key, '_', ' ');
  return key;
}

Suspected wrong_dimension(const Robot& robot, const Dimension& dimension) {
  const double nominal = now(robot, dimension);
  const auto value = [nominal](const Eigen::VectorXd& values) { return nominal + values(0); };
  return {
      .controller = [&robot, dimension, value](const Eigen::VectorXd& values) -> PoseJoints {
        try {
          return [other = detail::with(robot, dimension, value(values))](const Pose& pose) {
            return nominal_joints(other, pose);
          };
        } catch (const InvalidArgument&) {
          return [&robot](const Pose&) { return nowhere(robot); };  // there is no such robot
        }
      },
      .is_believable = [most = kFarthest *
                               (dimension.angle ? std::numbers::pi : std::max(nominal, robot.geometry().base_radius))](
                           const Eigen::VectorXd& values) { return std::abs(values(0)) <= most; },
      .text =
          [dimension, nominal, value](const Eigen::VectorXd& values, double resolution) {
            const bool angle = dimension.angle;
            return fmt::format("{} {} instead of {:g} {}", in_words(dimension.key),
                               angle ? shown_angle(value(values), resolution) : shown_length(value(values), resolution),
                               angle ? to_degrees(nominal) : nominal, angle ? "deg" : "mm");
          }};
}

bool always(const Eigen::VectorXd&) { return true; }

Suspected other_zero(const Robot& robot) {
  const bool angle = joint_unit(robot.actuator()) == Unit::rad;
  return {.controller = [&robot](const Eigen::VectorXd& values) -> PoseJoints {
            return [&robot, more = values(0)](const Pose& pose) -> Joints {
              return nominal_joints(robot, pose).array() + more;
            };
          },
          .is_believable = always,
          .text =
              [angle](const Eigen::VectorXd& values, double resolution) {
                return fmt::format("the zero of all joints: the controller shows {} more",
                                   angle ? shown_angle(values(0), resolution) : shown_length(values(0), resolution));
              }};
}

Suspected other_sign(const Robot& robot) {
  return {.unknowns = 0,
          .controller = [&robot](const Eigen::VectorXd&) -> PoseJoints {
            return [&robot](const Pose& pose) -> Joints { return -nominal_joints(robot, pose); };
          },
          .is_believable = always,
          .text = [](const Eigen::VectorXd&,
                     double) { return std::string("joints with the opposite sign: multiply them by -1"); }};
}

/// The controller's coordinates begin elsewhere, along z or anywhere.
Suspected other_origin(const Robot& robot, int unknowns) {
  const auto origin = [unknowns](const Eigen::VectorXd& values) -> Eigen::Vector3d {
    return unknowns == 1 ? Eigen::Vector3d(0.0, 0.0, values(0)) : Eigen::Vector3d(values);
  };
  return {.unknowns = unknowns,
          .is_origin = true,
          .controller = [&robot, origin](const Eigen::VectorXd& values) -> PoseJoints {
            return [&robot, at = origin(values)](Pose pose) {
              pose.position += at;
              return nominal_joints(robot, pose);
            };
          },
          .is_believable = always,
          .text =
              [unknowns, origin](const Eigen::VectorXd& values, double resolution) {
                const Eigen::Vector3d at = origin(values);
                if (unknowns == 1)
                  return fmt::format("origin at z {} in the robot file's frame", shown_length(at.z(), resolution));
                return fmt::format("origin at ({}, {}, {}) mm in the robot file's frame", shown(at.x(), resolution, 2),
                                   shown(at.y(), resolution, 2), shown(at.z(), resolution, 2));
              }};
}

/// Displayed minus expected, over the rounding; NaN where some pose is not reached.
class Comparison {
 public:
  Comparison(const Robot& robot, const std::vector<DisplayedJoints>& displayed) : displayed_(displayed) {
    for (const DisplayedJoints& one : displayed) {
      Joints tolerance = one.rounding;
      for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
        tolerance(static_cast<Eigen::Index>(limb)) += kArithmetic / joint_ratio(robot.nominal().limbs[limb]);
      }
      tolerances_.push_back(tolerance);
    }
  }

  Eigen::VectorXd residuals(const PoseJoints& expected) const {
    const Eigen::Index limbs = tolerances_.front().size();
    Eigen::VectorXd all(limbs * static_cast<Eigen::Index>(displayed_.size()));
    for (std::size_t k = 0; k < displayed_.size(); ++k) {
      all.segment(limbs * static_cast<Eigen::Index>(k), limbs) =
          (displayed_[k].joints - expected(displayed_[k].pose)).cwiseQuotient(tolerances_[k]);
    }
    return all;
  }
  Eigen::VectorXd residuals(const Suspected& suspected, const Eigen::VectorXd& values) const {
    return residuals(suspected.controller(values));
  }

  /// The coarsest of each joint.
  Joints tolerance() const {
    Joints coarsest = tolerances_.front();
    for (const Joints& one : tolerances_) coarsest = coarsest.cwiseMax(one);
    return coarsest;
  }

 private:
  const std::vector<DisplayedJoints>& displayed_;
  std::vector<Joints> tolerances_;
};

/// d residuals / d values, by central differences.
Eigen::MatrixXd slopes(const Comparison& comparison, const Suspected& suspected, const Eigen::VectorXd& values) {
  constexpr double kStep = 1e-4;  // mm or rad
  Eigen::MatrixXd columns(comparison.residuals(suspected, values).size(), values.size());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(values.size());
    step(k) = kStep;
    columns.col(k) = (comparison.residuals(suspected, values + step) - comparison.residuals(suspected, values - step)) /
                     (2.0 * kStep);
  }
  return columns;
}

/// The values that fit best, by Gauss and Newton; a step that leaves the reach of the controller is halved.
/// @returns empty where the joints do not show them or no values explain the joints.
std::optional<Explained> explain(const Comparison& comparison, const Suspected& suspected) {
  constexpr int kSteps = 30, kHalvings = 20;
  constexpr double kSettled = 1e-3;  // of a rounding
  constexpr double kUnseen = 1e-3;   // roundings per mm or rad: as good as none
  Eigen::VectorXd values = Eigen::VectorXd::Zero(suspected.unknowns);
  Eigen::VectorXd left = comparison.residuals(suspected, values);
  double resolution = 0.0;
  for (int step = 0; suspected.unknowns > 0 && step < kSteps; ++step) {
    const Eigen::MatrixXd slope = slopes(comparison, suspected, values);
    if (!slope.allFinite()) return std::nullopt;
    const double seen = std::sqrt(std::max(0.0, detail::symmetric_eigenvalues(slope.transpose() * slope).minCoeff()));
    if (seen < kUnseen) return std::nullopt;
    resolution = 1.0 / seen;
    Eigen::VectorXd change = -detail::least_squares(slope, left);
    const double moves = (slope * change).cwiseAbs().maxCoeff();
    for (int half = 0; half < kHalvings; ++half, change *= 0.5) {
      if (comparison.residuals(suspected, values + change).allFinite()) break;
    }
    values += change;
    left = comparison.residuals(suspected, values);
    if (moves < kSettled) break;
  }
  const bool fits = left.allFinite() && left.cwiseAbs().maxCoeff() <= kFitted;
  if (!fits || !suspected.is_believable(values)) return std::nullopt;
  return Explained{&suspected, suspected.controller(values), suspected.text(values, resolution)};
}

std::vector<Suspected> usual_suspects(const Robot& robot) {
  std::vector<Suspected> all{other_sign(robot)};
  for (const Dimension& dimension : detail::dimensions(robot)) all.push_back(wrong_dimension(robot, dimension));
  if (robot.slide()) all.push_back(wrong_dimension(robot, detail::pinion_radius()));
  all.push_back(other_zero(robot));
  all.push_back(other_origin(robot, 1));
  all.push_back(other_origin(robot, 3));
  return all;
}

/// Poses at which controllers that differ show it: comparison_poses() first, then both rims.
std::vector<Pose> telling_poses(const Robot& robot) {
  constexpr int kAround = 8;
  std::vector<Pose> poses;
  for (const ComparisonPose& one : comparison_poses(robot)) poses.push_back(one.pose);
  for (const Pose& one : robot.workspace().rim(kAround)) {
    if (nominal_joints(robot, one).allFinite()) poses.push_back(one);
  }
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

/// @param besides  what stands before each explanation.
void add_explanations(const Robot& robot, const std::vector<DisplayedJoints>& displayed, std::string_view besides,
                      ControllerCheck& check) {
  const Comparison comparison(robot, displayed);
  const std::vector<Suspected> suspects = usual_suspects(robot);
  std::vector<Explained> explained;
  for (const Suspected& one : suspects) {
    const bool is_found = std::ranges::any_of(explained, [](const Explained& e) { return e.suspected->is_origin; });
    if (one.is_origin && is_found) continue;  // along z is a case of anywhere
    if (auto found = explain(comparison, one)) explained.push_back(std::move(*found));
  }
  const std::vector<Pose> poses = telling_poses(robot);
  const Joints tolerance = comparison.tolerance();
  const std::vector<Explained> groups = merged(explained, poses, tolerance);
  for (const Explained& one : groups) check.explanations.push_back(fmt::format("{}{}", besides, one.text));
  check.deciding = deciding_pose(groups, poses, tolerance);
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
  if (check.agrees()) return check;
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
