// What G codes do to what a controller remembers.

#include "gcode_codes.hpp"
#include "gcode_modes.hpp"
#include "gcode_words.hpp"

namespace paracal::io {
namespace {

constexpr double kMmPerInch = 25.4;

constexpr std::string_view kCycle = "a canned cycle (drilling)", kUnknown = "an unknown G code",
                           kDefinition = "G10 other than L2 P without rotation R";
constexpr std::string_view
    kCompute = "let the post-processor compute the path",
    kHarmless = "add --harmless with this code (as --harmless G187) if it moves nothing and keeps coordinates",
    kDefine = "set the offset before the program runs", kTable = "give its length with --tools FILE",
    kAlone = "state the code on a line of its own",
    kAllAxes = "state all axes of the tool in G43.1, or end its length with G49 first";

/// G54 to G59, G59.1 to G59.3: from 1.
std::size_t system_of(int tenths) {
  return static_cast<std::size_t>(tenths % 10 == 0 ? tenths / 10 - 53 : tenths % 10 + 6);
}

}  // namespace

double GcodeModes::in_mm(std::size_t axis, const GcodeWord& word) const {
  return word.value * (axis >= kFirstTurn ? 1.0 : *mm_per_unit_);
}

GcodeOrigin::Stated GcodeModes::in_mm(const Axes& axes) const {
  GcodeOrigin::Stated stated;
  for (const std::size_t axis : robot_axes_.moved()) {
    if (axes.word[axis] != nullptr) stated[axis] = in_mm(axis, *axes.word[axis]);
  }
  return stated;
}

/// Places into the frame that holds from now on.
void GcodeModes::carry(const GcodeOrigin::Change& change) {
  for (const std::size_t axis : robot_axes_.moved()) {
    if (!place_[axis]) continue;
    if (change[axis]) {
      *place_[axis] += *change[axis];
    } else if (rotations_[axis] == Rotation::stated) {
      place_[axis].reset();
    }
  }
}

void GcodeModes::move_origin(const Axes& axes) {
  std::array<bool, kAxes> moved{};
  for (const std::size_t axis : robot_axes_.moved()) moved[axis] = axes.count == 0 || axes.word[axis] != nullptr;
  carry(origin_.move(moved));
}

/// G10
void GcodeModes::define(const GcodeBlock& block, const Axes& axes, Request& request) {
  request.takes_axes = true;
  if (sets_tool_temperature(block, traits_)) return;
  if (traits_.tool_offsets == ToolOffsets::reprap && !block.has_letter("L")) return move_origin({});  // of a tool
  define_system(block, axes);
}

void GcodeModes::define_system(const GcodeBlock& block, const Axes& axes) {
  const GcodeWord *const kind = block.word('L'), *const system = block.word('P'), *const turn = block.word('R');
  const bool names_system = kind != nullptr && kind->is_whole(2.0, 2.0) && system != nullptr &&
                            system->is_whole(traits_.zero_is_current ? 0.0 : 1.0, WorkOffsets::kSystems);
  const bool turns = turn != nullptr && !(turn->is_number() && turn->value == 0.0);
  const bool is_added = traits_.defines_in_steps && distance_ != Distance::absolute;
  if (!names_system || turns || is_added || !mm_per_unit_ || axes.has_flag) {
    throw RefusedProgram(kDefinition, kDefine);
  }
  GcodeOrigin::Stated stated = in_mm(axes);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (!robot_axes_.moves(axis)) stated[axis] = 0.0;
  }
  carry(origin_.define_system(static_cast<std::size_t>(system->value), stated));
}

/// G43, with H or of the tool that was changed last.
void GcodeModes::take_tool_length(const GcodeBlock& block) {
  const GcodeWord* const word = block.word('H');
  const bool is_stated = word != nullptr && word->is_whole(1.0, kMostTool);
  const std::optional<int> tool = is_stated ? std::optional(static_cast<int>(word->value)) : tool_;
  if (word != nullptr && !is_stated) throw RefusedProgram("G43 with an H that is not a tool number", kTable);
  unit_of_tool_ = mm_per_unit_;
  const auto change = origin_.take_length_of(tool);
  if (!change) throw RefusedProgram("the length of a tool that --tools does not list", kTable);
  carry(*change);
}

/// G43.1. LinuxCNC keeps the number of an axis that the code does not state, and reads it in the unit then in force.
void GcodeModes::take_tool_length(const Axes& axes) {
  if (!mm_per_unit_ || axes.has_flag) throw RefusedProgram("a tool length without a number", kTable);
  for (const std::size_t axis : robot_axes_.moved()) {
    const bool is_kept = axis < kFirstTurn && axes.word[axis] == nullptr && origin_.has_tool_along(axis);
    if (is_kept && unit_of_tool_ != mm_per_unit_) {
      throw RefusedProgram("a tool length (G43.1) that keeps an axis from before a change of unit", kAllAxes);
    }
  }
  unit_of_tool_ = mm_per_unit_;
  carry(origin_.take_length(in_mm(axes)));
}

