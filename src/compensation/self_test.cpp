#include "paracal/compensation/self_test.hpp"

#include <algorithm>
#include <iterator>

#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal {

std::vector<SelfTestCase> self_test(const Robot& robot, const Machine& machine) {
  std::vector<Pose> poses{{robot.workspace().centre(), 0.0}};
  std::ranges::copy(robot.workspace().rim(3), std::back_inserter(poses));
  const std::vector<Eigen::Vector3d> tilts = robot.workspace().tilts();
  for (std::size_t k = 1; k < poses.size() && !tilts.empty(); ++k) poses[k].tilt = tilts[k % tilts.size()];
  std::vector<SelfTestCase> cases;
  cases.reserve(poses.size());
  for (const Pose& pose : poses) {
    const InverseResult found = inverse(machine, pose);
    if (found.ok()) {
      cases.push_back({pose, found.joints});
    } else if (cases.empty()) {
      throw Unreachable("the calibrated machine does not reach the centre of its workspace");
    }
  }
  return cases;
}

}  // namespace paracal
