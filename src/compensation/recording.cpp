#include "recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>

#include "paracal/mechanism/closure_limb.hpp"
#include "paracal/mechanism/coordinates.hpp"

namespace paracal::compensation_detail {
namespace {

using closure::Answer, closure::Arms, closure::RodMotion, closure::TiltedPose, closure::Vector;

template <std::size_t N>
using RecordedLimbs = ClosureLimbs<Expression, N>;
using RecordedValues = std::vector<Expression>;

Expression input(std::string_view name, std::size_t index) {
  return Expression(Symbol{.name = name, .limb = -1, .index = static_cast<int>(index)});
}

/// Constants of one limb under their names; of those that are 0, 1 or -1 much of the arithmetic is not needed.
class NamedConstants {
 public:
  explicit NamedConstants(std::size_t limb) : limb_(static_cast<int>(limb)) {}

  Expression named(std::string_view name, double value, int index = -1) const {
    constexpr double kNothing = 1e-30;  // what rounding leaves of a zero; single precision still has it
    if (std::abs(value) < kNothing) return Expression(0.0);
    if (value == 1.0 || value == -1.0) return Expression(value);
    return Expression(Symbol{.name = name, .limb = limb_, .index = index, .value = value});
  }

  template <std::size_t Size>
  std::array<Expression, Size> named(std::string_view name, const std::array<double, Size>& values) const {
    std::array<Expression, Size> expressions;
    for (std::size_t k = 0; k < Size; ++k) expressions[k] = named(name, values[k], static_cast<int>(k));
    return expressions;
  }

 private:
  int limb_;
};

ClosureLimb<Expression> named_limb(const ClosureLimb<double>& limb, std::size_t number) {
  const NamedConstants constants(number);
  return {.base = constants.named("base", limb.base),
          .radial = constants.named("radial", limb.radial),
          .normal = constants.named("normal", limb.normal),
          .axis = constants.named("axis", limb.axis),
          .plate = constants.named("plate", limb.plate),
          .slide = constants.named("slide", limb.slide),
          .elbow_half = constants.named("elbow_half", limb.elbow_half),
          .plate_half = constants.named("plate_half", limb.plate_half),
          .rod = constants.named("rod", limb.rod),
          .arm = constants.named("arm", limb.arm),
          .joint_offset = constants.named("joint_offset", limb.joint_offset),
          .joint_per_mm = constants.named("joint_per_mm", limb.joint_per_mm),
          .drive = Expression(limb.drive),
          .rods = Expression(limb.rods),
          .ahead = Expression(limb.ahead)};
}

ClosurePose<Expression> asked_pose(const Machine& machine) {
  const std::vector<std::size_t> commanded = commanded_coordinates(machine);
  const auto coordinate = [&](std::size_t k, bool is_slide = false) {
    const bool is_asked = std::ranges::count(commanded, k) > 0 && is_slide == (among_seven(machine, k) == 6);
    if (is_asked) return input("pose", k);
    return Expression(k == 2 ? machine.guided_z : 0.0);
  };
  return {coordinate(0), coordinate(1), coordinate(2), coordinate(5, true),
          coordinate(3), coordinate(4), coordinate(5)};
}

// Numbers of a struct in the order in which they are kept as an array: to be read from one and to be written to one.

template <std::size_t N, typename Task>
void for_each_number(const RecordedLimbs<N>& limbs, TiltedPose<Expression, N>& state, Task&& task) {
  for (Expression& one : state.tilt) task(one);
  for (Expression& one : state.moved) task(one);
  for (std::size_t i = 0; i < N; ++i) {
    if (!closure::moves_in_mm(limbs[i])) task(state.arms[i].cosine);
    task(state.arms[i].sine);
  }
}

template <std::size_t N, typename Task>
void for_each_number(const RecordedLimbs<N>&, Answer<Expression, N>& answer, Task&& task) {
  const auto each = [&](Vector<Expression>& vector) {
    for (Expression& one : vector) task(one);
  };
  for (RodMotion<Expression>& dual : answer.dual) {
    each(dual.position);
    if (N == 4) task(dual.fourth);
  }
  for (Vector<Expression>& moment : answer.moment) each(moment);
  for (Expression& one : answer.by_joint) task(one);
  for (Vector<Expression>& row : answer.by_tilt) each(row);
}

template <std::size_t N, typename Struct>
RecordedValues values_of(const RecordedLimbs<N>& limbs, Struct numbers) {
  RecordedValues values;
  for_each_number<N>(limbs, numbers, [&](const Expression& one) { values.push_back(one); });
  return values;
}

template <typename Struct, std::size_t N>
Struct inputs(const RecordedLimbs<N>& limbs, std::string_view name) {
  Struct numbers{};
  std::size_t index = 0;
  for_each_number<N>(limbs, numbers, [&](Expression& one) { one = input(name, index++); });
  return numbers;
}

/// Cosine of an arm, one of a length: what `for_each_number` leaves out.
template <std::size_t N>
void complete(const RecordedLimbs<N>& limbs, TiltedPose<Expression, N>& state) {
  for (std::size_t i = 0; i < N; ++i) {
    if (closure::moves_in_mm(limbs[i])) state.arms[i].cosine = Expression(1.0);
  }
}

/// One machine of N limbs.
template <std::size_t N>
class Recorder {
 public:
  explicit Recorder(const Machine& machine)
      : machine_(machine), pose_(asked_pose(machine)), plate_(closure::commanded_plate(pose_)) {
    for (std::size_t i = 0; i < N; ++i) limbs_[i] = named_limb(closure_limb(machine, i), i);
    arms_ = closure::closed_arms<N>(limbs_, pose_, plate_);
  }

