// LinuxCNC's tool table [linuxcnc, tool table], and lists of words that move nothing.

#include <fmt/format.h>

#include <algorithm>

#include "gcode_block.hpp"
#include "gcode_codes.hpp"
#include "io/files/letters.hpp"
#include "io/tables/columns.hpp"
#include "paracal/error.hpp"
#include "paracal/filter/target_filter.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kLetters = "TPXYZABCUVWDIJQ";

/// T1 P1 Z50.2: numbers behind letters that a table has.
bool is_row(const GcodeBlock& block) {
  return block.kind == GcodeBlock::Kind::words && std::ranges::all_of(block.words, [](const GcodeWord& word) {
           return word.is_number() && kLetters.find(word.letter) != std::string_view::npos;
         });
}

/// A code that moves nothing for all controllers may be named; a motion may not.
bool moves_axes(std::string_view word) {
  GcodeBlock block;
  block.parse(word);
  if (block.kind != GcodeBlock::Kind::words || block.words.empty() || block.words[0].letter != 'G') return false;
  const Code* const code = find_code(tenths_of(block.words[0].value));
  return code != nullptr && code->effect != Effect::none;
}

}  // namespace

ToolTable read_tool_table(const TextFile& file) {
  ToolTable tools;
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    ++number;
    GcodeBlock block;
    block.parse(line);
    if (is_row(block) && block.words.empty()) continue;
    const GcodeWord* const tool = block.word('T');
    const bool is_tool = tool != nullptr && tool->is_whole(0.0, kMostTool);
    if (!is_row(block) || !is_tool) {
      throw InputFileError(
          file.name, number,
          fmt::format("expected a tool as in LinuxCNC's table (T1 P1 Z50.2), got {}", quoted(std::string(line))));
    }
    ProgramAxes offset{};
    for (std::size_t axis = 0; axis < offset.size(); ++axis) {
      if (const GcodeWord* const word = block.word(kAxisLetters.at(axis))) offset.at(axis) = word->value;
    }
    if (!tools.emplace(static_cast<int>(tool->value), offset).second) {
      throw InputFileError(file.name, number, fmt::format("expected each tool once, got T{} again", tool->value));
    }
  }
  if (tools.empty()) throw InputFileError(file.name, 0, "expected one tool per line (T1 P1 Z50.2), got none");
  return tools;
}

std::vector<std::string> read_harmless_words(const TextFile& file) {
  std::vector<std::string> words;
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    ++number;
    const std::string_view word = trimmed(line.substr(0, line.find('#')));
    if (word.empty()) continue;
    if (word.find_first_of(" \t") != std::string_view::npos || moves_axes(word)) {
      throw InputFileError(
          file.name, number,
          fmt::format("expected one word per line that moves nothing (SNAP, G187), got {}", quoted(std::string(word))));
    }
    words.push_back(upper_case(word));
  }
  return words;
}

}  // namespace paracal::io
