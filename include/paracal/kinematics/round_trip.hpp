#pragma once

#include <cstdint>

#include "paracal/mechanism/robot.hpp"

namespace paracal {

struct RoundTripOptions {
  int poses = 200;           ///< of the workspace, besides its middle; each for the nominal machine and one with errors
  int poses_a_machine = 20;  ///< with errors: ten machines show what errors can do
  double tolerance = 1e-6;   ///< mm; a thousand times the tolerance of forward(), and less than any instrument shows
  std::uint64_t seed = 1;
};

/// Whether the joints of a pose lead back to it, without knowing it: forward(machine, inverse(machine, pose)) = pose,
/// for the nominal machine and machines within the tolerances of the robot, wherever inverse() reaches the pose. Where
/// limbs are more than degrees of freedom the pose is that of least squares near the one asked for.
///
/// @throws InvalidArgument naming the first pose that does not come back, and where the plate is instead.
void check_round_trip(const Robot& robot, const RoundTripOptions& options = {});

}  // namespace paracal
