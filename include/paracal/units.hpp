#pragma once

#include <numbers>

namespace paracal {

/// Inside the library lengths are mm and angles rad; degrees exist only in files and on screens.
constexpr double to_radians(double degrees) { return degrees * (std::numbers::pi / 180.0); }
constexpr double to_degrees(double radians) { return radians * (180.0 / std::numbers::pi); }

}  // namespace paracal
