#include "controller_suspects.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string_view>
#include <utility>

#include "dimensions.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

/// No dimension of a robot file that was meant for the machine is off by more of itself, or of the base's radius.
constexpr double kFarthest = 0.3;
/// A gear ratio is off by a pulley or a gear, not by more than this, or less.
constexpr double kLeastGear = 0.05, kMostGear = 20.0;
constexpr double kDegree = std::numbers::pi / 180.0;

Joints nowhere(const Robot& robot) {
  return Joints::Constant(static_cast<Eigen::Index>(robot.limb_count()), std::nan(""));
}

Joints joints_of(const Machine& machine, const Pose& pose) {
  const InverseResult found = inverse(machine, pose);
  return found.ok() ? found.joints : Joints::Constant(static_cast<Eigen::Index>(machine.limb_count), std::nan(""));
}

std::string shown_joint(const Robot& robot, double value, double resolution) {
  const bool is_angle = joint_unit(robot.actuator()) == Unit::rad;
  return is_angle ? shown_angle(value, resolution) : shown_length(value, resolution);
}
/// mm, or what turns a rod by about as much.
double noticeable_joint(const Robot& robot) { return joint_unit(robot.actuator()) == Unit::rad ? kDegree : 1.0; }

/// "limb azimuth of limb 2", of "limb_azimuth_deg of limb 2".
std::string in_words(std::string key) {
  for (const std::string_view unit : {"_mm", "_deg"}) {
    if (const std::size_t at = key.find(unit); at != std::string::npos) key.erase(at, unit.size());
  }
  std::ranges::replace(key, '_', ' ');
  return key;
}

/// Joints that are a function of the right ones.
ControllerSuspect other_joints(const Robot& robot, std::string name, std::string text,
                               std::function<Joints(const Joints&)> shows) {
  return {.name = std::move(name),
          .unknowns = 0,
          .controller = [&robot, shows = std::move(shows)](const Eigen::VectorXd&) -> PoseJoints {
            return [&robot, shows](const Pose& pose) { return shows(nominal_joints(robot, pose)); };
          },
          .text = [text = std::move(text)](const Eigen::VectorXd&, double) { return text; }};
}

ControllerSuspect other_sign(const Robot& robot) {
  return other_joints(robot, "the sign of the joints", "joints with the opposite sign: multiply them by -1",
                      [](const Joints& right) -> Joints { return -right; });
}

ControllerSuspect radians(const Robot& robot) {
  return other_joints(robot, "the unit of the joints", "joints in radians: multiply them by 57.29578",
                      [](const Joints& right) -> Joints { return kDegree * right; });
}

/// @param order  joint k shown is that of limb order[k].
ControllerSuspect other_order(const Robot& robot, const std::vector<std::size_t>& order) {
  std::vector<std::size_t> moved, numbers;
  for (std::size_t k = 0; k < order.size(); ++k) {
    numbers.push_back(order[k] + 1);
    if (order[k] != k) moved.push_back(k + 1);
  }
  const std::string text =
      moved.size() == 2 ? fmt::format("limbs {} and {} swapped", moved[0], moved[1])
                        : fmt::format("limbs in another order: q1 ... are those of limbs {}", fmt::join(numbers, ", "));
  return other_joints(
      robot,
      moved.size() == 2 ? fmt::format("the order of limbs {} and {}", moved[0], moved[1]) : "the order of the limbs",
      text, [order](const Joints& right) {
        Joints shown = right;
        for (std::size_t k = 0; k < order.size(); ++k) {
          shown(static_cast<Eigen::Index>(k)) = right(static_cast<Eigen::Index>(order[k]));
        }
        return shown;
      });
}

/// All orders of few limbs; of more those where two are swapped, all count on from another one, or backwards.
std::vector<ControllerSuspect> other_orders(const Robot& robot) {
  constexpr std::size_t kFew = 4;
  const std::size_t limbs = robot.limb_count();
  std::vector<std::size_t> order(limbs);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::vector<std::size_t> right = order;
  std::vector<ControllerSuspect> all;
  for (std::size_t one = 0; one < limbs; ++one) {
    for (std::size_t other = one + 1; other < limbs; ++other) {
      order = right;
      std::swap(order[one], order[other]);
      all.push_back(other_order(robot, order));
    }
  }
  const auto is_new = [&] {  // no swap of two, nor the right order
    std::size_t moved = 0;
    for (std::size_t k = 0; k < limbs; ++k) moved += order[k] == k ? 0 : 1;
    return moved > 2;
  };
  if (limbs <= kFew) {
    for (order = right; std::ranges::next_permutation(order).found;) {
      if (is_new()) all.push_back(other_order(robot, order));
    }
    return all;
  }
  for (const bool backwards : {false, true}) {
    order = right;
    if (backwards) std::ranges::reverse(order);
    for (std::size_t by = 0; by < limbs; ++by, std::rotate(order.begin(), order.begin() + 1, order.end())) {
      if (is_new()) all.push_back(other_order(robot, order));
    }
  }
  return all;
}

