#include "gcode_origin.hpp"

#include <algorithm>
#include <utility>

namespace paracal::io {
namespace {

constexpr GcodeOrigin::Change kUnchanged{0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
constexpr int kToolBase = 1'000'000;  ///< and on: lengths of tools that no table has, far from other bases
constexpr std::size_t kAlongTool = 2;

}  // namespace

GcodeOrigin::GcodeOrigin(const WorkOffsets& offsets, std::optional<ToolTable> tools)
    : system_(offsets.active),
      tools_(std::move(tools)),
      knows_shift_before_(std::ranges::any_of(offsets.systems, [](const auto& one) { return one.has_value(); })) {
  for (std::size_t k = 0; k < systems_.size(); ++k) {
    const auto known = k > 0 ? offsets.systems.at(k - 1) : std::nullopt;
    const int base = known ? 0 : ++bases_;
    for (std::size_t axis = 0; axis < kAxes; ++axis) systems_[k][axis] = {base, known ? known->at(axis) : 0.0};
  }
  now_[kSystem] = systems_[system_];
  if (offsets.is_shifted) now_[kShift].fill(unknown());
  if (tools_) first_[kTool] = Offsets{};  // the table has all of their lengths
}

GcodeOrigin::Offsets GcodeOrigin::all_unknown() {
  Offsets offsets;
  offsets.fill(unknown());
  return offsets;
}

std::optional<double> GcodeOrigin::difference(const Offset& one, const Offset& other) {
  return one.base == other.base ? std::optional(one.value - other.value) : std::nullopt;
}

/// The machine stays where it is: in the frame of the first target, too, once there is one.
GcodeOrigin::Change GcodeOrigin::set(Part part, const Offsets& offsets) {
  const Offsets old = std::exchange(now_.at(part), offsets);
  Change change = kUnchanged;
  if (first_.at(part)) return change;
  for (std::size_t axis = 0; axis < kAxes; ++axis) change[axis] = difference(old[axis], offsets[axis]);
  return change;
}

GcodeOrigin::Change GcodeOrigin::choose_system(std::size_t number, bool begins) {
  const bool is_first = std::exchange(system_, number) == 0;
  const Change change = set(kSystem, systems_.at(number));
  return is_first && begins ? kUnchanged : change;
}

GcodeOrigin::Change GcodeOrigin::define_system(std::size_t number, const Stated& stated) {
  const std::size_t index = number == 0 ? system_ : number;
  Offsets& system = systems_.at(index);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const bool is_zero = axis >= kFirstTurn && !stated[axis] && system[axis].base != 0;
    taken_as_zero_[axis] |= is_zero;
    if (stated[axis] || is_zero) system[axis] = {0, stated[axis].value_or(0.0)};
  }
  if (index == system_) return set(kSystem, system);
  // What was in force at power-on may be this one.
  return system_ == 0 ? set(kSystem, all_unknown()) : kUnchanged;
}

std::optional<GcodeOrigin::Change> GcodeOrigin::take_length_of(std::optional<int> tool) {
  Offsets length{};
  if (tools_) {
    const auto found = tool ? tools_->find(*tool) : tools_->end();
    if (found == tools_->end()) return std::nullopt;
    for (std::size_t axis = 0; axis < kAxes; ++axis) length[axis].value = found->second.at(axis);
  } else {
    length[kAlongTool] = tool ? Offset{kToolBase + *tool, 0.0} : unknown();
    takes_tool_as_given_ = true;
  }
  return set(kTool, length);
}

GcodeOrigin::Change GcodeOrigin::take_length(const Stated& stated) {
  Offsets length = now_[kTool];
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (stated[axis]) length[axis] = {0, *stated[axis]};
  }
  return set(kTool, length);
}

GcodeOrigin::Change GcodeOrigin::drop_length() { return set(kTool, {}); }

GcodeOrigin::Change GcodeOrigin::call(const Stated& places, const Stated& stated) {
  const Change shifts = shift();
  Offsets called = now_[kShift];
  Change change = kUnchanged;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (!stated[axis]) continue;
    const bool is_known = places[axis] && shifts[axis];
    called[axis] = is_known
                       ? Offset{called[axis].base, called[axis].value + *places[axis] - *stated[axis] - *shifts[axis]}
                       : unknown();
    if (!is_known) change[axis].reset();
  }
  const Change moved = set(kShift, called);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (change[axis]) change[axis] = moved[axis];
  }
  return change;
}

GcodeOrigin::Change GcodeOrigin::drop_shift() {
  takes_no_shift_before_ |= !knows_shift_before_;
  return set(kShift, {});
}

GcodeOrigin::Change GcodeOrigin::move(const std::array<bool, kAxes>& axes) {
  Offsets moved = now_[kShift];
  Change change = kUnchanged;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (!axes[axis]) continue;
    moved[axis] = unknown();
    change[axis].reset();
  }
  set(kShift, moved);
  return change;
}

void GcodeOrigin::forget() {
  for (Offsets& system : systems_) system.fill(unknown());
  now_[kSystem] = systems_.at(system_);
  now_[kTool].fill(unknown());
  now_[kShift].fill(unknown());
}

void GcodeOrigin::fix() {
  for (std::size_t part = 0; part < kParts; ++part) {
    if (!first_[part]) first_[part] = now_[part];
  }
}

GcodeOrigin::Change GcodeOrigin::shift() const {
  Change shift = kUnchanged;
  for (std::size_t part = 0; part < kParts; ++part) {
    for (std::size_t axis = 0; axis < kAxes && first_[part]; ++axis) {
      const auto moved = difference(now_[part][axis], (*first_[part])[axis]);
      shift[axis] = shift[axis] && moved ? std::optional(*shift[axis] + *moved) : std::nullopt;
    }
  }
  return shift;
}

bool GcodeOrigin::is_other_tool() const {
  GcodeOrigin same_tool = *this;
  same_tool.now_[kTool] = first_[kTool].value_or(now_[kTool]);
  return std::ranges::all_of(same_tool.shift(), [](const auto& one) { return one.has_value(); });
}

GcodeOrigin::Change GcodeOrigin::shift_of_machine() const {
  Change shift = kUnchanged;
  for (std::size_t part = 0; part < kParts; ++part) {
    const Offsets& frame = first_[part] ? *first_[part] : now_[part];
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const auto from_machine = difference({}, frame[axis]);
      shift[axis] = shift[axis] && from_machine ? std::optional(*shift[axis] + *from_machine) : std::nullopt;
    }
  }
  return shift;
}

}  // namespace paracal::io
