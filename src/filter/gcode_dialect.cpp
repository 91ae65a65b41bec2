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

bool doubt_lengths_without_points(GcodeBlock& block) {
  bool has_any = false;
  for (GcodeWord& word : block.words) {
    constexpr std::string_view kLengths = "XYZABCUVWIJKRQ", kDigits = "+-0123456789";
    const std::string_view text = block.text.substr(word.begin, word.end - word.begin);
    const bool is_length = kLengths.find(word.letter) != std::string_view::npos;
    const bool is_bare = text.find_first_not_of(kDigits) == std::string_view::npos;
    if (!word.is_number() || !is_length || !is_bare || word.value == 0.0) continue;
    word.kind = GcodeWord::Kind::doubtful;
    has_any = true;
  }
  return has_any;
}

}  // namespace paracal::io
