#include "gcode_extruder.hpp"

#include <algorithm>

namespace paracal::io {

void Extruder::set_distance(bool axes_are_relative) {
  if (is_relative != axes_are_relative) is_relative.reset();  // firmwares differ in whether G90 and G91 speak of it
}

std::optional<ExtrusionOfLine> Extruder::move(const GcodeBlock& block) {
  const auto is_of_extruder = [](const GcodeWord& word) { return word.letter == 'E'; };
  const auto word = std::find_if(block.words.rbegin(), block.words.rend(), is_of_extruder);
  if (word == block.words.rend()) return ExtrusionOfLine{};
  const std::optional<double> from = is_relative == true ? 0.0 : place;
  place = is_relative == false && word->is_number() ? std::optional(word->value) : std::nullopt;
  if (!is_relative || !from || !word->is_number()) return std::nullopt;
  return ExtrusionOfLine{{word->begin, word->end, word->value}, *from, *is_relative};
}

}  // namespace paracal::io
