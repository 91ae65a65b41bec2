#pragma once

// Private to calibration: pinion_radius_mm of a robot file is wrong.

#include <optional>

#include "mistake.hpp"

namespace paracal::detail {

/// From the nominal machine, then from that which fits with the pinion found so. By errors nothing is seen of it: they
/// turn the plate by the rack's own offset alone.
/// @returns empty without a pinion, or where no rotation is read.
std::optional<Mistake> wrong_pinion(const Input& given);

}  // namespace paracal::detail
