#pragma once

// Private to the filter: what the codes of G-code do to targets.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace paracal::io {

/// What a G code does to targets.
enum class Effect : std::uint8_t {
  none,   ///< spindle modes, speeds, path modes, the end of offsets that no program has begun
  alone,  ///< the end of scaling and mirroring (G50, G50.1): axis words are those of the code
  rapid,
  straight,
  clockwise,
  anticlockwise,
  plane,
  centre_is_place,  ///< of arcs
  centre_from_start,
  inverse_time,
  feed_per_time,
  feed_per_turn,
  cycle,  ///< drilling; levelling for printers
  no_motion,
  probe,
  thread,
  home,         ///< homing, levelling
  reference,    ///< G28.1, G30.1: store the place; with axis words some controllers home these axes
  saved_place,  ///< of printers: G61 goes back to it
  dwell,        ///< in X for some controllers, if it has no P
  absolute,
  incremental,
  inch,
  mm,
  inch_if_bare,  ///< Mach3's; a lathe's cycle where it has other words
  mm_if_bare,
  in_machine,
  system,
  tool_length,          ///< G43
  tool_length_by_axes,  ///< G43.1: axis words say how long
  no_tool_length,
  define,      ///< G10
  shift_axes,  ///< G92: of the extruder alone, if it has E and no axis
  no_shift,
  restored_shift,  ///< G92.3
  local_shift,     ///< G52
  refused,
};

struct Code {
  Effect effect = Effect::none;
  /// When LinuxCNC carries it out, wherever it stands in its line: 0 first  [linuxcnc, order of execution].
  int stage = 0;
  std::optional<std::size_t> normal = {};  ///< axis of a plane
  std::string_view refusal = {};           ///< what it is, where it is refused
};

/// 10 times the code; -1 for what no code is.
int tenths_of(double code);

/// Of M codes, but what stops, which comes last and changes nothing before.
inline constexpr int kStageOfM = 1;

/// @param tenths  10 times the code.
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
  subprogram,  ///< a macro for printers
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
