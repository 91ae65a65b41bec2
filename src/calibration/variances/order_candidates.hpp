#pragma once

// Private to calibration: what may drift, and which joints may have backlash.

#include <vector>

#include "order_effects.hpp"

namespace paracal::detail {

/// Each error of a limb, each of its two rods by itself, each error of all limbs alike; the zero and the whole set-up
/// of each series; each joint, and all joints. Drifts along a line and along a curve of degree 3, in every order in
/// which the readings may have been taken. Directions are in the units of the unknowns.
std::vector<OrderEffect> order_candidates(const StageFit& fit, const LinearReadings& readings);

}  // namespace paracal::detail
