// What the motions of a program come to, once its modes are known.

#include <algorithm>
#include <array>

#include "gcode_modes.hpp"
#include "gcode_words.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kElsewhere = "homing, probing and threads";
constexpr std::string_view kMotors = "a motion of single motors or up to an endstop (H), or another tool's length";
constexpr std::string_view kRestorePoint = "a motion relative to a saved place, or with a rounded corner (R)";
constexpr std::string_view kMCode = "axis words of an M code";
constexpr std::string_view kModes = "unclear whether G0 or G1, G90, G20 or G21 hold";
constexpr std::string_view kPlane = "an arc, and unclear in which plane (G17) and how its centre is stated (G91.1)";
constexpr std::string_view kArcStart = "an arc from a place that is not known";
constexpr std::string_view kSpline = "splines";
constexpr std::string_view kOtherOrigin = "another origin than that of the first corrected target";
constexpr std::string_view kTransformed = "offset, turned or scaled path";
constexpr std::string_view kIncremental = "incremental (G91) from a place that is not known";

constexpr std::string_view kCycleWords =
    "a canned cycle on a line that turns C, moves other axes, assigns parameters, stops, ends, changes the tool or has "
    "a checksum";
constexpr std::string_view kCycleStart = "a canned cycle from a place that is not known";
constexpr std::string_view kRewrittenMode =
    "a line without its motion (G2, G3, G81 to G89) behind one that was rewritten and one that may have changed it";

StatedNumber number_of(const GcodeWord& word) { return {word.begin, word.end, word.value}; }

}  // namespace

std::string_view GcodeModes::move(const GcodeBlock& block, const Axes& axes, Request& request, TargetLine& target) {
  if (request.calls_here) {
    call_here(axes, target);
    return {};
  }
  if (request.goes_elsewhere) {
    lose_all(Loss::elsewhere);
    target.is_work = request.is_thread;
    // Homing alone states no target, and so leaves nothing uncorrected.
    return axes.has_number || axes.has_expression || !request.takes_axes ? kElsewhere : std::string_view();
  }
  if (request.takes_axes) return {};
  const Motion motion = request.motion.value_or(motion_);
  const bool is_full_circle = is_arc(motion) && block.has_letter("IJKR");
  if (axes.count == 0 && !is_full_circle) {
    if (!request.has_m_code || request.motion) extruder_.move(block);
    return {};
  }
  const auto give_up = [&](std::string_view why) {
    lose(axes);
    extruder_.forget_place();
    return why;
  };
  if (request.has_m_code && !request.motion) return request.is_setting ? std::string_view() : give_up(kMCode);
  target.is_work = axes.has_flag || is_work(block, axes, motion);
  if (axes.has_flag) {
    forget();
    return kMalformed;
  }
  if (const std::string_view why = why_special(block, request, motion, target); !why.empty()) return give_up(why);
  if (motion == Motion::unknown && lost_rewritten_mode_) {
    target.breaks = true;
    return give_up(kRewrittenMode);
  }
  if (motion == Motion::unknown || motion == Motion::none || distance_ == Distance::unknown || !mm_per_unit_) {
    return give_up(kModes);
  }
  if (motion == Motion::cycle && normal_) cycle_.take(block, *normal_);
  std::string_view passed;
  if (transforms_ != 0) passed = kTransformed;
  const bool is_straight = motion == Motion::rapid || motion == Motion::straight;
  const auto shift =
      request.in_machine && is_straight && distance_ == Distance::absolute ? origin_.shift_of_machine() : std::nullopt;
  if (request.in_machine ? !shift : !origin_.is_first()) passed = kOtherOrigin;
  request.shift = request.in_machine ? shift.value_or(AxisValues{}) : origin_.shift();
  if (motion == Motion::cycle) return expand_cycle(block, axes, request, passed, target);
  return passed.empty() ? move_to(block, axes, request, target) : give_up(passed);
}

/// Straight motions whose words are no places.
std::string_view GcodeModes::why_special(const GcodeBlock& block, const Request& request, Motion motion,
                                         TargetLine& target) {
  if (motion != Motion::rapid && motion != Motion::straight) return {};
  if (moves_motors(block, request.has_tool_length, traits_)) {
    target.is_work = false;  // so printers are homed
    if (!traits_.has_one_code) shift_origin();
    lose_all(Loss::motors);
    return kMotors;
  }
  return block.has_letter("R") ? kRestorePoint : std::string_view();
}

/// Approach and retreat are rapid, or go along Z alone.
bool GcodeModes::is_work(const GcodeBlock& block, const Axes& axes, Motion motion) {
  const bool is_across = axes.count > (axes.word[2] != nullptr ? 1U : 0U);
  if (is_arc(motion) || motion == Motion::cycle) return true;
  return is_across && (motion != Motion::rapid || block.has_letter("E"));
}

