#include "variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "paracal/compensation/parameters.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/closure_limb.hpp"
#include "paracal/mechanism/coordinates.hpp"
#include "paracal/mechanism/random.hpp"

namespace paracal::compensation_detail {
namespace {

/// What a variant adds to the joints of the closed form.
template <std::size_t N, typename Scalar>
bool move_joints(const Machine& machine, const Pose& pose, int steps, Joints& joints) {
  const ClosureLimbs<Scalar, N> rounded = closure_limbs<N, Scalar>(machine);
  const ClosurePose<double> at = closure_pose(pose);
  const closure::Arms<double, N> arms = closure::closed_arms<N>(machine.limbs, at, closure::commanded_plate(at));
  closure::joints_of(machine.limbs, arms, joints);
  closure::TiltedPose<Scalar, N> state;
  const closure::Arms<double, N> unit = closure::unit_arms(machine.limbs, arms);
  for (std::size_t i = 0; i < N; ++i) {
    state.arms[i] = {static_cast<Scalar>(unit[i].cosine), static_cast<Scalar>(unit[i].sine)};
  }
  const std::size_t fourth = fourth_coordinate(machine);
  const auto there = closure_pose<Scalar>(pose);
  const auto answer = closure::answer_at(rounded, there, fourth, state.arms);
  for (int count = 0; count < steps; ++count) (void)closure::step(rounded, there, fourth, answer, state);
  for (std::size_t i = 0; i < N; ++i) joints(static_cast<Eigen::Index>(i)) += static_cast<double>(state.moved[i]);
  return joints.allFinite();
}

/// Joints as a variant finds them, from those of the exact method.
bool vary(const Machine& machine, const Pose& pose, ExportVariant variant, Joints& joints) {
  if (!machine.tilts_plate || variant == ExportVariant::exact) return true;
  const int steps = usual_steps(variant);
  const bool is_three = machine.limb_count == 3;
  if (variant == ExportVariant::one_step) {
    return is_three ? move_joints<3, double>(machine, pose, steps, joints)
                    : move_joints<4, double>(machine, pose, steps, joints);
  }
  return is_three ? move_joints<3, float>(machine, pose, steps, joints)
                  : move_joints<4, float>(machine, pose, steps, joints);
}

/// Errors of each turn are undone exactly after the closure, which is what varies.
Machine with_even_turns(Machine machine) {
  for (Limb& limb : machine.limbs) limb.turn = {};
  return machine;
}

/// Anywhere in the workspace, or on its rims with the ends of all angles, where errors are largest.
Pose somewhere(const Workspace& workspace, RandomStream& random, bool on_rim) {
  const auto end = [&] { return on_rim ? std::round(random.uniform()) : random.uniform(); };
  const double share = on_rim ? 1.0 : std::sqrt(random.uniform()), azimuth = 2.0 * std::numbers::pi * random.uniform();
  Pose pose{workspace.at(share, azimuth, end()),
            workspace.min_rotation + end() * (workspace.max_rotation - workspace.min_rotation)};
  for (int axis = 0; axis < 3; ++axis) pose.tilt(axis) = workspace.tilt_about(axis) * (2.0 * end() - 1.0);
  return pose;
}

}  // namespace

int usual_steps(ExportVariant variant) {
  constexpr int kUsual = 4;
  if (variant == ExportVariant::exact) return kUsual;
  return variant == ExportVariant::one_step ? 1 : kSingleSteps;
}

double variant_error(const Robot& robot, const Machine& built, ExportVariant variant) {
  const Machine machine = with_even_turns(built);
  RandomStream random(1);
  double worst = 0.0;
  for (int count = 0; count < kVariantPoses; ++count) {
    const Pose pose = somewhere(robot.workspace(), random, count % 2 == 0);
    InverseResult found = inverse(machine, pose);
    if (!found.ok() || !vary(machine, pose, variant, found.joints)) continue;
    const ForwardResult reached = forward(machine, found.joints, {.start = plate_at(machine, pose)});
    if (!reached.ok()) continue;
    const double slide = reached.plate.slide - machine.slide_of(pose.rotation);
    worst = std::max(worst, std::hypot((reached.plate.position - pose.position).norm(), slide));
  }
  return worst;
}

namespace {

/// By differences.
Joints exact_rate(const Machine& machine, const Pose& pose, std::size_t place) {
  const double step = place < 3 ? 1e-3 : 1e-5;  // mm, rad: their squares are lost in rounding
  std::array<Joints, 2> joints;
  for (std::size_t side = 0; side < 2; ++side) {
    Pose there = pose;
    coordinate(there, machine, place) += side == 0 ? step : -step;
    joints.at(side) = inverse(machine, there).joints;
  }
  return (joints[0] - joints[1]) / (2.0 * step);
}

template <std::size_t N>
double rate_error_at(const Machine& machine, const Pose& pose) {
  const ClosurePose<double> at = closure_pose(pose);
  const auto plate = closure::commanded_plate(at);
  const auto arms = closure::unit_arms(machine.limbs, closure::closed_arms<N>(machine.limbs, at, plate));
  const auto rates = closure::joint_rates<N>(machine.limbs, at, plate, arms);
  double worst = 0.0;
  for (const std::size_t place : commanded_coordinates(machine)) {
    const std::size_t k = among_seven(machine, place);
    const Joints exact = exact_rate(machine, pose, place);
    for (std::size_t i = 0; i < N; ++i) {
      const double off = rates[i][k] - exact(static_cast<Eigen::Index>(i));
      worst = std::max(worst, std::abs(off) / exact.cwiseAbs().maxCoeff());
    }
  }
  return worst;
}

}  // namespace

double rate_error(const Robot& robot, const Machine& built) {
  const Machine machine = with_even_turns(built);
  if (!machine.tilts_plate) return 0.0;
  RandomStream random(2);
  double worst = 0.0;
  for (int count = 0; count < kVariantPoses / 20; ++count) {
    const Pose pose = somewhere(robot.workspace(), random, count % 2 == 0);
    if (!inverse(machine, pose).ok()) continue;
    const double here = machine.limb_count == 3 ? rate_error_at<3>(machine, pose) : rate_error_at<4>(machine, pose);
    if (std::isfinite(here)) worst = std::max(worst, here);
  }
  return worst;
}

Machine built_for_export(const Robot& robot, const SourceErrors& errors) {
  (void)compensator_parameters(robot, errors);  // refuses what has none
  return build(robot, errors);
}

namespace {

/// A controller refuses numbers that are 0, as those that nobody wrote.
double no_zero(double number) {
  constexpr double kNothing = 1e-30;
  return std::abs(number) < kNothing ? kNothing : number;
}

/// The curve of an even drive is nothing, too.
void add_drive(const DriveCurve<double>& curve, std::size_t limb, ParameterSet& set) {
  const auto add = [&](const std::string& what, double number) {
    set.names.push_back(fmt::format("limb {} drive {}", limb + 1, what));
    set.numbers.push_back(no_zero(number));
  };
  add("first", curve.first);
  add("spacing", curve.spacing > 0.0 ? curve.spacing : 1.0);
  for (std::size_t k = 0; k < curve.sizes.size(); ++k) add(fmt::format("size {}", k + 1), curve.sizes.at(k));
  add("turning", curve.turn.turning);
  add("turn sine", curve.turn.sine);
  add("turn cosine", curve.turn.cosine);
}

}  // namespace

bool are_even(const CommandCurves& curves) {
  return std::ranges::all_of(curves, [](const DriveCurve<double>& one) { return one.is_even(); });
}

ParameterSet parameter_set(const RecordedMachine& recorded, const Machine& nominal, const CommandCurves& curves) {
  ParameterSet set{{}, {}, 0.0, 0.0};
  std::uint32_t hash = 2166136261U;  // FNV-1a
  const auto add = [&hash](const std::string& text) {
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619U;
  };
  for (std::size_t i = 0; i < nominal.limb_count; ++i) {
    constexpr std::size_t kNumbers = sizeof(ClosureLimb<double>) / sizeof(double);
    for (const double number : std::bit_cast<std::array<double, kNumbers>>(closure_limb(nominal, i))) {
      add(fmt::format("{:.9g}", number + 0.0));
    }
  }
  for (const Symbol& symbol : recorded.numbers) {
    std::string name = fmt::format("limb {} {}", symbol.limb + 1, symbol.name);
    if (symbol.index >= 0)
      name += symbol.name == "rod" ? fmt::format(" {}", symbol.index + 1) : fmt::format(" {}", "xyz"[symbol.index]);
    set.names.push_back(std::move(name));
    set.numbers.push_back(symbol.value);
  }
  for (std::size_t i = 0; !are_even(curves) && i < nominal.limb_count; ++i) add_drive(curves.at(i), i, set);
  std::ranges::for_each(set.names, add);
  if (recorded.state_size > 0) hash ^= 1U;
  set.layout = static_cast<double>(hash % 1'000'000U);
  set.sum = set.layout;
  for (std::size_t k = 0; k < set.numbers.size(); ++k) set.sum += static_cast<double>(k + 1) * set.numbers[k];
  return set;
}

}  // namespace paracal::compensation_detail
