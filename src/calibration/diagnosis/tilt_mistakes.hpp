#pragma once

// Private to calibration: commanded tilts of plates with six freedoms.

#include <vector>

#include "mistake.hpp"

namespace paracal::detail {

/// Rad for deg, other signs, tilts that are swapped, and those of rotations in another order: controllers of machines
/// with six freedoms agree on none of these.
std::vector<Mistake> tilt_mistakes(const Input& given);

}  // namespace paracal::detail
