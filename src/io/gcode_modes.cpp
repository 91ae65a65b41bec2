#include "gcode_modes.hpp"

#include <algorithm>
#include <cmath>

#include "gcode_codes.hpp"

namespace paracal::io {
namespace {

constexpr double kMmPerInch = 25.4;

constexpr std::string_view kMacro = "a macro (--harmless NAME, if it leaves plate, origin and modes as they are)";
constexpr std::string_view kFlow = "subprograms, jumps and loops";
constexpr std::string_view kOptional = "block delete (/)";
constexpr std::string_view kUnknownCode = "a G code that is not known here";
constexpr std::string_view kLateRotation = "C is stated after motions for which it was taken as 0 (--start)";

/// 10 times the code; -1 for what no code is.
int tenths_of(double code) {
  const double tenths = std::round(10.0 * code);
  return std::abs(10.0 * code - tenths) < 1e-6 && tenths >= 0.0 && tenths < 1e5 ? static_cast<int>(tenths) : -1;
}

}  // namespace

GcodeModes::GcodeModes(std::size_t axis_count, const std::optional<AxisValues>& start) : axis_count_(axis_count) {
  passed_.fill(true);
  if (!start && axis_count == kAxes) rotation_ = Rotation::unstated;
  lose_all();
  for (std::size_t axis = 0; start && axis < axis_count; ++axis) place_[axis] = (*start)[axis];
}

void GcodeModes::forget() {
  forgotten_ = true;
  motion_ = Motion::unknown;
  distance_ = Distance::unknown;
  mm_per_unit_.reset();
  normal_.reset();
  centre_is_place_.reset();
  inverse_time_.reset();
  extruder_.forget();
  lose_all();
}

void GcodeModes::lose(const Axes& axes) {
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    if (axes.word[axis] != nullptr) place_[axis].reset();
  }
}

/// A C that no line states stays where it is.
void GcodeModes::lose_all() {
  place_.fill(std::nullopt);
  if (rotation_ != Rotation::stated) place_[kRotation] = 0.0;
}

void GcodeModes::shift_origin() {
  ++origin_.shifts;
  lose_all();
}

GcodeModes::Axes GcodeModes::axes_of(const GcodeBlock& block) const {
  Axes axes;
  for (const GcodeWord& word : block.words) {
    const auto axis = static_cast<std::size_t>(std::ranges::find(kAxisLetters, word.letter) - kAxisLetters.begin());
    if (axis >= axis_count_) continue;
    axes.has_duplicate |= axes.word[axis] != nullptr;
    axes.has_flag |= word.kind == GcodeWord::Kind::flag;
    axes.has_number |= word.kind == GcodeWord::Kind::number;
    axes.has_expression |= word.kind == GcodeWord::Kind::expression;
    axes.word[axis] = &word;
    ++axes.count;
  }
  return axes;
}

/// Where the place is known its new name is, too.
void GcodeModes::call_here_or_shift(const Axes& axes, Request& request) {
  request.takes_axes = true;
  bool is_known = first_origin_ && origin_ == *first_origin_ && mm_per_unit_ && transforms_ == 0 && axes.count > 0;
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    const GcodeWord* const word = axes.word[axis];
    is_known &= word == nullptr || (word->is_number() && place_[axis]);
  }
  request.calls_here = is_known;
  if (!is_known) shift_origin();
}

void GcodeModes::apply_g(int tenths, const GcodeBlock& block, const Axes& axes, Request& request) {
  const auto start_motion = [&](Motion motion) {
    if (request.motion) request.refused = kMalformed;
    request.motion = motion_ = motion;
  };
  const Code* const code = find_code(tenths);
  if (code == nullptr) {
    request.refused = kUnknownCode;
    return;
  }
  switch (code->effect) {
    case Effect::none:
      return;
    case Effect::rapid:
      return start_motion(Motion::rapid);
    case Effect::straight:
      return start_motion(Motion::straight);
    case Effect::clockwise:
      return start_motion(Motion::clockwise);
    case Effect::anticlockwise:
      return start_motion(Motion::anticlockwise);
    case Effect::spline:
      return start_motion(Motion::spline);
    case Effect::plane:
      normal_ = code->normal;
      return;
    case Effect::centre_is_place:
      centre_is_place_ = true;
      return;
    case Effect::centre_from_start:
      centre_is_place_ = false;
      return;
    case Effect::inverse_time:
      inverse_time_ = true;
      return;
    case Effect::feed_per_time:
      inverse_time_ = false;
      return;
    case Effect::cycle:
      return start_motion(Motion::cycle);
    case Effect::no_motion:
      if (!request.motion) motion_ = Motion::none;  // beside another it says nothing
      return;
    case Effect::probe:
      request.goes_elsewhere = true;
      return start_motion(Motion::unknown);
    case Effect::home:
      request.goes_elsewhere = request.takes_axes = true;
      return;
    case Effect::dwell:
      request.takes_axes = true;
      return;
    case Effect::absolute:
      distance_ = Distance::absolute;
      return extruder_.set_distance(false);
    case Effect::incremental:
      distance_ = Distance::incremental;
      return extruder_.set_distance(true);
    case Effect::inch:
      mm_per_unit_ = kMmPerInch;
      return;
    case Effect::mm:
      mm_per_unit_ = 1.0;
      return;
    case Effect::in_machine:
      request.in_machine = true;
      return;
    case Effect::system:
      if (origin_.system != tenths) lose_all();
      origin_.system = tenths;
      return;
    case Effect::tool_length:
      origin_.tool_length = true;
      return shift_origin();
    case Effect::no_tool_length:
      origin_.tool_length = false;  // another origin than with it, and than any before it: G43 has counted a shift
      return;
    case Effect::shift_if_stated:
      if (!block.has_letter("LP")) return;
      request.takes_axes = true;
      return shift_origin();
    case Effect::shift_axes:
      for (const GcodeWord& word : block.words) {
        if (word.letter == 'E') extruder_.place = word.is_number() ? std::optional(word.value) : std::nullopt;
      }
      if (axes.count == 0 && block.has_letter("ABEUVW")) return;
      return call_here_or_shift(axes, request);
    case Effect::shift:
      request.takes_axes = true;
      return shift_origin();
    case Effect::flow:
      request.refused = kFlow;
      return;
    case Effect::transform_by_axes:
      request.takes_axes = true;
      [[fallthrough]];
    case Effect::transform:
      transforms_ |= code->transform;
      return lose_all();
    case Effect::no_transform:
      if ((transforms_ & code->transform) != 0) lose_all();
      transforms_ &= ~code->transform;
      return;
  }
}

