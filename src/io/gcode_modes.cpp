#include "gcode_modes.hpp"

#include <algorithm>
#include <cmath>

#include "gcode_codes.hpp"

namespace paracal::io {
namespace {

constexpr double kMmPerInch = 25.4;

constexpr std::string_view kMalformed = "not a block of G-code, or a wrong checksum";
constexpr std::string_view kFlow = "subprograms, jumps and loops";
constexpr std::string_view kOptional = "block delete (/)";
constexpr std::string_view kUnknownCode = "a G code that is not known here";
constexpr std::string_view kElsewhere = "homing, probing, threads and cycles";
constexpr std::string_view kMCode = "axis words of an M code";
constexpr std::string_view kExpression = "parameters and expressions";
constexpr std::string_view kIncremental = "incremental (G91)";
constexpr std::string_view kModes = "unclear whether G0 or G1, G90, G20 or G21 hold";
constexpr std::string_view kCurve = "arcs and splines";
constexpr std::string_view kOtherOrigin = "another origin than that of the first motion";
constexpr std::string_view kTransformed = "offset, turned or scaled path";
constexpr std::string_view kAxisUnknown = "an axis has not been stated yet";

/// 10 times the code; -1 for what no code is.
int tenths_of(double code) {
  const double tenths = std::round(10.0 * code);
  return std::abs(10.0 * code - tenths) < 1e-6 && tenths >= 0.0 && tenths < 1e5 ? static_cast<int>(tenths) : -1;
}

bool has_letter(const GcodeBlock& block, std::string_view letters) {
  return std::ranges::any_of(
      block.words, [&](const GcodeWord& word) { return letters.find(word.letter) != std::string_view::npos; });
}

}  // namespace

GcodeModes::GcodeModes(std::size_t axis_count, const std::optional<AxisValues>& start) : axis_count_(axis_count) {
  passed_.fill(true);
  for (std::size_t axis = 0; start && axis < axis_count; ++axis) place_[axis] = (*start)[axis];
}

void GcodeModes::forget() {
  motion_ = Motion::unknown;
  distance_ = Distance::unknown;
  mm_per_unit_.reset();
  lose_all();
}

void GcodeModes::lose(const Axes& axes) {
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    if (axes.word[axis] != nullptr) place_[axis].reset();
  }
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
    case Effect::straight:
      return start_motion(Motion::straight);
    case Effect::curve:
      return start_motion(Motion::curve);
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
      return;
    case Effect::incremental:
      distance_ = Distance::incremental;
      return;
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
      if (!has_letter(block, "LP")) return;
      request.takes_axes = true;
      return shift_origin();
    case Effect::shift_axes:
      if (axes.count == 0 && has_letter(block, "ABEUVW")) return;
      [[fallthrough]];
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
  request.has_m_code = true;
  switch (effect_of_m(tenths)) {
    case MEffect::none:
      return;
    case MEffect::end_of_modes:
      request.then_unknown = true;
      return;
    case MEffect::end_of_modes_if_bare:
      if (!has_letter(block, "PRCD")) request.then_unknown = true;
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
      word.letter == 'G' ? apply_g(tenths, block, axes, request) : apply_m(tenths, block, request);
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
    return block.kind == GcodeBlock::Kind::flow ? kFlow : kMalformed;
  }
  const Axes axes = axes_of(block);
  if (block.is_optional) return take_optional(block, axes);
  const Request request = apply_codes(block, axes);
  if (!request.refused.empty()) {
    forget();
    return request.refused;
  }
  const std::string_view passed = move(block, axes, request, target);
  if (request.then_lost) lose_all();
  if (request.then_unknown) forget();
  return passed;
}

/// The operator decides whether it counts.
std::string_view GcodeModes::take_optional(const GcodeBlock& block, const Axes& axes) {
  if (axes.count == 0 && !has_letter(block, "GMT")) return {};
  const Origin origin = origin_;
  const unsigned transforms = transforms_;
  const Request request = apply_codes(block, axes);
  if (!(origin_ == origin)) shift_origin();
  transforms_ |= transforms;
  forget();
  return axes.count > 0 || !request.refused.empty() || request.goes_elsewhere ? kOptional : std::string_view();
}

std::string_view GcodeModes::move(const GcodeBlock& block, const Axes& axes, const Request& request,
                                  TargetLine& target) {
  if (request.goes_elsewhere) {
    lose_all();
    // Homing alone states no target, and so leaves nothing uncorrected.
    return axes.has_number || axes.has_expression || !request.takes_axes ? kElsewhere : std::string_view();
  }
  if (request.takes_axes) return {};
  const Motion motion = request.motion.value_or(motion_);
  const bool is_full_circle = motion == Motion::curve && has_letter(block, "IJKR");
  if (axes.count == 0) return is_full_circle ? kCurve : std::string_view();
  if (axes.has_flag) {
    forget();
    return kMalformed;
  }
  const auto give_up = [&](std::string_view why) {
    lose(axes);
    return why;
  };
  if (request.has_m_code && !request.motion) return request.is_setting ? std::string_view() : give_up(kMCode);
  if (motion == Motion::unknown || motion == Motion::none || distance_ == Distance::unknown || !mm_per_unit_) {
    return give_up(kModes);
  }
  if (motion == Motion::cycle) {
    place_[2].reset();
    return give_up(kElsewhere);
  }
  if (request.in_machine) return give_up(kOtherOrigin);
  if (distance_ == Distance::incremental) return give_up(kIncremental);
  if (transforms_ != 0) return give_up(kTransformed);
  if (!first_origin_) first_origin_ = origin_;
  if (!(origin_ == *first_origin_)) return give_up(kOtherOrigin);
  return move_to(axes, motion, target);
}

/// An absolute motion in the origin's frame: axes that it states as numbers are known from now on.
std::string_view GcodeModes::move_to(const Axes& axes, Motion motion, TargetLine& target) {
  target.passed = passed_;
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    const GcodeWord* const word = axes.word[axis];
    if (word == nullptr) continue;
    place_[axis].reset();
    if (word->is_number()) place_[axis] = word->value * (axis == kRotation ? 1.0 : *mm_per_unit_);
    passed_[axis] = true;
  }
  if (axes.has_expression) return kExpression;
  if (motion == Motion::curve) return kCurve;
  const auto is_known = [](const std::optional<double>& place) { return place.has_value(); };
  if (!std::all_of(place_.begin(), place_.begin() + static_cast<std::ptrdiff_t>(axis_count_), is_known)) {
    return kAxisUnknown;
  }
  state(axes, target);
  passed_.fill(false);
  return {};
}

void GcodeModes::state(const Axes& axes, TargetLine& target) {
  target.may_insert = true;
  target.mm_per_unit = *mm_per_unit_;
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    target.wanted[axis] = *place_[axis];
    const GcodeWord* const word = axes.word[axis];
    if (word == nullptr) continue;
    target.stated[axis] = {word->begin, word->end, word->value};
    target.insert_at = std::max(target.insert_at, word->end);
  }
}

}  // namespace paracal::io
