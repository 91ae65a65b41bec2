#include "gcode_words.hpp"

#include "gcode_codes.hpp"

namespace paracal::io {

bool names_tool(const GcodeBlock& block, const DialectTraits& traits) {
  for (const GcodeWord& word : block.words) {
    if (word.letter == 'T') return true;
    if (word.letter != 'G' && word.letter != 'M') continue;
    const int tenths = word.is_number() ? tenths_of(word.value) : -1;
    const bool takes_it = word.letter == 'M' ? takes_axis_words(tenths) : tenths == 100;
    if (takes_it || traits.has_one_code) return false;
  }
  return false;
}

bool sets_tool_temperature(const GcodeBlock& block, const DialectTraits& traits) {
  if (block.has_letter("L") || traits.tool_offsets == ToolOffsets::rs274) return false;
  if (traits.tool_offsets == ToolOffsets::none) return true;
  const bool is_certain = traits.tool_offsets == ToolOffsets::reprap || block.has_letter("S");
  return is_certain && !block.has_letter("XYZABCUVW");
}

}  // namespace paracal::io