  RecordedMachine recorded() const {
    const ArmDirection<Expression> turn = closure::turn_by_series(Expression(Symbol{.name = "angle"}));
    RecordedMachine all{.closed = closed(),
                        .rates = rates(),
                        .answer = Procedure({}),
                        .step = Procedure({}),
                        .turn_cosine = Procedure({{"value", {turn.cosine}}}),
                        .turn_sine = Procedure({{"value", {turn.sine}}})};
    if constexpr (N == 3 || N == 4) {
      if (machine_.tilts_plate) add_search(all);
    }
    return all;
  }

 private:
  Procedure closed() const {
    std::array<Expression, N> joints;
    closure::joints_of(limbs_, arms_, joints);
    std::vector<Result> results{{"joints", RecordedValues(joints.begin(), joints.end())}};
    if constexpr (N == 3 || N == 4) {
      if (machine_.tilts_plate) results.push_back({"state", values_of<N>(limbs_, level_state())});
    }
    return Procedure(std::move(results));
  }

  Procedure rates() const {
    RecordedValues values;
    const Arms<Expression, N> arms = closure::unit_arms(limbs_, arms_);
    for (const auto& row : closure::joint_rates<N>(limbs_, pose_, plate_, arms)) {
      for (const std::size_t k : commanded_coordinates(machine_)) {
        values.push_back(row[among_seven(machine_, k)]);
      }
    }
    return Procedure({{"rates", std::move(values)}});
  }

  TiltedPose<Expression, N> level_state() const { return {closure::unit_arms(limbs_, arms_)}; }

  void add_search(RecordedMachine& all) const {
    const std::size_t fourth = fourth_coordinate(machine_);
    auto state = inputs<TiltedPose<Expression, N>, N>(limbs_, "state");
    complete<N>(limbs_, state);
    const auto found = closure::answer_at(limbs_, pose_, fourth, state.arms);
    all.answer = Procedure({{"answer", values_of<N>(limbs_, found)}});
    const auto answer = inputs<Answer<Expression, N>, N>(limbs_, "answer");
    const auto changes = closure::step(limbs_, pose_, fourth, answer, state);
    all.step = Procedure(
        {{"state", values_of<N>(limbs_, state)}, {"changes", RecordedValues(changes.begin(), changes.end())}});
    all.state_size = values_of<N>(limbs_, state).size();
    all.answer_size = values_of<N>(limbs_, answer).size();
  }

  const Machine& machine_;
  ClosurePose<Expression> pose_;
  closure::TurnedPlate<Expression> plate_;
  RecordedLimbs<N> limbs_;
  Arms<Expression, N> arms_;
};

std::vector<Symbol> numbers_of(const RecordedMachine& recorded) {
  std::set<Symbol> used;
  for (const Procedure* one : {&recorded.closed, &recorded.rates, &recorded.answer, &recorded.step}) {
    used.merge(one->symbols());
  }
  std::vector<Symbol> numbers;
  std::ranges::copy_if(used, std::back_inserter(numbers), [](const Symbol& symbol) { return symbol.limb >= 0; });
  std::ranges::stable_sort(numbers, {}, &Symbol::limb);
  return numbers;
}

template <std::size_t N = kMaxLimbs>
RecordedMachine record_limbs(const Machine& machine) {
  if constexpr (N > 1) {
    if (machine.limb_count < N) return record_limbs<N - 1>(machine);
  }
  return Recorder<N>(machine).recorded();
}

}  // namespace

std::size_t place_of_number(const std::vector<Symbol>& numbers, const Symbol& symbol) {
  return static_cast<std::size_t>(std::ranges::find(numbers, symbol) - numbers.begin());
}

RecordedMachine record(const Machine& machine) {
  RecordedMachine recorded = record_limbs(machine);
  recorded.numbers = numbers_of(recorded);
  return recorded;
}

}  // namespace paracal::compensation_detail
