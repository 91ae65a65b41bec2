#pragma once

#include <cstdint>
#include <string>

#include "paracal/io/file.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal::io {

/// Firmwares that keep a linear delta's geometry in M665 and M666.
enum class CodeDialect : std::uint8_t { reprapfirmware, marlin };

/// The geometry in the lines of a config.g, or in what M665 and M666 print; the last word of each letter counts,
/// comments begin with ;.
///
///   M665  L  rods, mm (RepRapFirmware also three, L290.1:290.2:290.0)     R  delta radius, mm     H  homed height, mm
///         X Y Z  deg: how far the towers stand from 210, 330 and 90 deg, counter-clockwise from above
///         A B C  mm: rods of the towers longer than L (Marlin)
///   M666  X Y Z  mm, endstop adjustments, added to the height of the endstops (RepRapFirmware) or taken off it
///   (Marlin)
///
/// With s_i = sqrt(arm_i^2 - R^2) and z_0 the nozzle with all carriages at 0, the endstops of the library's
/// DeltaGeometry are
///
///   RepRapFirmware  endstop_i = H - z_0 + adjustment_i - s_i        Marlin  endstop_i = H - adjustment_i
///
/// Other words and lines are passed over.
/// @throws InputFileError without L, R and H, for anything but finite numbers, and for arms shorter than the radius.
DeltaGeometry read_machine_codes(const TextFile& file, CodeDialect dialect);

/// The two lines for a geometry. RepRapFirmware: adjustments sum to zero. Marlin: they are 0 or less.
std::string machine_codes(const DeltaGeometry& geometry, CodeDialect dialect);

}  // namespace paracal::io
