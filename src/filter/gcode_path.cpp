// What the line of a motion says of its path: its arc, and what dividing it takes.

#include <algorithm>

#include "gcode_modes.hpp"
#include "gcode_words.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kForeignTurns = "an arc with P, whose meaning depends on the firmware (give --dialect)";
constexpr std::string_view kOtherAxes =
    "a line to divide that also moves other axes (U, V, W; Z, A, B, C if the robot does not move along or about them)";
constexpr std::string_view kExtrusion = "a line to divide while the extrusion mode is unknown (state M82 or M83)";

constexpr std::string_view kCentreLetters = "IJK";

}  // namespace

std::string_view GcodeModes::add_arc(const GcodeBlock& block, const Request& request, bool is_clockwise,
                                     TargetPath& path) const {
  ArcWords words{.centre_is_place = *centre_is_place_};
  for (const GcodeWord& word : block.words) {
    const std::size_t axis = kCentreLetters.find(word.letter);
    const bool is_of_arc = axis != std::string_view::npos || word.letter == 'R';
    if (!is_of_arc) continue;
    const double length = word.value * *mm_per_unit_;
    if (word.letter == 'R') words.radius = length;
    if (axis != std::string_view::npos)
      words.centre[axis] = length + (words.centre_is_place ? request.shift[axis] : 0.0);
  }
  const std::string_view wrong = take_turns(block, words);
  return wrong.empty() ? make_arc(words, *normal_, is_clockwise, path) : wrong;
}

std::string_view GcodeModes::take_turns(const GcodeBlock& block, ArcWords& words) const {
  const GcodeWord* const word = block.word('P');
  if (word == nullptr) return {};
  const bool is_known = traits_.turns != TurnsRule::unknown && !(traits_.turns == TurnsRule::unless_extruding &&
                                                                 block.has_letter("E") && !takes_output(block));
  if (!is_known) return kForeignTurns;
  words.turns = word->value + (traits_.turns == TurnsRule::more_turns ? 1.0 : 0.0);
  return {};
}

/// What the line would need if it became several.
DividedLine GcodeModes::divided(const GcodeBlock& block, const Request& request, bool is_rapid) {
  DividedLine line{.motion = request.motion_word, .is_rapid = is_rapid, .stands_last = request.acts_after};
  const std::optional<ExtrusionOfLine> extrusion = takes_output(block) ? ExtrusionOfLine{} : extruder_.move(block);
  line.extrusion = extrusion.value_or(ExtrusionOfLine{});
  if (block.has_letter(other_axes_)) line.hindrance = kOtherAxes;
  if (!extrusion) line.hindrance = kExtrusion;
  const std::string_view of_arc = shares_turns(block) ? "IJKR" : "IJKRP";
  std::size_t arc_words = 0;
  const auto first = std::ranges::find_if(block.words, [](const GcodeWord& word) { return word.letter != 'N'; });
  if (line.motion.is_empty() && first != block.words.end()) line.motion = {first->at, first->at};
  for (const GcodeWord& word : block.words) {
    if (of_arc.find(word.letter) != std::string_view::npos && arc_words < line.arc_words.size()) {
      line.arc_words[arc_words++] = {word.at, word.end};
    }
  }
  return line;
}

/// A line that relies on the mode of an arc that has become lines.
void GcodeModes::restate_arc(const GcodeBlock& block, const Request& request, bool is_left, TargetLine& target) const {
  if (!arcs_are_lines_ || request.motion || !is_arc(motion_) || request.takes_axes) return;
  if (!block.has_letter("XYZABCIJKR")) return;
  if (is_left && target.kind == TargetLine::Kind::none) target.kind = TargetLine::Kind::left;
  target.restated = motion_ == Motion::clockwise ? "2" : "3";
}

}  // namespace paracal::io
