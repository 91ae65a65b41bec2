#pragma once

// Private to the filter: whose a word is, where it can belong to several codes of its line.

#include <optional>
#include <string>

#include "gcode_block.hpp"
#include "gcode_dialect.hpp"

namespace paracal::io {

/// A number that no program has, and a feed backwards; empty: none.
std::optional<std::string> implausible(const GcodeBlock& block);

/// T names a tool; it is no number of a firmware's code, as in M204 P1000 T2000 or M104 T0 S190.
bool names_tool(const GcodeBlock& block, const DialectTraits& traits);

/// G10 without L states temperatures of a RepRap's tool, no offset, or is a retraction.
bool sets_tool_temperature(const GcodeBlock& block, const DialectTraits& traits);

/// P states turns of an arc, and something of another code, too, as LinuxCNC has it: G64 P1, M62 P1.
bool shares_turns(const GcodeBlock& block);

/// A straight motion of single motors, or up to an endstop: RepRapFirmware's H1 to H4, S1 to S3.
/// @param has_tool_length  H is of G43.
bool moves_motors(const GcodeBlock& block, bool has_tool_length, const DialectTraits& traits);

/// E is no extruder's, but an analog output or input: M66 to M68.
bool takes_output(const GcodeBlock& block);

}  // namespace paracal::io
