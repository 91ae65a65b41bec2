#pragma once

// Private to kinematics: what guides hold of a plate on fewer limbs with one rod than six.

#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/pose.hpp"

namespace paracal::detail {

/// Guides let the plate go there.
bool is_free(const Machine& machine, const Pose& pose);

}  // namespace paracal::detail
