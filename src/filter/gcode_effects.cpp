// What G codes do to what a controller remembers.

#include <cmath>

#include "gcode_codes.hpp"
#include "gcode_modes.hpp"
#include "gcode_words.hpp"

namespace paracal::io {
namespace {

constexpr double kMmPerInch = 25.4;

constexpr std::string_view kForeignCycle = "a canned cycle in a dialect that does not have LinuxCNC's";

/// G54 to G59, G59.1 to G59.3: from 1.
std::size_t system_of(int tenths) {
  return static_cast<std::size_t>(tenths % 10 == 0 ? tenths / 10 - 53 : tenths % 10 + 6);
}

}  // namespace

void GcodeModes::shift_origin() {
  origin_.move();
  lose_all(Loss::origin);
}

void GcodeModes::forget_systems() {
  origin_.forget_offsets();
  lose_all(Loss::origin);
}

double GcodeModes::in_mm(std::size_t axis, const GcodeWord& word) const {
  return word.value * (axis == kRotation ? 1.0 : *mm_per_unit_);
}

/// Places into the frame that holds from now on.
void GcodeModes::carry(const GcodeOrigin::Change& change) {
  if (!change) return lose_all(Loss::origin);
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    if (place_[axis]) *place_[axis] += (*change)[axis];
  }
}

/// G10 L2 P.
void GcodeModes::define_system(const GcodeBlock& block, const Axes& axes) {
  const GcodeWord *const kind = block.word('L'), *const system = block.word('P');
  const double least = traits_.zero_is_current ? 0.0 : 1.0;
  const bool names_system = kind != nullptr && kind->is_number() && kind->value == 2.0 && system != nullptr &&
                            system->is_number() && system->value >= least && system->value <= WorkOffsets::kSystems &&
                            system->value == std::floor(system->value);
  const bool is_known =
      names_system && !block.has_letter("R") && mm_per_unit_ && !axes.has_expression && !axes.has_flag;
  if (!is_known) return forget_systems();
  Places stated;
  for (std::size_t axis = 0; axis < axis_count_; ++axis) {
    if (axes.word[axis] != nullptr) stated[axis] = in_mm(axis, *axes.word[axis]);
  }
  if (axis_count_ < kAxes) stated[kRotation] = 0.0;
  carry(origin_.define_system(static_cast<std::size_t>(system->value), stated));
}

/// Where the place is known its new name is, too.
void GcodeModes::call_here_or_shift(const Axes& axes, Request& request) {
  request.takes_axes = true;
  bool is_known = origin_.is_fixed() && origin_.is_first() && mm_per_unit_ && transforms_ == 0 && axes.count > 0;
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
    lost_rewritten_mode_ = false;
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
      if (!traits_.has_cycles) {
        request.refused = kForeignCycle;
        return;
      }
      cycle_.choose(tenths, motion_ == Motion::cycle);
      return start_motion(Motion::cycle);
    case Effect::save_place:
      saves_places_ = traits_.saved_places != SavedPlaces::none && axes.count == 0;
      if (!saves_places_) request.refused = kUnknownCode;
      return;
    case Effect::path_mode:
      if (tenths == 610 && (saves_places_ || traits_.saved_places == SavedPlaces::always)) {
        request.goes_elsewhere = request.takes_axes = true;
        return;
      }
      return cycle_.choose_path_mode(block, tenths);
    case Effect::return_to_start:
      return cycle_.choose_return(false);
    case Effect::return_to_clearance:
      return cycle_.choose_return(true);
    case Effect::no_motion:
      lost_rewritten_mode_ = false;
      if (!request.motion) motion_ = Motion::none;  // beside another it says nothing
      return;
    case Effect::probe:
    case Effect::thread:
      request.goes_elsewhere = true;
      request.is_thread = code->effect == Effect::thread;
      return start_motion(Motion::unknown);
    case Effect::home:
      request.goes_elsewhere = request.takes_axes = true;
      return;
    case Effect::dwell:
      request.takes_axes = !block.has_letter("P");
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
      return carry(origin_.choose_system(system_of(tenths)));
    case Effect::tool_length_by_axes:
      request.takes_axes = true;
      [[fallthrough]];
    case Effect::tool_length:
      request.has_tool_length = true;
      origin_.compensate_tool(true);
      return lose_all(Loss::origin);
    case Effect::no_tool_length:
      return origin_.compensate_tool(false);
    case Effect::shift_if_stated:
      if (!block.has_letter("LP")) return;
      request.takes_axes = true;
      if (sets_tool_temperature(block, traits_)) return;
      return define_system(block, axes);
    case Effect::shift_axes:
      for (const GcodeWord& word : block.words) {
        if (word.letter == 'E') extruder_.call(word);
      }
      if (axes.count == 0 && block.has_letter("ABCEUVW")) return;
      return call_here_or_shift(axes, request);
    case Effect::shift_by_axes:
      request.takes_axes = true;
      [[fallthrough]];
    case Effect::shift:
      return shift_origin();
    case Effect::flow:
      request.refused = kFlow;
      return;
    case Effect::transform_by_axes:
      request.takes_axes = true;
      [[fallthrough]];
    case Effect::transform:
      transforms_ |= code->transform;
      return lose_all(Loss::transform);
    case Effect::no_transform:
      if ((transforms_ & code->transform) != 0) lose_all(Loss::transform);
      transforms_ &= ~code->transform;
      return;
  }
}

}  // namespace paracal::io
