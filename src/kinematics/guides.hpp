#pragma once

// Private to kinematics: what guides or parallelograms do not leave free to a plate.

#include "paracal/kinematics/closure.hpp"
#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/pose.hpp"

namespace paracal::detail {

/// The plate can be commanded there.
bool is_free(const Machine& machine, const Pose& pose);

/// Puts what guides hold where they hold it.
void guide(const Machine& machine, PlateState& plate);

}  // namespace paracal::detail
