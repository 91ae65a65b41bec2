#pragma once

#include <vector>

#include "paracal/calibration/prediction.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// One case of the self-test in every export: what the target must compute on the controller.
struct SelfTestCase {
  Pose pose;      ///< commanded; mm, rad
  Joints joints;  ///< corrected by the exact method, rad or mm
};

/// The centre of the workspace and its rims, in all tilts, as far as the machine reaches them.
/// @throws Unreachable when it does not reach the centre.
/// @param drives  that the joints make up for.
std::vector<SelfTestCase> self_test(const Robot& robot, const Machine& machine, const DriveCurves& drives = {});

}  // namespace paracal
