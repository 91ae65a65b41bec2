#pragma once

#include <cstdint>
#include <string>

#include "paracal/io/file.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal::io {

/// Firmwares that keep a delta's geometry in M-codes [reprapfirmware, marlin].
enum class CodeDialect : std::uint8_t { reprapfirmware, marlin };

/// The geometry in the lines of a config.g, in what M503 or the codes print without parameters, or in the log of a
/// console: the last word of each letter counts, comments begin with ;, codes and words may be in lower case, stand
/// behind anything (`echo:`, `Recv:`, `N10`), and before a checksum (`*71`); the words of M665L290R130 need no blanks.
/// M669 K10 makes it a rotary delta (RepRapFirmware alone), else it is linear.
///
///   M665  L  rods, mm (RepRapFirmware also three, L290.1:290.2:290.0)     R  delta radius, mm     H  homed height, mm
///         X Y Z  deg: how far the towers stand from 210, 330 and 90 deg, counter-clockwise from above
///         A B C  mm: rods of the towers longer than L (Marlin)
///   M669  K10    U  arms, L  rods, H  heights of the shoulders, mm (one or three)     R  shoulder radius, mm
///         A  lowest:highest angle of the arms, deg; the endstops are at the highest     X Y Z  as of M665
///   M666  X Y Z  endstop adjustments, mm: added to the height of the endstops (RepRapFirmware) or taken off it
///         (Marlin); of a rotary delta deg, added to the highest angle
///
/// Of Marlin also a Configuration.h: what it defines as DELTA_... says the same.
///
/// With s_i = sqrt(rod_i^2 - R^2) and z_0 the nozzle with all carriages at 0, the endstops of the library's
/// DeltaGeometry are
///
///   RepRapFirmware  endstop_i = H - z_0 + adjustment_i - s_i        Marlin  endstop_i = H - adjustment_i
///
/// and of a rotary delta those that go with its homed angles. Lines of other codes are passed over; of these codes also
/// known are S and T (segments), RepRapFirmware's B (print_radius_of_codes()).
/// @throws InputFileError without these words, for others, for anything but finite numbers, for rods that do not reach,
/// and for RepRapFirmware's bed tilt (M666 A, B), which no geometry here holds. What cannot be meant of a delta, as
/// trims of 85 mm when a file is read as the wrong firmware's, is refused, too.
DeltaGeometry read_machine_codes(const TextFile& file, CodeDialect dialect);

/// Radius of the bed that RepRapFirmware's M665 B (of a rotary delta M669 B) or Marlin's PRINTABLE_RADIUS states, mm;
/// 0: none.
double print_radius_of_codes(const TextFile& file, CodeDialect dialect);

/// The lines for a geometry. RepRapFirmware: adjustments sum to zero; a rotary delta's A, whose lowest angle no
/// geometry knows, stands in a comment. Marlin: adjustments are 0 or less.
/// @throws InvalidArgument for a rotary delta of Marlin, which knows none.
std::string machine_codes(const DeltaGeometry& geometry, CodeDialect dialect);

}  // namespace paracal::io
