#pragma once

#include <cstdint>

#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/pose.hpp"

namespace paracal {

enum class InverseStatus : std::uint8_t {
  reached,
  unreachable,    ///< a limb's arm and rod do not meet, or a plate is asked to turn or tilt that cannot (the joints are
                  ///< then those of the pose without); joints of limbs that do not reach are NaN
  not_converged,  ///< only with tilt errors: the pose is at a singularity of the machine; joints are the last iterate
};

struct [[nodiscard]] InverseResult {
  InverseStatus status = InverseStatus::unreachable;
  Joints joints;  ///< rad or mm, as the controller should command them
  int unreachable_limb =
      -1;              ///< first limb that does not reach, from 0; -1 when a plate is asked to turn or tilt that cannot
  int iterations = 0;  ///< 0: closed form

  bool ok() const { return status == InverseStatus::reached; }
};

/// Joint coordinates that bring the plate centre and the rotation to a pose, elbows outward, carriages above the plate.
///
/// Closed form (solve_joint) limb by limb on struts, and when no source error tilts the plate: the parallelograms then
/// stay perfect and only the centre lines count. With tilt errors the closed form starts a Newton iteration on the
/// exact closure, so that forward(machine, inverse(machine, pose)) returns the pose while the tilt stays what it must
/// be.
///
/// Real-time: yes (no allocation, no exception, bounded loop).
InverseResult inverse(const Machine& machine, const Pose& pose) noexcept;

}  // namespace paracal
