#pragma once

// Private to io: whose a word is, where it can belong to several codes of its line.

#include "gcode_block.hpp"
#include "gcode_dialect.hpp"

namespace paracal::io {

/// T names a tool; it is no number of a firmware's code, as in M204 P1000 T2000 or M104 T0 S190.
bool names_tool(const GcodeBlock& block, const DialectTraits& traits);

/// G10 without L states temperatures of a RepRap's tool, no offset, or is Marlin's or Klipper's retraction.
bool sets_tool_temperature(const GcodeBlock& block, const DialectTraits& traits);

}  // namespace paracal::io