void GcodeModes::apply_m(int tenths, const GcodeBlock& block, Request& request) {
  request.has_m_code |= takes_axis_words(tenths);
  switch (effect_of_m(tenths)) {
    case MEffect::none:
      return;
    case MEffect::pause:
      request.acts_after = true;
      return;
    case MEffect::end:
      request.acts_after = request.then_unknown = true;
      return;
    case MEffect::absolute_extrusion:
      extruder_ = {.is_relative = false};
      return;
    case MEffect::relative_extrusion:
      extruder_ = {.is_relative = true};
      return;
    case MEffect::end_of_modes:
      request.then_unknown = true;
      return;
    case MEffect::end_of_modes_if_bare:
      if (!block.has_letter("PRCD")) request.then_unknown = true;
      return;
    case MEffect::tool_change:
      request.then_lost = true;
      return;
    case MEffect::flow:
      request.refused = kFlow;
      return;
    case MEffect::setting:
      request.is_setting = true;
      return;
    case MEffect::shift:
      return shift_origin();
  }
}

GcodeModes::Request GcodeModes::apply_codes(const GcodeBlock& block, const Axes& axes) {
  Request request;
  if (axes.has_duplicate) request.refused = kMalformed;
  for (const GcodeWord& word : block.words) {
    if (word.letter == 'T') request.then_lost = true;  // RepRap changes the tool at once
    if (word.letter != 'G' && word.letter != 'M') continue;
    if (word.is_number()) {
      const int tenths = tenths_of(word.value);
      const auto stated_before = request.motion;
      word.letter == 'G' ? apply_g(tenths, block, axes, request) : apply_m(tenths, block, request);
      if (request.motion && !stated_before) request.motion_word = {word.at, word.end};
    } else {
      request.refused = word.kind == GcodeWord::Kind::expression ? kExpression : kMalformed;
    }
  }
  return request;
}

std::string_view GcodeModes::take(const GcodeBlock& block, TargetLine& target) {
  if (block.kind == GcodeBlock::Kind::setting) return {};
  if (block.kind != GcodeBlock::Kind::words) {
    forget();
    return block.kind == GcodeBlock::Kind::flow ? kFlow : block.kind == GcodeBlock::Kind::macro ? kMacro : kMalformed;
  }
  const Axes axes = axes_of(block);
  const std::string_view late = take_rotation(axes);
  if (block.is_optional) return take_optional(block, axes);
  const Request request = apply_codes(block, axes);
  if (!request.refused.empty()) {
    forget();
    return request.refused;
  }
  std::string_view passed = move(block, axes, request, target);
  if (!late.empty()) passed = late;
  restate_arc(block, request, !passed.empty(), target);
  if (request.then_lost) lose_all();
  if (request.then_unknown) forget();
  return passed;
}

/// The first C of a program: what it was before is not known.
std::string_view GcodeModes::take_rotation(const Axes& axes) {
  if (rotation_ == Rotation::stated || axes.word[kRotation] == nullptr) return {};
  const bool is_late = rotation_ == Rotation::taken_as_zero;
  rotation_ = Rotation::stated;
  place_[kRotation].reset();
  return is_late ? kLateRotation : std::string_view();
}

/// The operator decides whether it counts.
std::string_view GcodeModes::take_optional(const GcodeBlock& block, const Axes& axes) {
  if (axes.count == 0 && !block.has_letter("GMT")) return {};
  const Origin origin = origin_;
  const unsigned transforms = transforms_;
  const Request request = apply_codes(block, axes);
  if (!(origin_ == origin) || request.calls_here) shift_origin();
  transforms_ |= transforms;
  forget();
  return axes.count > 0 || !request.refused.empty() || request.goes_elsewhere ? kOptional : std::string_view();
}

}  // namespace paracal::io
