#pragma once

#include <cmath>
#include <numbers>

#include "fuzzing.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::fuzz {

/// Four numbers as a fuzzer makes them, NaN and infinity included.
struct Numbers {
  float x = 0.0F, y = 0.0F, z = 0.0F, phi = 0.0F;
};

/// @param data  at least 16 bytes.
inline Numbers numbers_of(const std::uint8_t* data) {
  Numbers numbers;
  std::memcpy(&numbers, data, sizeof numbers);
  return numbers;
}

/// From 0 to 1, for any number.
inline double share(float number) { return std::isfinite(number) ? std::abs(std::remainder(number, 2.0F)) : 0.5; }

inline Pose within(const Workspace& workspace, const Numbers& at) {
  const double phi = workspace.min_rotation + share(at.phi) * (workspace.max_rotation - workspace.min_rotation);
  return {workspace.at(share(at.x), 2.0 * std::numbers::pi * share(at.y), share(at.z)), phi};
}

/// A robot of the catalogue with errors drawn from its tolerances.
class DrawnMachine {
 public:
  DrawnMachine(unsigned choice, std::uint64_t number) : described(robot(choice)) {
    RandomStream random(2, number);
    const SourceErrors errors = draw_errors(described, tolerances_of(described), random);
    machine_ = build(described, errors);
    parameters = compensator_parameters<double>(described, errors);
  }

  /// What a compensator answers for a pose of the workspace: the inverse kinematics reaches it with the same joints, or
  /// does not reach it, either.
  void require_as_inverse(const Pose& pose, CompensationStatus status, const CompensatorJoints<double>& joints) const {
    const InverseResult expected = inverse(machine_, pose);
    if ((status == CompensationStatus::ok) != expected.ok()) {
      // Rounding decides within 1e-9 of the edge of reach, and nothing else.
      return require(status_at(pose, 1.0 - 1e-9) != expected.status || status_at(pose, 1.0 + 1e-9) != expected.status);
    }
    if (!expected.ok()) return;
    const double scale = described.actuator() == Actuator::linear ? 1e3 : 1.0;
    // Joints move as the root of what is left where an arm and its rod are in line.
    require((compensated_joints(described, joints) - expected.joints).cwiseAbs().maxCoeff() <= 1e-6 * scale);
  }

  const Robot& described;
  CompensatorParameters<double> parameters;

 private:
  InverseStatus status_at(const Pose& pose, double factor) const {
    return inverse(machine_, {factor * pose.position, pose.rotation}).status;
  }

  Machine machine_;
};

}  // namespace paracal::fuzz
