#include "gcode_block.hpp"
#include "gcode_expression.hpp"
#include "gcode_lines.hpp"
#include "gcode_modes.hpp"
#include "io/letters.hpp"
#include "target_line.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kWithoutPoint = "a length without a decimal point, which may count smallest steps";

class Gcode : public TargetFormat {
 public:
  Gcode(const GcodeLines& lines, std::size_t axis_count, const GcodeOptions& options)
      : lines_(lines), doubts_lengths_(traits_of(options.dialect).counts_without_points), modes_(axis_count, options) {
    for (const std::string& name : options.harmless) harmless_.push_back(upper_case(name));
  }

  std::string_view read(std::string_view text, TargetLine& target) override {
    block_.parse(text, harmless_);
    if (parameters_.apply(block_)) modes_.forget_systems();
    const bool is_doubtful = doubts_lengths_ && doubt_lengths_without_points(block_);
    std::string_view passed = modes_.take(block_, target);
    if (is_doubtful && !passed.empty()) passed = kWithoutPoint;
    if (target.number == lines_.unfollowed_line()) passed = lines_.why_unfollowed();
    if (modes_.has_forgotten()) parameters_.forget();
    if (target.kind != TargetLine::Kind::none) add_style(text, target);
    if (unread_ > 0 && --unread_ == 0) modes_.resume_cycle();
    return passed;
  }
  std::vector<std::string> instead() override {
    std::vector<std::string> lines = modes_.instead();
    unread_ += lines.size();
    has_cycles_ |= lines.size() > 1;
    return lines;
  }
  void skip() override {
    modes_.forget();
    parameters_.forget();
  }
  std::vector<std::string> assumed() const override {
    std::vector<std::string> sentences;
    if (modes_.took_rotation_as_zero()) sentences.emplace_back("C, which the program never states, stays at 0 deg");
    if (modes_.took_rotation_of_systems_as_zero()) {
      sentences.emplace_back("C is 0 in the origin of systems that G10 L2 defines without it");
    }
    if (has_cycles_) sentences.emplace_back("canned cycles move as LinuxCNC has it");
    if (modes_.has_pecked()) {
      sentences.emplace_back("G73 and G83 go back to 0.254 mm above where they were, as LinuxCNC does by default");
    }
    if (lines_.is_unrolled()) {
      sentences.emplace_back("parameters and subprograms are those of this file: its O words have been carried out");
    }
    return sentences;
  }

 private:
  /// Words are added as the last axis word is written: behind it, in its case, after a blank if it stands after one;
  /// where there is none, as the words of the arc. With these go the blanks before them.
  void add_style(std::string_view text, TargetLine& target) const {
    for (const GcodeWord& word : block_.words) {
      if (target.insert_at != 0 && word.end < target.insert_at) continue;
      target.in_lower_case = text[word.at] != word.letter;
      target.with_blank = word.at > 0 && is_blank(text[word.at - 1]);
      if (word.end == target.insert_at && word.letter != 'G') break;
    }
    target.checksum_at = block_.checksum_at;
    for (TextRange& word : target.divided.arc_words) {
      while (word.end > 0 && word.begin > 0 && is_blank(text[word.begin - 1])) --word.begin;
    }
  }

  const GcodeLines& lines_;
  bool doubts_lengths_;
  std::vector<std::string> harmless_;
  GcodeBlock block_;
  GcodeParameters parameters_;
  GcodeModes modes_;
  std::size_t unread_ = 0;  ///< lines that stand for a canned cycle
  bool has_cycles_ = false;
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
