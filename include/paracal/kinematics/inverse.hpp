#pragma once

#include <cstdint>

#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/pose.hpp"

namespace paracal {

enum class InverseStatus : std::uint8_t {
  reached,
  unreachable,    ///< out of reach (joints of these limbs are NaN), or a rotation or tilt that the plate cannot have
                  ///< (the joints are then those of the pose without it)
  not_converged,  ///< only with tilt errors: the pose is singular; joints are the last iterate
};

struct [[nodiscard]] InverseResult {
  InverseStatus status = InverseStatus::unreachable;
  Joints joints;  ///< rad or mm, to command
  int unreachable_limb =
      -1;  ///< first limb that cannot reach the pose, from 0; -1 if the plate cannot have this rotation or tilt
  int iterations = 0;                              ///< 0: closed form
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();  ///< that errors leave and no joint can remove, rad

  bool ok() const { return status == InverseStatus::reached; }
};

/// Joint coordinates that bring the plate centre and the rotation to a pose, elbows outward, carriages above the plate.
///
/// Closed form (solve_joint) limb by limb on struts, and when no source error tilts the plate: the parallelograms then
/// stay perfect and only the centre lines count. With tilt errors the closed form starts a search for the balance of
/// the rods (mechanism/machine_closure.hpp). forward(machine, inverse(machine, pose)) then returns the pose; the tilt
/// cannot be corrected.
///
/// Real-time: yes (no allocation, no exception, bounded loop).
InverseResult inverse(const Machine& machine, const Pose& pose) noexcept;

}  // namespace paracal
