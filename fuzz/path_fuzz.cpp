// Whole paths in the lanes of vector registers: each pose of the workspace as the library's inverse kinematics has it,
// whatever stands beside it in the lanes: poses far outside, numbers that are none.

#include <vector>

#include "compensating.hpp"
#include "paracal/compensation/path.hpp"

namespace paracal::fuzz {
namespace {

struct Path {
  std::vector<CompensatorPose<double>> poses;
  std::vector<bool> is_within;  ///< the workspace
};

/// A pose from each 16 bytes; the bits of `outside` say which of every eight are taken as the numbers they are.
Path path_of(const Workspace& workspace, std::uint8_t outside, const std::uint8_t* data, std::size_t size) {
  Path path;
  for (; size >= sizeof(Numbers); data += sizeof(Numbers), size -= sizeof(Numbers)) {
    const Numbers numbers = numbers_of(data);
    const bool is_within = (outside >> (path.poses.size() % 8) & 1) == 0;
    path.is_within.push_back(is_within);
    path.poses.push_back(is_within ? closure_pose<double>(within(workspace, numbers))
                                   : CompensatorPose<double>{numbers.x, numbers.y, numbers.z, numbers.phi});
  }
  return path;
}

void compare(const DrawnMachine& machine, const Path& path) {
  const std::size_t size = path.poses.size();
  constexpr double kUntouched = 12345.0;
  std::vector<CompensatorJoints<double>> joints(size, {kUntouched, kUntouched, kUntouched, kUntouched});
  std::vector<CompensationStatus> statuses(size);
  std::vector<CompensatorTilt<double>> tilts(size);
  compensate_path(machine.parameters, path.poses, joints, statuses, tilts);
  for (std::size_t k = 0; k < size; ++k) {
    const CompensatorPose<double>& pose = path.poses[k];
    const bool is_ok = statuses[k] == CompensationStatus::ok;
    for (std::size_t i = 0; i < machine.described.limb_count(); ++i) {
      require(is_ok ? std::isfinite(joints[k][i]) : joints[k][i] == kUntouched);
    }
    require(!is_ok || (std::isfinite(tilts[k].eps_x) && std::isfinite(tilts[k].eps_y)));
    if (path.is_within[k]) machine.require_as_inverse({{pose.x, pose.y, pose.z}, pose.phi}, statuses[k], joints[k]);
  }
}

}  // namespace
}  // namespace paracal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace paracal::fuzz;
  constexpr std::size_t kMostPoses = 20;  // two blocks of lanes and a part of one
  if (size < 3) return 0;
  const DrawnMachine machine(data[0], data[1]);
  compare(machine,
          path_of(machine.described.workspace(), data[2], data + 3, std::min(size - 3, kMostPoses * sizeof(Numbers))));
  return 0;
}
