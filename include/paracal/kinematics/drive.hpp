#pragma once

#include <optional>

#include "paracal/kinematics/closure.hpp"
#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/pose.hpp"

namespace paracal {

/// Where a machine puts its plate when its controller, which computes with another machine, is sent to a pose:
///
///   forward(actual, inverse(believed, commanded))
///
/// @param guess  near the answer, which saves the search for one; by default the commanded pose itself, within
/// millimetres of it. Where the iteration does not settle from there, the general start of forward() decides.
/// @returns empty when the believed machine does not reach the pose, or the actual one does not close there.
/// Real-time: yes (no allocation, no exception, bounded loop).
std::optional<PlateState> drive(const Machine& actual, const Machine& believed, const Pose& commanded,
                                const std::optional<PlateState>& guess = std::nullopt) noexcept;

/// How far a plate is turned away from a commanded pose, about x, y and z of {O}, rad: a turn's vector on struts, the
/// plate's three angles where it is to stay level.
Eigen::Vector3d turned_away(const Machine& machine, const Pose& commanded, const PlateState& plate) noexcept;

}  // namespace paracal
