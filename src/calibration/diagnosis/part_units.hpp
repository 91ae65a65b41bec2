#pragma once

// Private to calibration: a part of the readings in another unit.

#include <array>
#include <optional>

#include "mistake.hpp"

namespace paracal::detail {

struct LengthUnit {
  const char* name;
  double mm;
};
/// What lengths are written in beside mm.
inline constexpr std::array<LengthUnit, 3> kOtherUnits{{{"metres", 1000.0}, {"inches", 25.4}, {"centimetres", 10.0}}};

/// Some readings, not all, are in another unit than the rest. Points show it by their distances from others of the same
/// unit, in any frame; distances by themselves; lengths by the longest of their series, or by their places.
std::optional<Mistake> part_in_another_unit(const Measurements& measurements);

}  // namespace paracal::detail
