#include "controller_suspects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "command_mistakes.hpp"
#include "paracal/kinematics/closure.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

/// @param at  how a pose changes with the values.
ControllerSuspect other_pose(const Robot& robot, std::string name,
                             std::function<Pose(const Pose&, const Eigen::VectorXd&)> at) {
  return {.name = std::move(name),
          .controller = [&robot, at = std::move(at)](const Eigen::VectorXd& values) -> PoseJoints {
            return [&robot, at, values](const Pose& pose) { return nominal_joints(robot, at(pose, values)); };
          }};
}

Eigen::Vector3d along_z_or_anywhere(const Eigen::VectorXd& values) {
  return values.size() == 1 ? Eigen::Vector3d(0.0, 0.0, values(0)) : Eigen::Vector3d(values);
}

std::string place_text(const Eigen::VectorXd& values, double resolution) {
  if (values.size() == 1) return "z " + shown_length(values(0), resolution);
  return fmt::format("({}, {}, {}) mm", shown(values(0), resolution, 2), shown(values(1), resolution, 2),
                     shown(values(2), resolution, 2));
}

/// The controller's coordinates begin elsewhere, along z or anywhere.
ControllerSuspect other_origin(const Robot& robot, int unknowns) {
  ControllerSuspect one = other_pose(robot, "the origin", [](Pose pose, const Eigen::VectorXd& values) {
    pose.position += along_z_or_anywhere(values);
    return pose;
  });
  one.unknowns = unknowns;
  one.is_origin = true;
  one.text = [](const Eigen::VectorXd& values, double resolution) {
    return fmt::format("origin at {} in the robot file's frame", place_text(values, resolution));
  };
  return one;
}

/// The controller commands the tip of a tool, not the plate.
ControllerSuspect tool(const Robot& robot, int unknowns) {
  ControllerSuspect one = other_pose(robot, "a tool", [](Pose pose, const Eigen::VectorXd& values) {
    pose.position -= plate_rotation(pose.tilt).matrix * along_z_or_anywhere(values);
    return pose;
  });
  one.unknowns = unknowns;
  one.is_origin = true;
  one.text = [](const Eigen::VectorXd& values, double resolution) {
    return fmt::format("a tool in the controller with its tip at {} from the plate", place_text(values, resolution));
  };
  return one;
}

ControllerSuspect turned_frame(const Robot& robot) {
  ControllerSuspect one =
      other_pose(robot, "the direction of x and y", [](const Pose& pose, const Eigen::VectorXd& values) {
        return turned_pose(pose, plate_rotation(Eigen::Vector3d(0.0, 0.0, values(0))).matrix);
      });
  one.noticeable = to_radians(1.0);
  one.starts = {0.0};
  for (const double degrees : {30.0, -30.0, 60.0, -60.0, 90.0, -90.0, 120.0, -120.0, 150.0, -150.0, 180.0}) {
    one.starts.push_back(to_radians(degrees));
  }
  one.text = [](const Eigen::VectorXd& values, double resolution) {
    return fmt::format("frame rotated by {} about z of the robot file's frame",
                       shown_angle(std::remainder(values(0), 2.0 * std::numbers::pi), resolution));
  };
  return one;
}

}  // namespace

std::string shown(double value, double resolution, int most) {
  const int decimals = resolution > 0.0 ? static_cast<int>(std::ceil(-std::log10(resolution))) : most;
  return fmt::format("{:.{}f}", value, std::clamp(decimals, 0, most));
}

std::string shown_length(double value, double resolution) { return shown(value, resolution, 2) + " mm"; }
std::string shown_angle(double value, double resolution) {
  return shown(to_degrees(value), to_degrees(resolution), 3) + " deg";
}

std::vector<ControllerSuspect> frame_suspects(const Robot& robot) {
  std::vector<ControllerSuspect> all{turned_frame(robot), other_origin(robot, 1), other_origin(robot, 3),
                                     tool(robot, 1)};
  if (robot.commands_tilt()) all.push_back(tool(robot, 3));
  return all;
}

}  // namespace paracal::detail
