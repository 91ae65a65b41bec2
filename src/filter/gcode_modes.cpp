#include "gcode_modes.hpp"

#include <algorithm>

namespace paracal::io {
namespace {

constexpr std::string_view kMacro = "a macro (--harmless NAME, if it leaves plate, origin and modes as they are)";
constexpr std::string_view kOptional = "block delete (/)";
constexpr std::string_view kLateRotation = "C is stated after motions for which it was taken as 0 (--start)";

}  // namespace

GcodeModes::GcodeModes(std::size_t axis_count, const GcodeOptions& options)
    : axis_count_(axis_count),
      traits_(traits_of(options.dialect)),
      extruder_(traits_.extruder),
      origin_(options.offsets) {
  passed_.fill(true);
  if (!options.start && axis_count == kAxes) rotation_ = Rotation::unstated;
  lose_all(Loss::unstated);
  if (!options.start) return;
  const AxisValues start = place_of(*options.start, Eigen::Vector3d::Zero());
  for (std::size_t axis = 0; axis < axis_count; ++axis) place_[axis] = start[axis];
}

void GcodeModes::forget() {
  forgotten_ = true;
  lost_rewritten_mode_ |= (arcs_are_lines_ && is_arc(motion_)) || (cycle_.is_expanded() && motion_ == Motion::cycle);
  cycle_.forget();
  motion_ = Motion::unknown;
  distance_ = Distance::unknown;
  mm_per_unit_.reset();
  normal_.reset();
  centre_is_place_.reset();
  inverse_time_.reset();
  extruder_.forget();
  lose_all(Loss::unread);
}

void GcodeModes::lose(const Axes& axes) {
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    if (axes.word[axis] == nullptr) continue;
    place_[axis].reset();
    lost_[axis] = Loss::passed;
  }
}

/// A C that no line states stays where it is.
void GcodeModes::lose_all(Loss loss) {
  place_.fill(std::nullopt);
  lost_.fill(loss);
  if (rotation_ != Rotation::stated) place_[kRotation] = 0.0;
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

std::string_view GcodeModes::take(const GcodeBlock& block, TargetLine& target) {
  if (block.kind == GcodeBlock::Kind::setting) return {};
  if (block.kind != GcodeBlock::Kind::words) {
    forget();
    target.is_work = block.kind != GcodeBlock::Kind::macro;
    return block.kind == GcodeBlock::Kind::flow ? kFlow : block.kind == GcodeBlock::Kind::macro ? kMacro : kMalformed;
  }
  const Axes axes = axes_of(block);
  const std::string_view late = take_rotation(axes);
  if (block.is_optional) return take_optional(block, axes, target);
  Request request = apply_codes(block, axes);
  if (!request.refused.empty()) {
    target.is_work = may_be_work(block, axes, request, motion_);
    forget();
    return request.refused;
  }
  std::string_view passed = move(block, axes, request, target);
  if (!late.empty()) passed = late;
  restate_arc(block, request, !passed.empty(), target);
  if (request.then_lost) lose_all(*request.then_lost);
  if (request.then_unknown) forget();
  return passed;
}

/// Of a line of which not all is known.
bool GcodeModes::may_be_work(const GcodeBlock& block, const Axes& axes, const Request& request, Motion motion) {
  if (request.goes_elsewhere || request.ends_subprogram) return request.is_thread;
  const bool is_harmless = request.refused.empty() || request.refused == kUnknownCode;
  const bool states_way = axes.count > 0 || block.has_letter("IJKR");
  return !is_harmless || (states_way && is_work(block, axes, motion));
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
std::string_view GcodeModes::take_optional(const GcodeBlock& block, const Axes& axes, TargetLine& target) {
  if (axes.count == 0 && !block.has_letter("GMT")) return {};
  const GcodeOrigin origin = origin_;
  const unsigned transforms = transforms_;
  const Request request = apply_codes(block, axes);
  if (!(origin_ == origin) || request.calls_here) forget_systems();
  transforms_ |= transforms;
  target.is_work = may_be_work(block, axes, request, motion_);
  forget();
  return axes.count > 0 || target.is_work || !request.refused.empty() || request.goes_elsewhere ? kOptional
                                                                                                : std::string_view();
}

}  // namespace paracal::io
