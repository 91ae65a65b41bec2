#pragma once

#include <cstdint>
#include <string>

#include "paracal/io/file.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal::io {

/// Firmwares that store a delta's geometry in M-codes [reprapfirmware, marlin].
enum class CodeDialect : std::uint8_t { reprapfirmware, marlin };

/// The geometry in a config.g, in the output of M503 or of these codes without parameters, or in a console log. The
/// last word of each letter counts and comments begin with ;. Codes and words may be in lower case, after other text
/// (`echo:`, `Recv:`, `N10`), and before a checksum (`*71`). Words may follow each other without blanks (M665L290R130).
/// With M669 K10 it is a rotary delta (RepRapFirmware only), else it is linear.
///
///   M665  L  rods, mm (RepRapFirmware also three, L290.1:290.2:290.0)     R  delta radius, mm     H  homed height, mm
///         X Y Z  deg: angles of the towers from 210, 330 and 90 deg, counter-clockwise from above
///         A B C  mm: rods of the towers longer than L (Marlin)
///   M669  K10    U  arms, L  rods, H  heights of the shoulders, mm (one or three)     R  shoulder radius, mm
///         A  lowest:highest angle of the arms, deg; the endstops are at the highest     X Y Z  as for M665
///   M666  X Y Z  endstop adjustments, mm: added to the height of the endstops (RepRapFirmware) or subtracted
///         (Marlin); for a rotary delta deg, added to the highest angle
///
/// For Marlin also a Configuration.h with the same values as DELTA_... definitions, or sums and differences of others.
/// For RepRapFirmware also its answers to M665 and M666 (Diagonals ..., Endstop adjustments ...) and {global.NAME}.
///
/// With s_i = sqrt(rod_i^2 - R^2) and z_0 the nozzle with all carriages at 0, the endstops of the library's
/// DeltaGeometry are
///
///   RepRapFirmware  endstop_i = H - z_0 + adjustment_i - s_i        Marlin  endstop_i = H - adjustment_i
///
/// and for a rotary delta those of its homed angles. Other codes are ignored. These codes may also have S and T
/// (segments) and RepRapFirmware's B (print_radius_of_codes()).
/// @throws InputFileError for files of other firmwares, for missing or other words, for numbers that are not finite,
/// and for rods that do not reach. Also for RepRapFirmware's bed tilt (M666 A, B), which is not part of a geometry
/// here, and for implausible values, such as trims of 85 mm in a file of another firmware.
DeltaGeometry read_machine_codes(const TextFile& text, CodeDialect dialect);

/// Radius of the bed by RepRapFirmware's M665 B (for a rotary delta M669 B) or Marlin's PRINTABLE_RADIUS, mm;
/// 0: none.
double print_radius_of_codes(const TextFile& text, CodeDialect dialect);

/// The lines for a geometry. RepRapFirmware: adjustments sum to zero; A of a rotary delta is in a comment, because its
/// lowest angle is not part of a geometry. Marlin: adjustments are 0 or less.
/// @throws InvalidArgument for a rotary delta with Marlin, which does not support it.
std::string machine_codes(const DeltaGeometry& geometry, CodeDialect dialect);

}  // namespace paracal::io
