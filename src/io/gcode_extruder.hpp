#pragma once

// Private to io: the extruder of a printer, in G-code.

#include <optional>

#include "gcode_block.hpp"
#include "target_line.hpp"

namespace paracal::io {

/// What a printer's program says of its extruder.
struct Extruder {
  std::optional<bool> is_relative = false;  ///< M83; by G91 for some firmwares, so unknown after it
  std::optional<double> place = {};

  void forget() { *this = {.is_relative = std::nullopt}; }
  void set_distance(bool axes_are_relative);
  /// @returns what a motion does; nothing where that is unknown.
  std::optional<ExtrusionOfLine> move(const GcodeBlock& block);
};

}  // namespace paracal::io
