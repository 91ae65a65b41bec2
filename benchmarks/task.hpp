#pragma once

#include <vector>

#include "paracal/kinematics/closure.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::benchmark {

/// The common task of all candidates on one robot: the same poses and the same machine with errors.
struct Task {
  Robot robot;
  SourceErrors errors;  ///< all 14 sources of every limb
  Machine machine;      ///< with these errors
  std::vector<Pose> poses;
  std::vector<Joints> joints;      ///< nominal inverse of each pose: what an uncompensated controller commands
  std::vector<PlateState> plates;  ///< where the machine's plate then stands
};

/// Poses drawn evenly from the workspace, those that robot and machine both reach; seed fixed.
Task make_task(const Robot& robot, std::size_t pose_count);

}  // namespace paracal::benchmark
