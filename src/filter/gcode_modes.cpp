#include "gcode_modes.hpp"

#include <algorithm>

namespace paracal::io {
namespace {

constexpr std::string_view kMacro = "a macro (give --harmless NAME if it changes no position, origin or mode)";
constexpr std::string_view kOptional = "block delete (/)";
/// Of A, B and C.
constexpr std::array<std::string_view, 3> kLateRotations{
    "A is stated after motions for which 0 was assumed (give --start)",
    "B is stated after motions for which 0 was assumed (give --start)",
    "C is stated after motions for which 0 was assumed (give --start)"};

}  // namespace

GcodeModes::GcodeModes(const RobotAxes& axes, const GcodeOptions& options)
    : robot_axes_(axes),
      traits_(traits_of(options.dialect)),
      feed_(traits_.feeds_all_axes, traits_.is_printer),
      extruder_(traits_.extruder),
      origin_(options.offsets, options.tools) {
  passed_.fill(true);
  rotations_.fill(Rotation::stated);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (!axes.moves(axis)) other_axes_ += kAxisLetters[axis];
    if (!options.start && axis >= kFirstTurn && axes.moves(axis)) rotations_[axis] = Rotation::unstated;
  }
  lose_all();
  if (!options.start) return;
  const AxisValues start = axes.place_of(*options.start);
  for (const std::size_t axis : axes.moved()) place_[axis] = start[axis];
}

/// Macros of printers restore what they change, or leave a printer on which no print works: absolute, in mm.
void GcodeModes::forget() {
  lost_rewritten_mode_ |= arcs_are_lines_ && is_arc(motion_);
  motion_ = Motion::unknown;
  extruder_.forget();
  feed_.forget(traits_.is_printer ? GcodeFeed::Mode::per_time : GcodeFeed::Mode::unknown);
  lose_all();
  if (distance_ != Distance::absolute || !traits_.is_printer) distance_ = Distance::unknown;
  if (traits_.is_printer) return;
  mm_per_unit_.reset();
  normal_.reset();
  centre_is_place_.reset();
}

void GcodeModes::lose(const Axes& axes) {
  for (const std::size_t axis : robot_axes_.moved()) {
    if (axes.word[axis] != nullptr) place_[axis].reset();
  }
}

/// An A, B or C that no line states stays where it is.
void GcodeModes::lose_all() {
  place_.fill(std::nullopt);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (rotations_[axis] != Rotation::stated) place_[axis] = 0.0;
  }
}

GcodeModes::Axes GcodeModes::axes_of(const GcodeBlock& block) const {
  Axes axes;
  for (const GcodeWord& word : block.words) {
    const auto axis = static_cast<std::size_t>(std::ranges::find(kAxisLetters, word.letter) - kAxisLetters.begin());
    if (axis >= kAxes || !robot_axes_.moves(axis)) continue;
    axes.has_duplicate |= axes.word[axis] != nullptr;
    axes.has_flag |= word.kind == GcodeWord::Kind::flag || word.kind == GcodeWord::Kind::text;
    axes.has_number |= word.kind == GcodeWord::Kind::number;
    axes.word[axis] = &word;
    ++axes.count;
  }
  return axes;
}

std::string_view GcodeModes::take(const GcodeBlock& block, TargetLine& target) {
  feed_.begin_line();
  target.feed = feed_.of_line(false, mm_per_unit_);  // it may move at what is in force
  switch (block.kind) {
    case GcodeBlock::Kind::setting:
      return {};
    case GcodeBlock::Kind::name:
      if (has_moved_) throw RefusedProgram("an O word after the first motion (a subprogram)", kExpand);
      return {};
    case GcodeBlock::Kind::programmed:
      throw RefusedProgram("an O word, a jump, a parameter or an expression", kExpand);
    case GcodeBlock::Kind::macro:
      return take_macro();
    case GcodeBlock::Kind::malformed:
      forget();
      target.weight = TargetLine::Weight::work;
      return kMalformed;
    case GcodeBlock::Kind::words:
      break;
  }
  const Axes axes = axes_of(block);
  const std::string_view late = take_rotations(axes);
  if (block.is_optional) return take_optional(block, axes, target);
  Request request = apply_codes(block, axes);
  if (request.is_macro) return take_macro();
  if (request.is_malformed) {
    target.weight = TargetLine::Weight::work;
    forget();
    return kMalformed;
  }
  feed_.take(block, mm_per_unit_);
  target.feed = feed_.of_line(false, mm_per_unit_);
  std::string_view passed = move(block, axes, request, target);
  if (!late.empty()) passed = late;
  restate_arc(block, request, !passed.empty(), target);
  if (request.then_lost) lose_all();
  if (request.then_unknown) forget();
  return passed;
}

std::string_view GcodeModes::take_macro() {
  forget();
  relies_on_macro_ = traits_.is_printer;
  return kMacro;
}

/// The first A, B or C of a program: what it was before is not known.
std::string_view GcodeModes::take_rotations(const Axes& axes) {
  std::string_view late;
  for (std::size_t axis = kFirstTurn; axis < kAxes; ++axis) {
    if (rotations_[axis] == Rotation::stated || axes.word[axis] == nullptr) continue;
    if (late.empty() && rotations_[axis] == Rotation::taken_as_zero) late = kLateRotations[axis - kFirstTurn];
    rotations_[axis] = Rotation::stated;
    place_[axis].reset();
  }
  return late;
}

/// The operator decides whether it counts.
std::string_view GcodeModes::take_optional(const GcodeBlock& block, const Axes& axes, TargetLine& target) {
  if (axes.count == 0 && !block.has_letter("GMTF")) return {};
  const GcodeOrigin origin = origin_;
  const Request request = apply_codes(block, axes);
  if (!(origin_ == origin) || request.calls_here) origin_.forget();
  const bool states_way = axes.count > 0 || block.has_letter("IJKR");
  target.weight = states_way ? weight_of(block, axes, request.motion.value_or(motion_)) : TargetLine::Weight::approach;
  forget();
  return states_way || request.goes_elsewhere || request.is_malformed ? kOptional : std::string_view();
}

/// Approach and retreat are rapid, or go along Z alone.
TargetLine::Weight GcodeModes::weight_of(const GcodeBlock& block, const Axes& axes, Motion motion) {
  using Weight = TargetLine::Weight;
  const bool is_across = axes.count > (axes.word[2] != nullptr ? 1U : 0U);
  if (motion == Motion::rapid) return block.has_letter("E") && is_across ? Weight::work : Weight::idle;
  return is_arc(motion) || is_across ? Weight::work : Weight::approach;
}

}  // namespace paracal::io
