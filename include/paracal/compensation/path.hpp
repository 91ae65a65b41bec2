#pragma once

#include <optional>
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

/// What a controller that computes with the nominal robot must be told, in the same lanes: the nominal robot's pose
/// with the joints that bring the identified machine to each pose, within 1e-9 mm and rad of corrected_target in the
/// workspace, within 1e-7 mm far outside.
///
/// @param targets  one a pose; nothing where the lanes find none: the pose is out of reach, rods hardly hold the plate
///                 there, or the target is farther than 50 mm away. corrected_target may still have one.
/// @throws std::invalid_argument  when the sizes differ.
void nominal_targets(const CompensatorParameters<double>& parameters, std::span<const CompensatorPose<double>> poses,
                     std::span<std::optional<CompensatorPose<double>>> targets);

}  // namespace paracal
