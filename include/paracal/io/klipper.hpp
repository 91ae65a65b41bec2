#pragma once

#include <string>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/io/file.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal::io {

/// A delta in a Klipper printer.cfg: its geometry in force (typed values override saved ones), and the readings that
/// the last DELTA_CALIBRATE and DELTA_ANALYZE left in the SAVE_CONFIG block.
struct KlipperDelta {
  DeltaGeometry geometry;
  double print_radius = 0.0;            ///< of the bed, mm
  DeltaReadings readings;               ///< probed and manual heights alike; step counts as drops of the joints
  std::array<double, 3> step_size{};    ///< per micro-step, mm or rad
  std::vector<InputFile> files = {};    ///< the configuration and the files it includes
  std::vector<std::string> notes = {};  ///< overridden lines, missing files
};

/// Sections, `key: value` or `key = value`, comments after # or ;, and at the end the block of lines that begin with
/// #*#. Values of the block count if the key is not typed elsewhere [klipper]. If the firmware ignores the block
/// because of other lines in it or below it, only its readings are used, with a note. Read are
///
///   [printer]                 kinematics (delta, rotary_delta), print_radius
///                             delta_radius; of rotary deltas shoulder_radius, shoulder_height
///   [stepper_a], _b, _c       arm_length; of rotary deltas upper_arm_length, lower_arm_length
///                             position_endstop, angle, and step_distance or rotation_distance (an arm's is one turn),
///                             microsteps, full_steps_per_rotation, gear_ratio
///   [delta_calibrate]         height0, height0_pos, ..., manual_height0, manual_height0_pos, ..., distance0,
///                             distance0_pos1, distance0_pos2, ..., radius
///
/// `[include NAME]` stands for the files of that name or pattern, from the folder of the including file. B and C use
/// the lengths and the endstop of A if they state none, as in the firmware. Other sections and keys are ignored.
/// @throws InputFileError for a file without these sections, other kinematics, and implausible values.
KlipperDelta read_klipper(const TextFile& file);

/// The lines that SAVE_CONFIG would write for a geometry, to replace those in printer.cfg; for a rotary delta also the
/// lengths, which its own calibration does not change. Lines of the same keys outside the block override
/// them: see klipper_config().
std::string klipper_save_config(const DeltaGeometry& geometry);

/// The configuration with a geometry in force: each of its numbers is changed at its place, in the block or typed.
/// Missing ones are added to the block. Comments and everything else stay, byte for byte. Numbers have 9
/// decimals.
/// @throws InputFileError if a number in force is in an included file (named in the message: change it there), and
/// if the firmware ignores the block, with the line that causes this.
std::string klipper_config(const TextFile& file, const DeltaGeometry& geometry);

}  // namespace paracal::io