/// @param passed  why it cannot be taken, whatever it is; else empty.
std::string_view GcodeModes::expand_cycle(const GcodeBlock& block, const Axes& axes, const Request& request,
                                          std::string_view passed, TargetLine& target) {
  const bool is_known = normal_ && place_[*normal_];
  if (passed.empty() && !is_known) passed = kCycleStart;
  if (passed.empty() && axes.has_expression) passed = kExpression;
  if (passed.empty() && inverse_time_ != false) passed = kInverseTime;
  const bool acts_after = request.acts_after || request.then_lost.has_value() || request.then_unknown;
  const bool is_simple = !acts_after && block.checksum_at == 0 && block.assignments.empty();
  if (passed.empty() && !(is_simple && !block.has_letter("ABCUVWE"))) passed = kCycleWords;
  if (passed.empty()) {
    const CycleStart start{.normal = *normal_,
                           .place = *place_[*normal_],
                           .shift = request.shift[*normal_],
                           .mm_per_unit = *mm_per_unit_,
                           .is_incremental = distance_ == Distance::incremental};
    const TextRange word = request.motion_word;
    passed = cycle_.expand(block, word.is_empty() ? std::nullopt : std::optional(word.begin), start, instead_);
    if (passed.empty()) return {};
    instead_.clear();
  }
  if (cycle_.is_expanded()) {
    target.breaks = !normal_ || !block.assignments.empty();  // taken twice, these would count twice
    if (!target.breaks) instead_ = cycle_.restated(block, *normal_);
  }
  lose(axes);
  if (normal_) {
    place_[*normal_].reset();
    lost_[*normal_] = Loss::passed;
  }
  extruder_.forget_place();
  return instead_.empty() ? passed : std::string_view();
}

/// A motion in the origin's frame: axes that it states as numbers are known from now on.
std::string_view GcodeModes::move_to(const GcodeBlock& block, const Axes& axes, const Request& request,
                                     TargetLine& target) {
  const Motion motion = request.motion.value_or(motion_);
  const Places from = place_;
  target.passed = passed_;
  target.divided = divided(block, request, motion == Motion::rapid);
  const bool is_incremental = distance_ == Distance::incremental;
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    const GcodeWord* const word = axes.word[axis];
    if (word == nullptr) continue;
    place_[axis].reset();
    lost_[axis] = Loss::passed;
    const double stated = in_mm(axis, *word);
    if (word->is_number() && !is_incremental) place_[axis] = stated + request.shift[axis];
    if (word->is_number() && is_incremental && from[axis]) place_[axis] = *from[axis] + stated;
    passed_[axis] = true;
  }
  std::string_view passed = axes.has_expression ? kExpression : why_unknown(from, motion);
  if (passed.empty()) {
    for (std::size_t axis = 0; axis < axis_count_; ++axis) {
      target.path.to[axis] = *place_[axis];
      target.path.from[axis] = from[axis].value_or(*place_[axis]);
    }
    target.starts_known = std::all_of(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(axis_count_),
                                      [](const auto& place) { return place.has_value(); });
    if (is_arc(motion)) passed = add_arc(block, request, motion == Motion::clockwise, target.path);
  }
  if (!passed.empty()) {
    if (is_incremental) lose(axes);
    return passed;
  }
  state(axes, request, target);
  passed_.fill(false);
  origin_.fix();
  if (rotation_ == Rotation::unstated) rotation_ = Rotation::taken_as_zero;
  arcs_are_lines_ |= target.path.is_arc();
  return {};
}

std::string_view GcodeModes::why_unknown(const Places& from, Motion motion) const {
  if (motion == Motion::spline) return kSpline;
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    if (!place_[axis]) return distance_ == Distance::incremental ? kIncremental : sentence_of(lost_[axis], axis);
    if (is_arc(motion) && !from[axis]) return kArcStart;
  }
  return is_arc(motion) && !(normal_ && centre_is_place_) ? kPlane : std::string_view();
}

void GcodeModes::state(const Axes& axes, const Request& request, TargetLine& target) const {
  target.kind = TargetLine::Kind::target;
  target.may_insert = true;
  target.mm_per_unit = *mm_per_unit_;
  target.shift = request.shift;
  target.is_incremental = distance_ == Distance::incremental;
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
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
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    const GcodeWord* const word = axes.word[axis];
    if (word == nullptr) continue;
    target.path.from[axis] = target.path.to[axis] = *place_[axis];
    target.stated[axis] = number_of(*word);
    origin_.call(axis, *place_[axis], in_mm(axis, *word));
  }
}

}  // namespace paracal::io
