#pragma once

// Private to calibration: what people get wrong, and how it is undone.

#include <array>
#include <optional>
#include <vector>

#include "mistake.hpp"

namespace paracal::detail {

/// Those that can have been made with such an input, the most frugal first.
std::vector<Mistake> usual_mistakes(const Input& given);

/// Metres, inches or centimetres: of all readings, of the commands or of both; where there are several series, of each
/// by itself, and of all of a kind; and some readings of a series.
std::vector<Mistake> unit_mistakes(const Input& given);

struct LengthUnit {
  const char* name;
  double mm;
};
/// What lengths are written in beside mm.
inline constexpr std::array<LengthUnit, 3> kOtherUnits{{{"metres", 1000.0}, {"inches", 25.4}, {"centimetres", 10.0}}};

/// Some readings, not all, are in another unit than the rest. Points show it by their distances from others of the same
/// unit, in any frame; distances by themselves; lengths by the longest of their series, or by their places.
std::optional<Mistake> part_in_another_unit(const Measurements& measurements);

/// Rad for deg, other signs, tilts that are swapped, and those of rotations in another order: controllers of machines
/// with six freedoms agree on none of these.
std::vector<Mistake> tilt_mistakes(const Input& given);

/// The reflector of points is beside the plate's centre, on the plate or on what turns with phi: only where that turns
/// in these commands, else the frame of the readings takes it up.
std::vector<Mistake> reflector_mistakes(const Input& given);

/// For each series the place in the order of its readings at which it is best split into two, each with a set-up of its
/// own, where that place is sharp: of a drift any place is about as good.
std::vector<Mistake> moved_set_ups(const Input& given);

/// pinion_radius_mm of the robot file: from the nominal machine, then from that which fits with the pinion found so. By
/// errors nothing is seen of it: they turn the plate by the rack's own offset alone.
/// @returns empty without a pinion, or where no rotation is read.
std::optional<Mistake> wrong_pinion(const Input& given);

}  // namespace paracal::detail
