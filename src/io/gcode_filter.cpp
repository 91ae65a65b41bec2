#include <algorithm>

#include "gcode_block.hpp"
#include "gcode_expression.hpp"
#include "gcode_lines.hpp"
#include "gcode_modes.hpp"
#include "paracal/units.hpp"
#include "target_line.hpp"

namespace paracal::io {
namespace {

std::optional<AxisValues> axis_values(const std::optional<Pose>& pose) {
  if (!pose) return std::nullopt;
  const Eigen::Vector3d& r = pose->position;
  return AxisValues{r.x(), r.y(), r.z(), to_degrees(pose->rotation)};
}

char upper_case(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

class Gcode : public TargetFormat {
 public:
  Gcode(const GcodeLines& lines, std::size_t axis_count, const GcodeOptions& options)
      : lines_(lines), harmless_(options.harmless), modes_(axis_count, axis_values(options.start)) {
    for (std::string& name : harmless_) std::ranges::transform(name, name.begin(), upper_case);
  }

  std::string_view read(std::string_view text, TargetLine& target) override {
    block_.parse(text, harmless_);
    if (parameters_.apply(block_)) modes_.move_origin();
    std::string_view passed = modes_.take(block_, target);
    if (!passed.empty() && target.number == lines_.unfollowed_line()) passed = lines_.why_unfollowed();
    if (modes_.has_forgotten()) parameters_.forget();
    if (target.kind != TargetLine::Kind::none) add_style(text, target);
    return passed;
  }
  void skip() override {
    modes_.forget();
    parameters_.forget();
  }
  std::vector<std::string> assumed() const override {
    std::vector<std::string> sentences;
    if (modes_.took_rotation_as_zero()) sentences.emplace_back("C, which the program never states, stays at 0 deg");
    if (lines_.is_unrolled()) {
      sentences.emplace_back("parameters and subprograms are those of this file: its O words have been carried out");
    }
    return sentences;
  }

 private:
  /// Words are added as the last axis word is written: behind it, in its case, after a blank if it stands after one;
  /// where there is none, as the words of the arc. With these go the blanks before them.
  void add_style(std::string_view text, TargetLine& target) const {
    const auto is_blank = [text](std::size_t at) { return text[at] == ' ' || text[at] == '\t'; };
    for (const GcodeWord& word : block_.words) {
      if (target.insert_at != 0 && word.end < target.insert_at) continue;
      target.in_lower_case = text[word.at] != word.letter;
      target.with_blank = word.at > 0 && is_blank(word.at - 1);
      if (word.end == target.insert_at && word.letter != 'G') break;
    }
    target.checksum_at = block_.checksum_at;
    for (TextRange& word : target.divided.arc_words) {
      while (word.end > 0 && word.begin > 0 && is_blank(word.begin - 1)) --word.begin;
    }
  }

  const GcodeLines& lines_;
  std::vector<std::string> harmless_;
  GcodeBlock block_;
  GcodeParameters parameters_;
  GcodeModes modes_;
};

}  // namespace

FilterSummary filter_gcode(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                           const GcodeOptions& options) {
  GcodeLines lines(in);
  Gcode gcode(lines, correction.robot().limb_count(), options);  // as many axes as limbs
  return filter(lines, out, gcode, correction,
                {.origin = options.origin, .chord = options.chord, .threads = options.threads});
}

}  // namespace paracal::io
