#pragma once

// Private to calibration: an instrument or a body that moved while a series was read.

#include <vector>

#include "mistake.hpp"

namespace paracal::detail {

/// For each series the place in the order of its readings at which it is best split into two, each with a set-up of its
/// own, where that place is sharp: of a drift any place is about as good.
std::vector<Mistake> moved_set_ups(const Input& given);

}  // namespace paracal::detail
