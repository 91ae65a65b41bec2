#pragma once

#include <optional>

#include "paracal/kinematics/closure.hpp"
#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/pose.hpp"

namespace paracal {

/// Actual pose of a machine for a commanded pose, if its controller computes with another machine (`believed`):
///
///   `forward(actual, inverse(believed, commanded))`
///
/// @param guess  start near the solution, to save time; default: the commanded pose, which is within
/// millimetres of it. If the iteration does not converge, forward() uses its general start.
/// @returns empty if the controller's machine cannot reach the pose, or the actual one has no solution.
/// Real-time: yes (no allocation, no exception, bounded loop).
std::optional<PlateState> drive(const Machine& actual, const Machine& believed, const Pose& commanded,
                                const std::optional<PlateState>& guess = std::nullopt) noexcept;

/// Rotation of a plate relative to a commanded pose, about x, y and z of {O}, rad: a rotation vector on struts, the
/// plate's three angles if it is level.
Eigen::Vector3d turned_away(const Machine& machine, const Pose& commanded, const PlateState& plate) noexcept;

}  // namespace paracal