ControllerSuspect wrong_dimension(const Robot& robot, const Dimension& dimension) {
  const double nominal = now(robot, dimension);
  const auto value = [nominal](const Eigen::VectorXd& values) { return nominal + values(0); };
  const double most =
      kFarthest * (dimension.angle ? std::numbers::pi : std::max(nominal, sizes_of(robot.limbs()).base_radius));
  return {.name = in_words(dimension.key),
          .noticeable = dimension.angle ? kDegree : 1.0,
          .controller = [&robot, dimension, value](const Eigen::VectorXd& values) -> PoseJoints {
            try {
              return [other = detail::with(robot, dimension, value(values))](const Pose& pose) {
                return nominal_joints(other, pose);
              };
            } catch (const InvalidArgument&) {
              return [&robot](const Pose&) { return nowhere(robot); };  // there is no such robot
            }
          },
          .is_believable = [most](const Eigen::VectorXd& values) { return std::abs(values(0)) <= most; },
          .text =
              [dimension, nominal, value](const Eigen::VectorXd& values, double resolution) {
                const bool angle = dimension.angle;
                return fmt::format(
                    "{} {} instead of {:g} {}", in_words(dimension.key),
                    angle ? shown_angle(value(values), resolution) : shown_length(value(values), resolution),
                    angle ? to_degrees(nominal) : nominal, angle ? "deg" : "mm");
              }};
}

/// Rods of one limb that are longer, where the robot file has one length for all.
ControllerSuspect wrong_rod(const Robot& robot, std::size_t limb) {
  const double nominal = robot.nominal().limbs[limb].mean_rod(), most = kFarthest * nominal;
  return {.name = fmt::format("rod of limb {}", limb + 1),
          .controller = [&robot, limb](const Eigen::VectorXd& values) -> PoseJoints {
            SourceErrors longer;
            longer(limb, "rod_mean") = values(0);
            return [machine = build(robot, longer)](const Pose& pose) { return joints_of(machine, pose); };
          },
          .is_believable = [most](const Eigen::VectorXd& values) { return std::abs(values(0)) <= most; },
          .text =
              [nominal, limb](const Eigen::VectorXd& values, double resolution) {
                return fmt::format("rod of limb {} {} instead of {:g} mm", limb + 1,
                                   shown_length(nominal + values(0), resolution), nominal);
              }};
}

/// @param limbs  whose joints show more.
ControllerSuspect other_zero(const Robot& robot, const Joints& limbs, const std::string& name) {
  return {.name = name,
          .noticeable = noticeable_joint(robot),
          .controller = [&robot, limbs](const Eigen::VectorXd& values) -> PoseJoints {
            return [&robot, limbs, more = values(0)](const Pose& pose) -> Joints {
              return nominal_joints(robot, pose) + more * limbs;
            };
          },
          .text =
              [&robot, name](const Eigen::VectorXd& values, double resolution) {
                return fmt::format("{}: the controller shows {} more", name, shown_joint(robot, values(0), resolution));
              }};
}

ControllerSuspect other_gear(const Robot& robot) {
  constexpr double kNoticeable = 0.01;
  return {.name = "the gear ratio",
          .noticeable = kNoticeable,
          .controller = [&robot](const Eigen::VectorXd& values) -> PoseJoints {
            return [&robot, ratio = 1.0 + values(0)](const Pose& pose) -> Joints {
              return ratio * nominal_joints(robot, pose);
            };
          },
          .is_believable =
              [](const Eigen::VectorXd& values) { return 1.0 + values(0) > kLeastGear && 1.0 + values(0) < kMostGear; },
          .text =
              [](const Eigen::VectorXd& values, double) {
                return fmt::format("gear ratio: the controller shows {:.6g} times the joints", 1.0 + values(0));
              }};
}

}  // namespace

Joints nominal_joints(const Robot& robot, const Pose& pose) { return joints_of(robot.nominal(), pose); }

std::vector<ControllerSuspect> controller_suspects(const Robot& robot) {
  const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
  std::vector<ControllerSuspect> all{other_sign(robot)};
  if (joint_unit(robot.actuator()) == Unit::rad) all.push_back(radians(robot));
  std::ranges::move(other_orders(robot), std::back_inserter(all));
  for (const Dimension& dimension : dimensions(robot)) all.push_back(wrong_dimension(robot, dimension));
  if (robot.slide()) all.push_back(wrong_dimension(robot, pinion_radius()));
  all.push_back(other_zero(robot, Joints::Ones(limbs), "the zero of all joints"));
  all.push_back(other_gear(robot));
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    if (shared_dimensions(robot.limbs())) all.push_back(wrong_rod(robot, limb));
    all.push_back(other_zero(robot, Joints::Unit(limbs, static_cast<Eigen::Index>(limb)),
                             fmt::format("the zero of limb {}", limb + 1)));
  }
  std::ranges::move(frame_suspects(robot), std::back_inserter(all));
  return all;
}

}  // namespace paracal::detail
