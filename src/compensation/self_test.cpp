#include "paracal/compensation/self_test.hpp"

#include <algorithm>
#include <iterator>

#include "paracal/compensation/parameters.hpp"
#include "paracal/error.hpp"

namespace paracal {

std::vector<SelfTestCase> self_test(const Robot& robot, const CompensatorParameters<double>& parameters) {
  std::vector<Pose> poses{{robot.workspace().centre(), 0.0}};
  std::ranges::copy(robot.workspace().rim(3), std::back_inserter(poses));
  std::vector<SelfTestCase> cases;
  cases.reserve(poses.size());
  for (const Pose& pose : poses) {
    CompensatorJoints<double> joints{};
    const CompensationStatus status = compensate(parameters, CompensationWay::exact, compensator_pose(pose), joints);
    if (status == CompensationStatus::ok) {
      cases.push_back({pose, compensated_joints(robot, joints)});
    } else if (cases.empty()) {
      throw Unreachable("the calibrated machine does not reach the centre of its workspace");
    }
  }
  return cases;
}

}  // namespace paracal
