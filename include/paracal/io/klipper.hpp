#pragma once

#include <string>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/io/file.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal::io {

/// What a Klipper printer.cfg says of a delta: its geometry as it is used (typed values over saved ones), and the
/// readings that the last DELTA_CALIBRATE and DELTA_ANALYZE left in the SAVE_CONFIG block.
struct KlipperDelta {
  DeltaGeometry geometry;
  double print_radius = 0.0;            ///< of the bed, mm
  DeltaReadings readings;               ///< probed and manual heights alike; step counts as drops of the joints
  std::array<double, 3> step_size{};    ///< of a micro-step, mm or rad
  std::vector<InputFile> files = {};    ///< the configuration and what it includes
  std::vector<std::string> notes = {};  ///< lines that others override, files that are not there
};

/// Sections, `key: value` or `key = value`, comments after # or ;, and at the end the block of lines that begin with
/// #*#, whose values count where none is typed: a key that is typed anywhere is taken off the block [klipper]. Where
/// the firmware passes over the block, because something stands among its lines or below them, only its readings are
/// read, and a note says so. Read are
///
///   [printer]                 kinematics (delta, rotary_delta), print_radius
///                             delta_radius; of rotary deltas shoulder_radius, shoulder_height
///   [stepper_a], _b, _c       arm_length; of rotary deltas upper_arm_length, lower_arm_length
///                             position_endstop, angle, and step_distance or rotation_distance (an arm's is one turn),
///                             microsteps, full_steps_per_rotation, gear_ratio
///   [delta_calibrate]         height0, height0_pos, ..., manual_height0, manual_height0_pos, ..., distance0,
///                             distance0_pos1, distance0_pos2, ..., radius
///
/// `[include NAME]` stands for the files of that name or pattern, from the folder of the file that names them. B and C
/// have the lengths and the endstop of A where they state none, as in the firmware. Other sections and keys are
/// the printer's own business and passed over.
/// @throws InputFileError for a file without these sections, other kinematics, and values that make no sense.
KlipperDelta read_klipper(const TextFile& file);

/// The lines that SAVE_CONFIG would write for a geometry, to be put in place of those in printer.cfg; of a rotary delta
/// also the lengths, which its own calibration does not change. Lines of the same keys outside the block come before
/// them: see klipper_config().
std::string klipper_save_config(const DeltaGeometry& geometry);

/// The configuration with a geometry in force: every number of it is changed where it stands, in the block or typed,
/// and what is nowhere stated is added to the block; comments and everything else stay, byte for byte. Numbers have 9
/// decimals.
/// @throws InputFileError where a number in force stands in an included file, which is named: it is changed there; and
/// where the firmware passes over the block, with the line for which it does.
std::string klipper_config(const TextFile& file, const DeltaGeometry& geometry);

}  // namespace paracal::io
