#pragma once

#include <span>

#include "paracal/compensation/compensator.hpp"

namespace paracal {

/// The exact compensator over a whole path, several poses at a time in the lanes of the processor's vector registers;
/// the widest that the running processor has are chosen when the program starts. For planners, not for the cycle of a
/// controller.
///
/// The lines are those of compensator.hpp, so each pose gets the status of `compensate` and its joints within 1e-12 rad
/// (rounding: fused multiply-adds, and an own arctangent in the lanes). Poses for which the lanes find no answer are
/// given to `compensate` itself.
///
/// @param poses     mm, rad, in {O}.
/// @param joints    rad; each written where its status is ok, left as it is otherwise.
/// @param statuses  one a pose.
/// @param tilts     on request (else empty): what tilt remains, rad; written as joints are.
/// @throws std::invalid_argument  when the sizes differ.
void compensate_path(const CompensatorParameters<double>& parameters, std::span<const CompensatorPose<double>> poses,
                     std::span<CompensatorJoints<double>> joints, std::span<CompensationStatus> statuses,
                     std::span<CompensatorTilt<double>> tilts = {});

}  // namespace paracal
