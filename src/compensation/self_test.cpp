#include "paracal/compensation/self_test.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>

#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"

namespace paracal {
namespace {

/// The tilts in turn, one per place: all of them at each place would be hundreds.
std::vector<Pose> tilted_rims(const Workspace& workspace) {
  constexpr std::size_t kFewest = 7;
  const std::vector<Eigen::Vector3d> tilts = workspace.tilts();
  const std::size_t count = std::max(kFewest, tilts.size());
  std::vector<Pose> poses;
  poses.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double azimuth = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    poses.push_back({workspace.at(1.0, azimuth, k % 2 == 0 ? 0.0 : 1.0), 0.0, tilts[k % tilts.size()]});
  }
  return poses;
}

}  // namespace

std::vector<SelfTestCase> self_test(const Robot& robot, const Machine& machine, const DriveCurves& drives) {
  const Workspace& workspace = robot.workspace();
  std::vector<Pose> poses{{workspace.centre(), 0.0}};
  std::ranges::copy(robot.is_level() ? workspace.rim(3) : tilted_rims(workspace), std::back_inserter(poses));
  std::vector<SelfTestCase> cases;
  cases.reserve(poses.size());
  for (const Pose& pose : poses) {
    const InverseResult found = inverse(machine, pose);
    if (found.ok()) {
      cases.push_back({pose, drives.commanded(found.joints)});
    } else if (cases.empty()) {
      throw Unreachable("the calibrated machine does not reach the centre of its workspace");
    }
  }
  return cases;
}

}  // namespace paracal
