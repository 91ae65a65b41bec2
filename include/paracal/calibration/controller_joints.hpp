#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "paracal/mechanism/pose.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// Joints that a controller displays at a pose, as somebody wrote them down.
struct DisplayedJoints {
  std::string name;
  Pose pose;        ///< as commanded
  Joints joints;    ///< rad or mm
  Joints rounding;  ///< half of the last digit written, rad or mm
  int line = 0;     ///< of its table
};

/// Whether displayed joints are those of a robot's nominal inverse kinematics, and what would explain it where not.
struct ControllerCheck {
  std::size_t compared = 0;                    ///< poses
  std::optional<std::size_t> differs = {};     ///< the first pose that disagrees; empty: all agree
  std::size_t limb = 0;                        ///< of its joint that disagrees most
  double expected = 0.0;                       ///< that joint of the robot, rad or mm
  std::vector<std::string> explanations = {};  ///< each by itself: "rod 720.00 mm instead of 730 mm"
  bool is_named = false;                       ///< the only explanation has fewer unknowns than there are joints
  std::vector<std::string> unseen = {};        ///< of joints that agree: what may differ all the same, "the gear ratio"
  std::optional<Pose> deciding = {};  ///< a pose whose joints tell the explanations apart, or show what is unseen

  bool agrees() const { return !differs; }
};

/// Compares displayed joints with the nominal inverse kinematics. They agree within the rounding of the numbers and
/// what a controller's arithmetic leaves. Otherwise each single dimension, zeros, sign, unit, order and gear ratio of
/// the joints, and the controller's frame and tool are tried as explanations, and kept where they leave no more than
/// rounding. An explanation with as many unknowns as there are joints fits any joints: it is not named.
/// @throws InvalidArgument for no pose or another number of joints than limbs, Unreachable for a pose that the robot
/// does not reach.
ControllerCheck check_controller(const Robot& robot, const std::vector<DisplayedJoints>& displayed);

/// A pose with a word for where it is.
struct ComparisonPose {
  std::string name;
  Pose pose;
  Joints joints;  ///< of the nominal robot, rad or mm
};

/// Home (the centre of the workspace) and two poses on the rim, half its height down, with the nominal joints: to be
/// compared with what a controller displays there.
std::vector<ComparisonPose> comparison_poses(const Robot& robot);

}  // namespace paracal
