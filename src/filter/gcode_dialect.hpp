#pragma once

// Private to the filter: what controllers read differently.

#include <cstdint>

#include "gcode_block.hpp"
#include "paracal/filter/target_filter.hpp"

namespace paracal::io {

/// What decides whether E is a place or a step.
enum class ExtruderRule : std::uint8_t {
  unknown,      ///< M82, M83; G90 and G91 too, or not
  codes_alone,  ///< M82, M83
  last_counts,  ///< M82, M83, G90, G91
  either,       ///< a step where M83 or G91 holds
};

/// What G10 without L is.
enum class ToolOffsets : std::uint8_t {
  unknown,  ///< one of these
  rs274,    ///< an offset
  reprap,   ///< offsets of a tool, where axes are named, and its temperatures
  none,     ///< retraction
};

/// What P of an arc is.
enum class TurnsRule : std::uint8_t {
  unless_extruding,  ///< turns, but of a printer's arcs not known
  turns,
  more_turns,  ///< beside the arc itself
  unknown,
};

struct DialectTraits {
  ExtruderRule extruder = ExtruderRule::unknown;
  ToolOffsets tool_offsets = ToolOffsets::unknown;
  TurnsRule turns = TurnsRule::unless_extruding;
  /// A firmware: a line has one code, whose letters are numbers of that; G0 moves at feed, there is no G93, planes and
  /// centres are those of G17 and G91.1.
  bool is_printer = false;
  bool has_special_moves_by_s = false;  ///< G1 S1 to S3, as G1 H1 to H3
  bool prepares_tools = false;          ///< T chooses, M6 changes
  bool zero_is_current = false;         ///< the system P0 of G10 L2
  bool defines_in_steps = false;        ///< G91 G10 L2 adds, or may
  bool runs_as_written = false;         ///< codes of a line in the order of its words, not in that of RS-274
  bool counts_without_points = false;   ///< lengths without a decimal point are numbers of smallest steps
  bool feeds_all_axes = false;          ///< F counts along A, B and C, too, deg as mm
  /// Axis words beside G28.1, G30.1, G50 and G92.1 to G92.3 are a motion; for others they belong to the code.
  bool moves_beside_codes = false;
};

DialectTraits traits_of(GcodeDialect dialect);

/// The letter of a place or a length that has no decimal point; '\0': none. Zero needs none.
char length_without_point(const GcodeBlock& block);

}  // namespace paracal::io
