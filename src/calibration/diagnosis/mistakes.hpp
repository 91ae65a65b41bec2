#pragma once

// Private to calibration: what people get wrong, and how it is undone.

#include <vector>

#include "mistake.hpp"

namespace paracal::detail {

/// Those that can have been made with such an input, the most frugal first.
std::vector<Mistake> usual_mistakes(const Input& given);

}  // namespace paracal::detail
