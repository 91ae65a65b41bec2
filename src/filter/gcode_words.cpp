#include "gcode_words.hpp"

#include <algorithm>

#include "gcode_codes.hpp"
#include "paracal/mechanism/plausible.hpp"

namespace paracal::io {

bool names_tool(const GcodeBlock& block, const DialectTraits& traits) {
  for (const GcodeWord& word : block.words) {
    if (word.letter == 'T') return true;
    if (word.letter != 'G' && word.letter != 'M') continue;
    const int tenths = word.is_number() ? tenths_of(word.value) : -1;
    const bool takes_it = word.letter == 'M' ? takes_axis_words(tenths) : tenths == 100;
    if (takes_it || traits.is_printer) return false;
  }
  return false;
}

bool sets_tool_temperature(const GcodeBlock& block, const DialectTraits& traits) {
  if (block.has_letter("L") || traits.tool_offsets == ToolOffsets::rs274) return false;
  if (traits.tool_offsets == ToolOffsets::none || !block.has_letter("P")) return true;
  const bool is_certain = traits.tool_offsets == ToolOffsets::reprap || block.has_letter("S");
  return is_certain && !block.has_letter("XYZABCUVW");
}

bool shares_turns(const GcodeBlock& block) {
  return std::ranges::any_of(block.words, [](const GcodeWord& word) {
    const int tenths = word.is_number() ? tenths_of(word.value) : -1;
    const bool is_of_m = (tenths >= 500 && tenths <= 530) || (tenths >= 620 && tenths <= 660) ||
                         (tenths >= 1000 && tenths <= 1990);  // overrides, outputs, the owner's
    const bool is_of_g = tenths == 40 || tenths == 640;
    return (word.letter == 'M' && is_of_m) || (word.letter == 'G' && is_of_g);
  });
}

std::optional<std::string> implausible(const GcodeBlock& block) {
  constexpr plausible::Range kNumber{-1e7, 1e7}, kFeed{0.0, plausible::kSpeed.most, "", plausible::kSpeed.why};
  for (const GcodeWord& word : block.words) {
    if (!word.is_number() || word.letter == 'N') continue;
    const bool is_feed = word.letter == 'F' && !block.has_letter("M");  // of some M codes F is something else
    if (auto complaint = plausible::complaint({&word.letter, 1}, word.value, is_feed ? kFeed : kNumber))
      return complaint;
  }
  return std::nullopt;
}

bool moves_motors(const GcodeBlock& block, bool has_tool_length, const DialectTraits& traits) {
  const GcodeWord *const special = block.word('H'), *const older = block.word('S');
  const bool is_older = traits.has_special_moves_by_s && older != nullptr &&
                        (older->value == 1.0 || older->value == 2.0 || older->value == 3.0);
  const bool is_plain = special == nullptr || has_tool_length || (special->is_number() && special->value == 0.0);
  return is_older || !is_plain;
}

bool takes_output(const GcodeBlock& block) {
  return std::ranges::any_of(block.words, [](const GcodeWord& word) {
    return word.letter == 'M' && word.is_number() && word.value >= 66.0 && word.value <= 68.0;
  });
}

}  // namespace paracal::io
