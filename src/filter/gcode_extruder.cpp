#include "gcode_extruder.hpp"

#include <algorithm>

namespace paracal::io {

void Extruder::set_relative(bool is_relative) {
  is_relative_ = is_relative;
  place_.reset();
}

void Extruder::set_distance(bool axes_are_relative) {
  axes_are_relative_ = axes_are_relative;
  if (rule_ == ExtruderRule::last_counts) is_relative_ = axes_are_relative;
  if (rule_ == ExtruderRule::unknown && is_relative_ != axes_are_relative) is_relative_.reset();
}

std::optional<bool> Extruder::is_relative() const {
  if (rule_ != ExtruderRule::either || is_relative_ == true) return is_relative_;
  return axes_are_relative_ == true           ? axes_are_relative_
         : is_relative_ && axes_are_relative_ ? is_relative_
                                              : std::nullopt;
}

std::optional<ExtrusionOfLine> Extruder::move(const GcodeBlock& block) {
  const auto is_of_extruder = [](const GcodeWord& word) { return word.letter == 'E'; };
  const auto word = std::find_if(block.words.rbegin(), block.words.rend(), is_of_extruder);
  if (word == block.words.rend()) return ExtrusionOfLine{};
  const std::optional<bool> is_step = is_relative();
  const std::optional<double> from = is_step == true ? 0.0 : place_;
  place_ = is_step == false && word->is_number() ? std::optional(word->value) : std::nullopt;
  if (!is_step || !from || !word->is_number()) return std::nullopt;
  return ExtrusionOfLine{{word->begin, word->end, word->value}, *from, *is_step};
}

}  // namespace paracal::io
