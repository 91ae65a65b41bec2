#pragma once

// Private to io: the delta that a Configuration.h was compiled with.

#include <optional>

#include "paracal/io/file.hpp"

namespace paracal::io {

/// A Marlin Configuration.h as the codes that say the same, line by line:
///
///   #define DELTA_DIAGONAL_ROD 250.0              M665 L250.0
///   #define DELTA_RADIUS 124.0                    M665 R124.0
///   #define DELTA_HEIGHT 250.0                    M665 H250.0
///   #define DELTA_TOWER_ANGLE_TRIM {0, 0.1, 0}    M665 X0 Y0.1 Z0
///   #define DELTA_DIAGONAL_ROD_TRIM_TOWER {...}   M665 A B C
///   #define DELTA_ENDSTOP_ADJ {0, -0.3, -1}       M666 X0 Y-0.3 Z-1
///
/// and [DELTA_]PRINTABLE_RADIUS. Comments do not count; what #if leaves out cannot be told, so of keys that are defined
/// more than once all must say the same.
struct MarlinConfiguration {
  TextFile codes;
  double print_radius = 0.0;  ///< mm; 0: not stated
};

/// @returns empty for a text that defines no DELTA_DIAGONAL_ROD.
/// @throws InputFileError for a key that is defined in two ways, and for radii of single towers
/// (DELTA_RADIUS_TRIM_TOWER), which no geometry here holds.
std::optional<MarlinConfiguration> marlin_configuration(const TextFile& file);

}  // namespace paracal::io
