// The compensator that controllers run, against the library's inverse kinematics: at every pose of the workspace both
// reach with the same joints, or none does.

#include "compensating.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace paracal;
  if (size < 2 + sizeof(fuzz::Numbers)) return 0;
  const fuzz::DrawnMachine machine(data[0], data[1]);
  const Pose pose = fuzz::within(machine.described.workspace(), fuzz::numbers_of(data + 2));
  CompensatorJoints<double> joints{};
  const CompensationStatus status =
      compensate(machine.parameters, CompensationWay::exact, closure_pose<double>(pose), joints);
  machine.require_as_inverse(pose, status, joints);
  return 0;
}
