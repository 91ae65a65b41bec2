#pragma once

#include <optional>
#include <span>

#include "paracal/compensation/compensator.hpp"

namespace paracal {

/// The exact compensator for a whole path, several poses at a time in the lanes of the processor's vector registers.
/// The widest registers of the processor are chosen when the program starts. For planners, not for the cycle of a
/// controller.
///
/// The code is that of compensator.hpp, so each pose gets the status of `compensate` and its joints within 1e-12 rad
/// (rounding by fused multiply-adds and a separate arctangent). Poses without a solution in the lanes are
/// passed to `compensate`, and so are all poses of machines whose plate does not stay level.
///
/// @param poses     mm, rad, in {O}.
/// @param joints    rad; each written if its status is ok, else unchanged.
/// @param statuses  one per pose.
/// @param tilts     if not empty: the remaining tilts, rad; written like joints.
/// @throws std::invalid_argument  when the sizes differ.
void compensate_path(const CompensatorParameters<double>& parameters, std::span<const CompensatorPose<double>> poses,
                     std::span<CompensatorJoints<double>> joints, std::span<CompensationStatus> statuses,
                     std::span<CompensatorTilt<double>> tilts = {});

/// Targets for a controller that computes with the nominal robot, in the same lanes: the nominal robot's pose
/// with the joints that bring the identified machine to each pose. They agree with corrected_target within 1e-9 mm and
/// rad in the workspace, within 1e-7 mm far outside.
///
/// @param targets  one per pose; nothing if the lanes find none: the machine does not stay level, a drive is uneven,
///                 the pose is out of reach, rods hardly hold the plate there, or the target is farther than 50 mm
///                 away. corrected_target may still find one.
/// @throws std::invalid_argument  when the sizes differ.
void nominal_targets(const CompensatorParameters<double>& parameters, std::span<const CompensatorPose<double>> poses,
                     std::span<std::optional<CompensatorPose<double>>> targets);

}  // namespace paracal
