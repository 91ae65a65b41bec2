#include "gcode_feed.hpp"

#include <utility>

namespace paracal::io {

void GcodeFeed::set_mode(Mode mode) {
  if (std::exchange(mode_, mode) != mode) value_.reset();
}

void GcodeFeed::forget(Mode mode) {
  mode_ = mode;
  value_.reset();
}

void GcodeFeed::take(const GcodeBlock& block, std::optional<double> mm_per_unit) {
  const GcodeWord* const word = block.word('F');
  if (word == nullptr || !word->is_number()) return;
  stated_ = {word->begin, word->end, word->value};
  if (mode_ == Mode::inverse_time) {
    value_ = word->value;
  } else {
    value_ = mm_per_unit ? std::optional(word->value * *mm_per_unit) : std::nullopt;
  }
}

FeedOfLine GcodeFeed::of_line(bool is_governed, std::optional<double> mm_per_unit) const {
  FeedOfLine line{
      .counts_all_axes = counts_all_axes_, .is_stated_by_motions = is_stated_by_motions_, .stated = stated_};
  if (mode_ == Mode::unknown || !mm_per_unit) return line;
  line.rule = mode_ == Mode::inverse_time ? FeedOfLine::Rule::inverse_time : FeedOfLine::Rule::per_time;
  line.is_governed = is_governed;
  if (value_) line.value = mode_ == Mode::inverse_time ? *value_ : *value_ / *mm_per_unit;
  return line;
}

}  // namespace paracal::io
