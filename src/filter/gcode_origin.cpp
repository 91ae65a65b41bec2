#include "gcode_origin.hpp"

#include <algorithm>

namespace paracal::io {
namespace {

AxisValues difference(const AxisValues& one, const AxisValues& other) {
  AxisValues result{};
  std::ranges::transform(one, other, result.begin(), std::minus{});
  return result;
}

}  // namespace

GcodeOrigin::GcodeOrigin(const WorkOffsets& offsets) : system_(offsets.active), is_called_before_(offsets.is_shifted) {
  std::ranges::copy(offsets.systems, offsets_.begin() + 1);
}

GcodeOrigin::Change GcodeOrigin::choose_system(std::size_t number) {
  const Offset &from = offsets_.at(system_), &to = offsets_.at(number);
  const bool is_same = std::exchange(system_, number) == number;
  if (is_same || (first_ && from && to)) return AxisValues{};
  return from && to ? Change(difference(*from, *to)) : std::nullopt;
}

GcodeOrigin::Change GcodeOrigin::define_system(std::size_t number,
                                               const std::array<std::optional<double>, kAxes>& stated) {
  const std::size_t index = number == 0 ? system_ : number;
  const Offset old = offsets_.at(index);
  AxisValues values = old.value_or(AxisValues{});
  bool is_known = true;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (stated[axis]) values[axis] = *stated[axis];
    if (stated[axis] || old) continue;
    axis == kRotation ? takes_rotation_as_zero_ = true : is_known = false;
  }
  const Offset defined = is_known ? Offset(values) : std::nullopt;
  offsets_.at(index) = defined;
  const bool may_be_any = system_ == 0 || (first_ && first_->system == 0);  // in force at power-on
  const bool is_concerned = index == system_ || (first_ && index == first_->system);
  if (!may_be_any && (!is_concerned || (first_ && old && defined))) return AxisValues{};
  if (first_) move();
  return index == system_ && old && defined ? Change(difference(*old, *defined)) : std::nullopt;
}

void GcodeOrigin::compensate_tool(bool is_on) {
  has_tool_ = is_on;
  if (is_on) move();
}

void GcodeOrigin::move() { ++moves_; }

void GcodeOrigin::forget_offsets() {
  offsets_ = {};
  move();
}

void GcodeOrigin::call(std::size_t axis, double place, double stated) {
  called_[axis] += place - stated - shift()[axis];
}

void GcodeOrigin::fix() {
  if (!first_) first_ = First{system_, offsets_.at(system_), has_tool_, moves_};
}

bool GcodeOrigin::is_first() const {
  if (!first_) return true;
  const bool is_known = first_->offset && offsets_.at(system_);
  return has_tool_ == first_->has_tool && moves_ == first_->moves && (system_ == first_->system || is_known);
}

AxisValues GcodeOrigin::shift() const {
  AxisValues result = called_;
  if (!first_ || !first_->offset || !offsets_.at(system_)) return result;
  const AxisValues between = difference(*offsets_.at(system_), *first_->offset);
  std::ranges::transform(result, between, result.begin(), std::plus{});
  return result;
}

std::optional<AxisValues> GcodeOrigin::shift_of_machine() const {
  const First now = first_.value_or(First{system_, offsets_.at(system_), has_tool_, moves_});
  if (!now.offset || now.has_tool || now.moves != 0 || is_called_before_) return std::nullopt;
  return difference({}, *now.offset);
}

}  // namespace paracal::io
