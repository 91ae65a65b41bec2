// The compensator that controllers run, against the library's inverse kinematics: at every pose of the workspace both
// reach with the same joints, or none does. Far outside, beside singular poses, the two stop iterating differently.

#include <cmath>
#include <numbers>

#include "fuzzing.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::fuzz {
namespace {

struct Case {
  std::uint8_t robot = 0, machine = 0;
  float x = 0.0F, y = 0.0F, z = 0.0F, phi = 0.0F;
};

/// From 0 to 1, for any number.
double share(float number) { return std::isfinite(number) ? std::abs(std::remainder(number, 2.0F)) : 0.5; }

Pose within(const Workspace& workspace, const Case& one) {
  const double z = workspace.top_z - share(one.z) * workspace.height;
  const double phi = workspace.min_rotation + share(one.phi) * (workspace.max_rotation - workspace.min_rotation);
  return {Workspace::on_circle(share(one.x) * workspace.radius, 2.0 * std::numbers::pi * share(one.y), z), phi};
}

InverseStatus status_at(const Machine& machine, const Pose& pose, double factor) {
  return inverse(machine, {factor * pose.position, pose.rotation}).status;
}

void compare(const Case& one) {
  const Robot& described = robot(one.robot);
  RandomStream random(2, one.machine);
  const SourceErrors errors = draw_errors(tolerances_of(described), described.limb_count(), random);
  const Machine machine = build(described, errors);
  const Pose pose = within(described.workspace(), one);
  CompensatorJoints<double> joints{};
  const CompensationStatus status = compensate(compensator_parameters<double>(described, errors),
                                               CompensationWay::exact, compensator_pose<double>(pose), joints);
  const InverseResult expected = inverse(machine, pose);
  if ((status == CompensationStatus::ok) != expected.ok()) {
    // Rounding decides within 1e-9 of the edge of reach, and nothing else.
    const bool at_the_edge = status_at(machine, pose, 1.0 - 1e-9) != expected.status ||
                             status_at(machine, pose, 1.0 + 1e-9) != expected.status;
    return require(at_the_edge);
  }
  if (!expected.ok()) return;
  const double scale = described.actuator() == Actuator::linear ? 1e3 : 1.0;
  // Joints move as the root of what is left where an arm and its rod are in line.
  require((compensated_joints(described, joints) - expected.joints).cwiseAbs().maxCoeff() <= 1e-6 * scale);
}

}  // namespace
}  // namespace paracal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  paracal::fuzz::Case one;
  if (size < 18) return 0;
  one.robot = data[0];
  one.machine = data[1];
  std::array<float, 4> numbers{};
  std::memcpy(numbers.data(), data + 2, sizeof numbers);
  one.x = numbers[0], one.y = numbers[1], one.z = numbers[2], one.phi = numbers[3];
  paracal::fuzz::compare(one);
  return 0;
}
