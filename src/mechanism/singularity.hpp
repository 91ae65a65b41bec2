#pragma once

// Private to mechanism: whether limbs move and hold the plate everywhere in its workspace.

#include "paracal/mechanism/robot.hpp"

namespace paracal::detail {

/// Searches the whole workspace, with all rotations and tilts, for a pose that limbs cannot reach, or where the robot
/// is singular: a joint does not move its rod, or the plate could move with all rods as they are. A pose with the other
/// sign than the centre counts, too, because a singular surface lies between them.
/// @throws InvalidArgument naming the pose.
void check_closure(const Machine& machine, const RobotDescription& robot);

}  // namespace paracal::detail
