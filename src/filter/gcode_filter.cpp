#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "gcode_block.hpp"
#include "gcode_modes.hpp"
#include "gcode_words.hpp"
#include "io/files/letters.hpp"
#include "io/files/line_reader.hpp"
#include "paracal/error.hpp"
#include "target_line.hpp"

namespace paracal::io {
namespace {

class Gcode : public TargetFormat {
 public:
  Gcode(std::string name, const RobotAxes& axes, const GcodeOptions& options)
      : name_(std::move(name)),
        needs_points_(traits_of(options.dialect).counts_without_points),
        has_tools_(options.tools.has_value()),
        modes_(axes, options) {
    for (const std::string& one : options.harmless) harmless_.push_back(upper_case(one));
  }

  std::string_view read(std::string_view text, TargetLine& target) override {
    block_.parse(text, harmless_);
    refuse_foreign(text, target.number);
    refuse_missing_point(target.number);
    const std::string_view passed = take(target);
    const bool is_empty = block_.kind == GcodeBlock::Kind::words && block_.words.empty();
    if (target.kind == TargetLine::Kind::none && !is_empty) target.kind = TargetLine::Kind::left;
    if (target.kind != TargetLine::Kind::none) add_style(text, target);
    return passed;
  }
  std::vector<std::string> assumed() const override {
    std::vector<std::string> sentences;
    for (std::size_t axis = kFirstTurn; axis < kAxes; ++axis) {
      const char turn = kAxisLetters[axis];
      if (modes_.took_as_zero(axis)) {
        sentences.push_back(fmt::format("{} stays at 0 deg, because the program never states it", turn));
      }
      if (modes_.took_as_zero_in_systems(axis)) {
        sentences.push_back(fmt::format("{0} is 0 in coordinate systems that G10 L2 defines without {0}", turn));
      }
    }
    if (modes_.took_no_shift_before())
      sentences.emplace_back("no G92 is active before the program (else give --work-offsets)");
    if (modes_.took_tool_as_given()) {
      sentences.emplace_back("--origin includes the tool length, along Z only (else give lengths with --tools)");
    }
    if (has_tools_) sentences.emplace_back("--origin is that of a tool of length 0; --tools adds the length");
    if (modes_.trusted_macros()) sentences.emplace_back("after macros, coordinates are absolute and in mm (G90, G21)");
    return sentences;
  }

 private:
  /// @throws InputFileError for what no filter may rewrite.
  std::string_view take(TargetLine& target) {
    if (const auto complaint = implausible(block_)) fail(target.number, *complaint);
    try {
      return modes_.take(block_, target);
    } catch (const RefusedProgram& refused) {
      fail(target.number, fmt::format("expected motions, arcs, planes, units, offsets, tools and feeds, got {}; {}",
                                      refused.what(), refused.advice()));
    }
  }

  void refuse_foreign(std::string_view text, std::int64_t line) const {
    if (block_.kind != GcodeBlock::Kind::malformed && block_.kind != GcodeBlock::Kind::macro) return;
    const std::string_view language = foreign_language(text);
    if (language.empty()) return;
    fail(line, fmt::format("expected G-code, got {}; correct its targets as a table (--target csv)", language));
  }

  void refuse_missing_point(std::int64_t line) const {
    const char letter = needs_points_ ? length_without_point(block_) : '\0';
    if (letter == '\0') return;
    fail(line,
         fmt::format("expected a decimal point in {}, because the controller may count smallest steps without it; "
                     "let the post-processor write points",
                     letter));
  }

  [[noreturn]] void fail(std::int64_t line, const std::string& complaint) const {
    throw InputFileError(name_, static_cast<int>(std::min<std::int64_t>(line, std::numeric_limits<int>::max())),
                         complaint);
  }

  /// Words are added as the last axis word is written: behind it, in its case, after a blank if it stands after one;
  /// where there is none, as the words of the arc. With these go the blanks before them.
  void add_style(std::string_view text, TargetLine& target) const {
    for (const GcodeWord& word : block_.words) {
      if (target.insert_at != 0 && word.end < target.insert_at) continue;
      target.in_lower_case = text[word.at] != word.letter;
      target.with_blank = word.at > 0 && is_blank(text[word.at - 1]);
      if (word.end == target.insert_at && word.letter != 'G') break;
    }
    for (TextRange& word : target.divided.arc_words) {
      while (word.end > 0 && word.begin > 0 && is_blank(text[word.begin - 1])) --word.begin;
    }
  }

  std::string name_;
  bool needs_points_, has_tools_;
  std::vector<std::string> harmless_;
  GcodeBlock block_;
  GcodeModes modes_;
};

}  // namespace

FilterSummary filter_gcode(const TextStream& in, const TextSink& out, const TargetCorrection& correction,
                           const GcodeOptions& options) {
  LineReader lines(in);
  Gcode gcode(in.name, RobotAxes(correction.robot()), options);
  const RobotAxes axes(correction.robot(), options.origin);
  return filter(lines, out, gcode, correction, {.axes = axes, .chord = options.chord, .threads = options.threads});
}

}  // namespace paracal::io
