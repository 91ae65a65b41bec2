// What the motions of a program come to, once its modes are known.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "gcode_modes.hpp"
#include "gcode_words.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kElsewhere = "homing, probing and threads";
constexpr std::string_view kMotors = "a motion of single motors or up to an endstop (H)";
constexpr std::string_view kRestorePoint = "a motion relative to a saved position, or with a rounded corner (R)";
constexpr std::string_view kMCode = "axis words of an M code";
constexpr std::string_view kModes = "a motion whose mode is unknown (G0 or G1, G90, G20 or G21)";
constexpr std::string_view kHeldPlane = "an arc in a plane in which the robot does not move (G18, G19)";
constexpr std::string_view kTurnedTool = "a tool length (G43) while the plate tilts",
                           kPlateAlone = "let the post-processor compute the path of the plate, without G43";
constexpr std::string_view kPlane = "an arc whose plane (G17) or kind of centre (G91.1) is unknown";
constexpr std::string_view kOfArc = "XYZABCUVWIJKRPEFS", kOfMotion = "XYZABCUVWIJKREFS";
constexpr std::string_view kNumber = "state its number, or remove the word";
constexpr std::string_view kArcStart = "an arc from an unknown position";
constexpr std::string_view kOtherOrigin = "another origin than at the first corrected target (give --work-offsets)";
constexpr std::string_view kOtherTool = "another tool than at the first corrected target (give --tools)";
constexpr std::string_view kIncremental = "an incremental motion (G91) from an unknown position (give --start)";
constexpr std::string_view kRewrittenMode =
    "a line without its motion (G2, G3) after a rewritten line and a line that may have changed it";

/// What made an axis unknown stands above the line that needs it; what to do is the same.
std::string_view unknown(std::size_t axis) {
  static const auto kSentences = [] {
    std::array<std::string, kAxes> sentences;
    for (std::size_t k = 0; k < kAxes; ++k) {
      sentences.at(k) = fmt::format(
          "{} is unknown: state it with G0 or G1 after homing, tool changes, offsets, G43 and macros (or give "
          "--start=X,Y,Z, and lengths with --tools)",
          kAxisLetters.at(k));
    }
    return sentences;
  }();
  return kSentences.at(axis);
}

StatedNumber number_of(const GcodeWord& word) { return {word.begin, word.end, word.value}; }

}  // namespace

/// Controllers that read "Fnan" or "X" take the number for 0, or stop. Letters of other codes stand alone: G28 X.
void GcodeModes::refuse_missing_numbers(const GcodeBlock& block, const Axes& axes, const Request& request) const {
  const bool is_others = request.takes_axes || request.has_m_code;
  const bool is_motion = request.motion || (axes.count > 0 && !is_others);
  const std::string_view used = is_motion          ? (is_arc(request.motion.value_or(motion_)) ? kOfArc : kOfMotion)
                                : request.is_dwell ? "XUPS"
                                : is_others        ? ""
                                                   : "FS";
  for (const GcodeWord& word : block.words) {
    const bool is_missing = word.kind == GcodeWord::Kind::flag || word.kind == GcodeWord::Kind::text;
    if (!is_missing || used.find(word.letter) == std::string_view::npos) continue;
    throw RefusedProgram(std::string(1, word.letter) + " without a finite number", kNumber);
  }
}

std::string_view GcodeModes::move(const GcodeBlock& block, const Axes& axes, Request& request, TargetLine& target) {
  if (request.calls_here) {
    call_here(axes, target);
    return {};
  }
  if (request.goes_elsewhere) {
    lose_all();
    target.weight = request.is_thread ? TargetLine::Weight::work
                    : request.is_idle ? TargetLine::Weight::idle
                                      : TargetLine::Weight::approach;
    // Homing alone states no target, and so leaves nothing uncorrected.
    return axes.has_number || !request.takes_axes ? kElsewhere : std::string_view();
  }
  if (request.takes_axes) return {};
  const Motion motion = request.motion.value_or(motion_);
  const bool is_full_circle = is_arc(motion) && block.has_letter("IJKR");
  if (axes.count == 0 && !is_full_circle) {
    if (!request.has_m_code || request.motion) extruder_.move(block);
    return {};
  }
  has_moved_ = true;
  const auto give_up = [&](std::string_view why) {
    lose(axes);
    extruder_.forget_place();
    return why;
  };
  if (request.has_m_code && !request.motion) return request.is_setting ? std::string_view() : give_up(kMCode);
  target.weight = weight_of(block, axes, motion);
  target.feed.is_governed = moves_at_feed(motion);
  if (const std::string_view why = why_special(block, request, motion, target); !why.empty()) return give_up(why);
  if (motion == Motion::unknown && lost_rewritten_mode_) {
    target.breaks = true;
    return give_up(kRewrittenMode);
  }
  if (motion == Motion::unknown || motion == Motion::none || distance_ == Distance::unknown || !mm_per_unit_) {
    return give_up(kModes);
  }
  if (const std::string_view why = find_shift(request, motion); !why.empty()) return give_up(why);
  return move_to(block, axes, request, target);
}

