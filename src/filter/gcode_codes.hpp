#pragma once

// Private to io: what the codes of G-code do to targets.

#include <cstddef>
#include <cstdint>
#include <optional>

namespace paracal::io {

/// What a G code does to targets.
enum class Effect : std::uint8_t {
  none,  ///< spindle modes, speeds
  rapid,
  straight,
  clockwise,
  anticlockwise,
  spline,
  plane,
  centre_is_place,  ///< of arcs
  centre_from_start,
  inverse_time,
  feed_per_time,
  cycle,
  path_mode,
  save_place,
  return_to_start,  ///< of cycles
  return_to_clearance,
  no_motion,
  probe,
  thread,
  home,   ///< homing, stored places, levelling
  dwell,  ///< in X for some controllers, if it has no P
  absolute,
  incremental,
  inch,
  mm,
  in_machine,
  system,
  tool_length,
  tool_length_by_axes,  ///< axis words say by how much
  no_tool_length,
  shift,
  shift_by_axes,
  shift_if_stated,  ///< G10: RepRap's retraction, if it has neither L nor P
  shift_axes,       ///< G92: of the extruder alone, if it has E and no axis
  flow,
  transform,
  transform_by_axes,  ///< axis words say about what
  no_transform,
};

struct Code {
  int tenths;  ///< 10 times the code
  Effect effect;
  unsigned transform = 0;                  ///< bit
  std::optional<std::size_t> normal = {};  ///< axis of a plane
};

inline constexpr unsigned kRadius = 1, kTurn = 2, kScale = 4, kMirror = 8, kPolar = 16, kDiameter = 32;

/// 10 times the code; -1 for what no code is.
int tenths_of(double code);

/// When LinuxCNC carries a code of a line out, wherever it stands: 0 first  [linuxcnc, order of execution].
int stage_of(Effect effect);
inline constexpr int kStageOfM = 1;  ///< M codes, but what stops, which comes last and changes nothing before

/// @returns null where the code is not known here.
const Code* find_code(int tenths);

/// What an M code does to targets, besides giving axis words another meaning.
enum class MEffect : std::uint8_t {
  none,
  pause,                 ///< after the motion of its line
  end,                   ///< of the program, after the motion of its line
  end_of_modes,          ///< modes that are kept or restored
  end_of_modes_if_bare,  ///< with words it is RepRap's and says how far the print is
  tool_change,
  flow,
  absolute_extrusion,
  relative_extrusion,
  motors_off,
  setting,  ///< of RepRap firmwares: axis words are numbers of the firmware's, not places
  shift,    ///< of the origin
};

/// @param tenths  10 times the code.
MEffect effect_of_m(int tenths);

/// Of M codes that RepRap firmwares give axis words; beside those of RS-274 such words are a motion's.
/// @param tenths  10 times the code.
bool takes_axis_words(int tenths);

}  // namespace paracal::io
