#pragma once

// Private to calibration: lengths in another unit.

#include <vector>

#include "mistake.hpp"

namespace paracal::detail {

/// Metres, inches or centimetres: of all readings, of the commands or of both; where there are several series, of each
/// by itself, and of all of a kind; and some readings of a series.
std::vector<Mistake> unit_mistakes(const Input& given);

}  // namespace paracal::detail