/// Where the numbers of a line lie in the frame of the first target.
std::string_view GcodeModes::find_shift(Request& request, Motion motion) const {
  const bool may_be_in_machine =
      (motion == Motion::rapid || motion == Motion::straight) && distance_ == Distance::absolute;
  if (request.in_machine && !may_be_in_machine) return kOtherOrigin;
  const GcodeOrigin::Change shift = request.in_machine ? origin_.shift_of_machine() : origin_.shift();
  for (const std::size_t axis : robot_axes_.moved()) {
    if (!shift[axis]) return !request.in_machine && origin_.is_other_tool() ? kOtherTool : kOtherOrigin;
    request.shift[axis] = *shift[axis];
  }
  return {};
}

/// Straight motions whose words are no places.
std::string_view GcodeModes::why_special(const GcodeBlock& block, const Request& request, Motion motion,
                                         TargetLine& target) {
  if (motion != Motion::rapid && motion != Motion::straight) return {};
  if (moves_motors(block, request.has_tool_length, traits_)) {
    if (!traits_.is_printer) throw RefusedProgram("H without G43", "state G43 with H");
    target.weight = TargetLine::Weight::idle;  // so printers are homed
    lose_all();
    return kMotors;
  }
  return block.has_letter("R") ? kRestorePoint : std::string_view();
}

/// A motion in the origin's frame: axes that it states as numbers are known from now on.
std::string_view GcodeModes::move_to(const GcodeBlock& block, const Axes& axes, const Request& request,
                                     TargetLine& target) {
  const Motion motion = request.motion.value_or(motion_);
  const Places from = place_;
  target.passed = passed_;
  target.divided = divided(block, request, motion == Motion::rapid);
  const bool is_incremental = distance_ == Distance::incremental;
  for (const std::size_t axis : robot_axes_.moved()) {
    const GcodeWord* const word = axes.word[axis];
    if (word == nullptr) continue;
    place_[axis].reset();
    const double stated = in_mm(axis, *word);
    if (word->is_number() && !is_incremental) place_[axis] = stated + request.shift[axis];
    if (word->is_number() && is_incremental && from[axis]) place_[axis] = *from[axis] + stated;
    passed_[axis] = true;
  }
  std::string_view passed = why_unknown(from, motion);
  if (passed.empty()) {
    for (const std::size_t axis : robot_axes_.moved()) {
      target.path.to[axis] = *place_[axis];
      target.path.from[axis] = from[axis].value_or(*place_[axis]);
    }
    target.starts_known =
        std::ranges::all_of(robot_axes_.moved(), [&](std::size_t axis) { return from[axis].has_value(); });
    if (is_arc(motion)) passed = add_arc(block, request, motion == Motion::clockwise, target.path);
  }
  if (!passed.empty()) {
    if (is_incremental) lose(axes);
    return passed;
  }
  if (turns_tool(target.path)) throw RefusedProgram(kTurnedTool, kPlateAlone);
  state(axes, request, target);
  passed_.fill(false);
  origin_.fix();
  for (Rotation& rotation : rotations_) {
    if (rotation == Rotation::unstated) rotation = Rotation::taken_as_zero;
  }
  arcs_are_lines_ |= target.path.is_arc();
  trusted_macros_ |= relies_on_macro_;
  return {};
}

std::string_view GcodeModes::why_unknown(const Places& from, Motion motion) const {
  for (const std::size_t axis : robot_axes_.moved()) {
    if (!place_[axis]) return distance_ == Distance::incremental ? kIncremental : unknown(axis);
    if (is_arc(motion) && !from[axis]) return kArcStart;
  }
  if (!is_arc(motion)) return {};
  if (!normal_ || !centre_is_place_) return kPlane;
  const bool is_held = !robot_axes_.moves((*normal_ + 1) % 3) || !robot_axes_.moves((*normal_ + 2) % 3);
  return is_held ? kHeldPlane : std::string_view();
}

/// A controller adds a tool's offset along its own axes; the tool goes elsewhere where the plate tilts about another.
bool GcodeModes::turns_tool(const TargetPath& path) const {
  for (std::size_t about = 0; robot_axes_.tilt_plate() && about < 3; ++about) {
    const std::size_t turn = kFirstTurn + about;
    if (path.from[turn] == 0.0 && path.to[turn] == 0.0) continue;
    if (origin_.has_tool_along((about + 1) % 3) || origin_.has_tool_along((about + 2) % 3)) return true;
  }
  return false;
}

void GcodeModes::state(const Axes& axes, const Request& request, TargetLine& target) const {
  target.kind = TargetLine::Kind::target;
  target.may_insert = true;
  target.mm_per_unit = *mm_per_unit_;
  target.shift = request.shift;
  target.is_incremental = distance_ == Distance::incremental;
  for (const std::size_t axis : robot_axes_.moved()) {
    const GcodeWord* const word = axes.word[axis];
    if (word == nullptr) continue;
    target.stated[axis] = number_of(*word);
    target.insert_at = std::max(target.insert_at, word->end);
  }
  if (target.insert_at == 0) target.insert_at = target.divided.motion.end;  // a full circle
}

void GcodeModes::call_here(const Axes& axes, TargetLine& target) {
  target.kind = TargetLine::Kind::here;
  target.mm_per_unit = *mm_per_unit_;
  target.passed = passed_;
  for (const std::size_t axis : robot_axes_.moved()) {
    if (place_[axis]) target.path.from[axis] = target.path.to[axis] = *place_[axis];
    if (axes.word[axis] != nullptr) target.stated[axis] = number_of(*axes.word[axis]);
  }
  origin_.call(place_, in_mm(axes));
}

}  // namespace paracal::io
