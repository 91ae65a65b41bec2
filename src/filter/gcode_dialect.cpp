#include "gcode_dialect.hpp"

namespace paracal::io {

DialectTraits traits_of(GcodeDialect dialect) {
  switch (dialect) {
    case GcodeDialect::any:
      return {.defines_in_steps = true};
    case GcodeDialect::linuxcnc:
      return {.tool_offsets = ToolOffsets::rs274,
              .turns = TurnsRule::turns,
              .prepares_tools = true,
              .zero_is_current = true,
              .moves_beside_codes = true};
    case GcodeDialect::klipper:
      return {.extruder = ExtruderRule::either,
              .tool_offsets = ToolOffsets::none,
              .turns = TurnsRule::unknown,
              .is_printer = true};
    case GcodeDialect::marlin:
      return {.extruder = ExtruderRule::last_counts,
              .tool_offsets = ToolOffsets::none,
              .turns = TurnsRule::more_turns,
              .is_printer = true};
    case GcodeDialect::reprapfirmware:
      return {.extruder = ExtruderRule::codes_alone,
              .tool_offsets = ToolOffsets::reprap,
              .turns = TurnsRule::unknown,
              .is_printer = true,
              .has_special_moves_by_s = true,
              .zero_is_current = true,
              .runs_as_written = true};
    case GcodeDialect::fanuc_like:
      return {.tool_offsets = ToolOffsets::rs274,
              .turns = TurnsRule::unknown,
              .prepares_tools = true,
              .defines_in_steps = true,
              .counts_without_points = true,
              .feeds_all_axes = true};
  }
  return {};
}

char length_without_point(const GcodeBlock& block) {
  constexpr std::string_view kLengths = "XYZABCUVWIJKRQ", kPlaces = "XYZABCUVWIJK", kDigits = "+-0123456789";
  if (!block.has_letter(kPlaces)) return '\0';
  const auto is_bare = [&](const GcodeWord& word) {
    const std::string_view text = block.text.substr(word.begin, word.end - word.begin);
    return word.is_number() && word.value != 0.0 && kLengths.find(word.letter) != std::string_view::npos &&
           text.find_first_not_of(kDigits) == std::string_view::npos;
  };
  const auto found = std::ranges::find_if(block.words, is_bare);
  return found != block.words.end() ? found->letter : '\0';
}

}  // namespace paracal::io
