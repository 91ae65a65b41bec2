#pragma once

// Private to calibration: a reflector that is not at the plate's centre.

#include <vector>

#include "mistake.hpp"

namespace paracal::detail {

/// The reflector of points is beside the plate's centre, on the plate or on what turns with phi: only where that turns
/// in these commands, else the frame of the readings takes it up.
std::vector<Mistake> reflector_mistakes(const Input& given);

}  // namespace paracal::detail