/// Controllers differ in whether axis words beside a code that moves nothing are a motion.
void GcodeModes::refuse_axis_words(const Axes& axes) const {
  if (axes.count == 0 || traits_.moves_beside_codes) return;
  throw RefusedProgram("axis words beside a code without motion (G50, G50.1, G92.1 to G92.3)", kAlone);
}

/// Where the place is known its new name is, too.
void GcodeModes::call_here_or_shift(const Axes& axes, Request& request) {
  request.takes_axes = true;
  if (!mm_per_unit_ || axes.has_flag || axes.count == 0) return move_origin(axes);
  bool is_known = origin_.is_fixed();
  const GcodeOrigin::Change shift = origin_.shift();
  for (const std::size_t axis : robot_axes_.moved()) {
    is_known &= axes.word[axis] == nullptr || (place_[axis] && shift[axis]);
  }
  request.calls_here = is_known;
  if (is_known) return;
  const GcodeOrigin::Stated stated = in_mm(axes);
  carry(origin_.call(place_, stated));
  if (origin_.is_fixed()) return;
  for (const std::size_t axis : robot_axes_.moved()) {  // the frame begins here
    if (stated[axis]) place_[axis] = *stated[axis] + origin_.shift()[axis].value_or(0.0);
  }
}

void GcodeModes::apply_g(int tenths, const GcodeBlock& block, const Axes& axes, Request& request) {
  const auto start_motion = [&](Motion motion) {
    request.is_malformed |= request.motion.has_value();
    request.motion = motion_ = motion;
    lost_rewritten_mode_ = false;
    has_moved_ = true;
  };
  const Code* const code = find_code(tenths);
  if (code == nullptr) throw RefusedProgram(kUnknown, kHarmless);
  const bool is_bare = !block.has_letter("PQ");
  switch (code->effect) {
    case Effect::none:
      return;
    case Effect::alone:
      return refuse_axis_words(axes);
    case Effect::rapid:
      return start_motion(Motion::rapid);
    case Effect::straight:
      return start_motion(Motion::straight);
    case Effect::clockwise:
      return start_motion(Motion::clockwise);
    case Effect::anticlockwise:
      return start_motion(Motion::anticlockwise);
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
      return feed_.set_mode(GcodeFeed::Mode::inverse_time);
    case Effect::feed_per_time:
    case Effect::feed_per_turn:
      return feed_.set_mode(GcodeFeed::Mode::per_time);
    case Effect::cycle:
      if (!traits_.is_printer) throw RefusedProgram(kCycle, kExpand);
      [[fallthrough]];  // levelling
    case Effect::reference:
      if (axes.count == 0 || traits_.moves_beside_codes) return;
      [[fallthrough]];
    case Effect::home:
      request.goes_elsewhere = request.takes_axes = request.is_idle = true;
      return;
    case Effect::saved_place:
      if (!traits_.is_printer && tenths == 600) throw RefusedProgram(kUnknown, kHarmless);
      request.goes_elsewhere = request.takes_axes = request.is_idle = traits_.is_printer && tenths == 610;
      return;
    case Effect::no_motion:
      lost_rewritten_mode_ = false;
      if (!request.motion) motion_ = Motion::none;  // beside another it says nothing
      return;
    case Effect::probe:
    case Effect::thread:
      request.goes_elsewhere = true;
      request.is_thread = code->effect == Effect::thread;
      return start_motion(Motion::unknown);
    case Effect::dwell:
      request.takes_axes = !block.has_letter("P");
      request.is_dwell = true;
      return;
    case Effect::absolute:
      distance_ = Distance::absolute;
      relies_on_macro_ = false;
      return extruder_.set_distance(false);
    case Effect::incremental:
      distance_ = Distance::incremental;
      relies_on_macro_ = false;
      return extruder_.set_distance(true);
    case Effect::inch_if_bare:
    case Effect::mm_if_bare:
      if (!is_bare) throw RefusedProgram(kCycle, kExpand);
      mm_per_unit_ = code->effect == Effect::mm_if_bare ? 1.0 : kMmPerInch;
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
      return carry(origin_.choose_system(system_of(tenths), !has_moved_));
    case Effect::tool_length:
      request.has_tool_length = true;
      return take_tool_length(block);
    case Effect::tool_length_by_axes:
      request.takes_axes = true;
      return take_tool_length(axes);
    case Effect::no_tool_length:
      return carry(origin_.drop_length());
    case Effect::define:
      return define(block, axes, request);
    case Effect::shift_axes:
      for (const GcodeWord& word : block.words) {
        if (word.letter == 'E') extruder_.call(word);
      }
      if (axes.count == 0 && (block.has_letter("E") || block.has_letter(other_axes_))) return;
      return call_here_or_shift(axes, request);
    case Effect::no_shift:
      refuse_axis_words(axes);
      return carry(origin_.drop_shift());
    case Effect::local_shift:
      request.takes_axes = true;
      return move_origin(axes);
    case Effect::restored_shift:
      refuse_axis_words(axes);
      return move_origin({});
    case Effect::refused:
      throw RefusedProgram(code->refusal, kCompute);
  }
}

}  // namespace paracal::io
