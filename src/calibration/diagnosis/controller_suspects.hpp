#pragma once

// Private to calibration: what a controller may do otherwise than a robot file says, one thing at a time.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "paracal/mechanism/robot.hpp"

namespace paracal::detail {

/// Joints of a controller at a pose, mm or rad; NaN where it does not reach it.
using PoseJoints = std::function<Joints(const Pose&)>;

/// A controller that differs from the robot in one thing, stated by as many values as there are unknowns; at zero it
/// does not differ.
struct ControllerSuspect {
  std::string name;  ///< "the order of limbs 2 and 3"
  int unknowns = 1;
  bool is_origin = false;
  double noticeable = 1.0;             ///< mm, rad or factor: a value that must show before it is excluded
  std::vector<double> starts = {0.0};  ///< of the only value, where one search does not find it everywhere
  std::function<PoseJoints(const Eigen::VectorXd& values)> controller = {};
  std::function<bool(const Eigen::VectorXd& values)> is_believable = [](const Eigen::VectorXd&) { return true; };
  /// @param resolution  of the values, by the rounding of the joints.
  std::function<std::string(const Eigen::VectorXd& values, double resolution)> text = {};
};

/// Joints of the robot's nominal inverse kinematics; NaN where it does not reach the pose.
Joints nominal_joints(const Robot& robot, const Pose& pose);

/// Signs, units, order and gear ratio of the joints, dimensions, zeros, and where the controller's frame and tool are.
/// Those that explain more with fewer values first.
/// @param robot  must outlive them.
std::vector<ControllerSuspect> controller_suspects(const Robot& robot);

/// Those of the frame and the tool: a frame rotated about z, another origin along z or anywhere, a tool.
std::vector<ControllerSuspect> frame_suspects(const Robot& robot);

/// "720.00": as many decimals as the joints show, of the given most.
std::string shown(double value, double resolution, int most);
/// Two decimals of mm and three of deg at most, with the unit.
std::string shown_length(double value, double resolution);
std::string shown_angle(double value, double resolution);

}  // namespace paracal::detail
