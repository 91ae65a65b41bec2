#include "recording.hpp"

#include <utility>

#include "named_constants.hpp"

namespace paracal::compensation_detail {
namespace {

using RecordedLimbs = std::array<CompensatorLimb<Expression>, kCompensatorLimbs>;
using RecordedValues = std::vector<Expression>;

RecordedLimbs named_limbs(const std::array<CompensatorLimb<double>, kCompensatorLimbs>& limbs) {
  RecordedLimbs result;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const NamedConstants constants(i);
    const CompensatorLimb<double>& limb = limbs[i];
    result[i] = {.base = constants.named("base", limb.base),
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
                 .on_rail = Expression(limb.on_rail),
                 .joint_per_mm = constants.named("joint_per_mm", limb.joint_per_mm)};
  }
  return result;
}

/// A rigid plate is asked for no rotation.
template <std::size_t N>
CompensatorPose<Expression> asked_pose() {
  return {input("pose", 0), input("pose", 1), input("pose", 2), N == 4 ? input("pose", 3) : Expression(0.0)};
}

// Numbers of a struct in the order in which they are kept as an array: to be read from one and to be written to one.

template <std::size_t N, typename Task>
void for_each_number(const RecordedLimbs& limbs, TiltedPose<Expression, N>& state, Task&& task) {
  for (Expression& one : state.tilt) task(one);
  for (Expression& one : state.moved) task(one);
  for (std::size_t i = 0; i < N; ++i) {
    if (!runs_on_rail(limbs[i])) task(state.arms[i].cosine);
    task(state.arms[i].sine);
  }
}

template <std::size_t N, typename Task>
void for_each_number(const RecordedLimbs&, Answer<Expression, N>& answer, Task&& task) {
  const auto each = [&](Vector<Expression>& vector) {
    for (Expression& one : vector) task(one);
  };
  for (RodMotion<Expression>& dual : answer.dual) {
    each(dual.position);
    if (N == 4) task(dual.phi);
  }
  for (Vector<Expression>& moment : answer.moment) each(moment);
  for (Expression& one : answer.by_joint) task(one);
  for (Vector<Expression>& row : answer.by_tilt) each(row);
}

template <typename Struct>
RecordedValues values_of(const RecordedLimbs& limbs, Struct numbers) {
  RecordedValues values;
  for_each_number(limbs, numbers, [&](const Expression& one) { values.push_back(one); });
  return values;
}

template <typename Struct>
Struct inputs(const RecordedLimbs& limbs, std::string_view name) {
  Struct numbers{};
  std::size_t index = 0;
  for_each_number(limbs, numbers, [&](Expression& one) { one = input(name, index++); });
  return numbers;
}

template <std::size_t N>
Procedure recorded_level(const RecordedLimbs& limbs, bool tilts_plate) {
  const Arms<Expression, N> arms = level_arms<N>(limbs, asked_pose<N>());
  CompensatorJoints<Expression> joints;
  joints_of(limbs, arms, joints);
  std::vector<Result> results{{"joints", RecordedValues(joints.begin(), joints.begin() + N)}};
  if (tilts_plate) results.push_back({"state", values_of(limbs, level_pose(limbs, arms))});
  return Procedure(std::move(results));
}

template <std::size_t N>
Procedure recorded_answer(const RecordedLimbs& limbs) {
  const auto state = inputs<TiltedPose<Expression, N>>(limbs, "state");
  return Procedure({{"answer", values_of(limbs, answer_at(limbs, asked_pose<N>(), state.arms))}});
}

template <std::size_t N>
Procedure recorded_step(const RecordedLimbs& limbs) {
  auto state = inputs<TiltedPose<Expression, N>>(limbs, "state");
  const auto answer = inputs<Answer<Expression, N>>(limbs, "answer");
  const auto changes = step(limbs, asked_pose<N>(), answer, state);
  return Procedure({{"state", values_of(limbs, state)}, {"changes", RecordedValues(changes.begin(), changes.end())}});
}

/// n (dX + slide dphi) + B_m dq = 0 for every limb, n the direction of the mean rod, the plate level: errors of the
/// tilt group change these rows by their own size alone, so Newton's iteration with them still settles quickly.
template <std::size_t N>
Procedure recorded_way_back(const RecordedLimbs& limbs) {
  Arms<Expression, N> arms;
  for (std::size_t i = 0; i < N; ++i) {
    const Expression place = place_of(limbs[i], input("joints", i));
    arms[i] = runs_on_rail(limbs[i]) ? ArmDirection<Expression>{Expression(1.0), place}
                                     : ArmDirection<Expression>{cos(place), sin(place)};
  }
  const Answer<Expression, N> answer = answer_at(limbs, asked_pose<N>(), arms);
  Vector<Expression> position;
  Expression phi;
  for (std::size_t i = 0; i < N; ++i) {
    const Expression by_plate = -(answer.by_joint[i] * input("changes", i));
    position = sum(position, answer.dual[i].position, by_plate);
    phi = phi + answer.dual[i].phi * by_plate;
  }
  RecordedValues motion(position.begin(), position.end());
  if (N == 4) motion.push_back(phi);
  return Procedure({{"motion", std::move(motion)}});
}

template <std::size_t N>
RecordedMachine recorded(const RecordedLimbs& limbs, bool tilts_plate) {
  const ArmDirection<Expression> turn = turn_by_series(Expression(Symbol{.name = "angle"}));
  return {.level = recorded_level<N>(limbs, tilts_plate),
          .answer = recorded_answer<N>(limbs),
          .step = recorded_step<N>(limbs),
          .way_back = recorded_way_back<N>(limbs),
          .turn_cosine = Procedure({{"value", {turn.cosine}}}),
          .turn_sine = Procedure({{"value", {turn.sine}}}),
          .state_size = values_of(limbs, TiltedPose<Expression, N>{}).size(),
          .answer_size = values_of(limbs, Answer<Expression, N>{}).size()};
}

}  // namespace

RecordedMachine record(const CompensatorParameters<double>& parameters) {
  const RecordedLimbs limbs = named_limbs(parameters.identified);
  const bool tilts_plate = parameters.tilts_plate != 0;
  return parameters.limb_count == 4 ? recorded<4>(limbs, tilts_plate) : recorded<3>(limbs, tilts_plate);
}

}  // namespace paracal::compensation_detail
