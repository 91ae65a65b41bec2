#include "paracal/compensation/path.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lanes.hpp"

// One body for every vector width; the loader picks. Sanitizers cannot run before it has.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define PARACAL_FOR_EVERY_WIDTH __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), flatten))
#else
#define PARACAL_FOR_EVERY_WIDTH
#endif

namespace paracal {
namespace {

using closure::Arms, closure::dot, closure::Lanes, closure::sum, closure::kLanes;

using LaneLimbs = ClosureLimbs<Lanes, kLevelLimbs>;

Lanes larger(const Lanes& a, const Lanes& b) { return choose(a.values > b.values, a, b); }

bool all(const Lanes::Mask& mask) {
  for (std::size_t k = 0; k < kLanes; ++k) {
    if (mask[k] == 0) return false;
  }
  return true;
}

/// The same limbs in every lane.
LaneLimbs in_lanes(const ClosureLimbs<double, kCompensatorLimbs>& limbs) {
  LaneLimbs lanes;
  for (std::size_t i = 0; i < kLevelLimbs; ++i) lanes[i] = limb_of<Lanes>(numbers_of(limbs[i]));
  return lanes;
}

/// The robot that a closed controller computes with.
struct Nominal {
  LaneLimbs limbs;
  /// From the identified arms to the nominal ones: cos and sin of the offset between them; of rails the ratio of the
  /// gains, and the offset, mm.
  Arms<Lanes, kLevelLimbs> offsets;
};

struct Block {
  CompensatorPose<Lanes> pose;
  CompensatorJoints<Lanes> joints;
  ClosureVector<Lanes> tilt{};
  Lanes::Mask good;                  ///< lanes whose answer stands
  const Nominal* nominal = nullptr;  ///< of which targets are wanted
  CompensatorPose<Lanes> target{};
};

/// Takes turns that grow smaller, as settle (compensator.hpp) does, until every lane has settled or left the finite.
/// @returns the arms, of unit length.
template <std::size_t N>
Arms<Lanes, N> settle(const LaneLimbs& limbs, const Arms<Lanes, N>& level, Block& block) {
  constexpr int kMaxSteps = 8;
  closure::TiltedPose<Lanes, N> state{closure::unit_arms(limbs, level)};
  const auto answer = closure::answer_at(limbs, block.pose, closure::kSlide, state.arms);
  Lanes before(1.0);
  Lanes::Mask settled{};
  for (int count = 0; count < kMaxSteps; ++count) {
    Lanes largest(0.0), sum(0.0);
    for (const Lanes& change : closure::step(limbs, block.pose, closure::kSlide, answer, state)) {
      largest = larger(abs(change), largest);
      sum = sum + change;
    }
    const Lanes::Mask finite = is_finite(sum);
    settled |= finite & (largest.values <= before.values) &
               ((largest * largest).values <= (Lanes(closure::kSettled<double>) * before).values);
    if (all(settled | ~finite)) break;
    before = largest;
  }
  for (std::size_t i = 0; i < N; ++i) block.joints[i] = block.joints[i] + state.moved[i];
  block.tilt = state.tilt;
  block.good &= settled;
  return state.arms;
}

/// Where the joints of these arms take the elbows of the nominal robot.
template <std::size_t N>
std::array<ClosureVector<Lanes>, N> nominal_elbows(const Nominal& nominal, const Arms<Lanes, N>& arms) {
  std::array<ClosureVector<Lanes>, N> centres;
  for (std::size_t i = 0; i < N; ++i) {
    const auto [c, s] = nominal.offsets[i];
    const auto [cosine, sine] = arms[i];
    const ArmDirection<Lanes> arm = closure::moves_in_mm(nominal.limbs[i])
                                        ? ArmDirection<Lanes>{cosine, c * sine - s}
                                        : ArmDirection<Lanes>{c * cosine + s * sine, c * sine - s * cosine};
    centres[i] = closure::elbow_of(nominal.limbs[i], arm).centre;
  }
  return centres;
}

Lanes size_of(const ClosureVector<Lanes>& v) { return larger(larger(abs(v[0]), abs(v[1])), abs(v[2])); }

/// A step of Newton's on |r + a_i + phi s_i - C_i| = l_i.
struct PlateStep {
  ClosureVector<Lanes> position{};  ///< mm
  Lanes phi{0.0};                   ///< rad
  Lanes gain{0.0};                  ///< how far the plate moves if one rod changes, mm a mm
};

/// @param lever  mm a rad of phi.
template <std::size_t N>
PlateStep step_to_rods(const LaneLimbs& limbs, const std::array<ClosureVector<Lanes>, N>& centres,
                       const ClosureVector<Lanes>& position, const Lanes& phi, const Lanes& lever) {
  using closure::RodMotion;
  std::array<RodMotion<Lanes>, N> motions;
  std::array<Lanes, N> excess;
  for (std::size_t i = 0; i < N; ++i) {
    const auto joint = sum(position, closure::plate_joint(limbs[i], phi));
    const auto rod = sum(joint, centres[i], Lanes(-1.0));
    const Lanes length = sqrt(dot(rod, rod));
    const auto along = closure::scaled(rod, Lanes(1.0) / length);
    motions[i] = {along, dot(along, limbs[i].slide)};
    excess[i] = length - limbs[i].rod[0];
  }
  PlateStep step;
  for (std::size_t i = 0; const RodMotion<Lanes>& dual : closure::dual_motions(motions)) {
    step.position = sum(step.position, dual.position, -excess[i]);
    step.phi = step.phi - excess[i++] * dual.fourth;
    step.gain = larger(step.gain, larger(size_of(dual.position), lever * abs(dual.fourth)));
  }
  return step;
}

/// The level plate of the nominal robot at its rods' length from the elbows, from the wanted pose on until the next
/// step would be lost in rounding (each leaves its own square over the rod). Lanes stay good where it settles near the
/// wanted pose, and the rods hold the plate there.
template <std::size_t N>
void find_target(const Arms<Lanes, N>& arms, Block& block) {
  constexpr int kMaxSteps = 6;
  constexpr double kSettled = 1e-5, kNear = 50.0, kHeld = 20.0;  // mm, mm, mm a mm
  const LaneLimbs& limbs = block.nominal->limbs;
  const auto centres = nominal_elbows<N>(*block.nominal, arms);
  const ClosureVector<Lanes> wanted{block.pose.x, block.pose.y, block.pose.z};
  ClosureVector<Lanes> position = wanted;
  Lanes phi = block.pose.phi;
  const Lanes lever(std::sqrt(dot(limbs[0].slide, limbs[0].slide)[0]));
  Lanes::Mask settled{}, held = ~settled;
  for (int count = 0; count < kMaxSteps && !all(settled); ++count) {
    const PlateStep step = step_to_rods<N>(limbs, centres, position, phi, lever);
    for (std::size_t k = 0; k < 3; ++k) position[k] = choose(settled, position[k], position[k] + step.position[k]);
    phi = choose(settled, phi, phi + step.phi);
    held &= settled | (step.gain.values < kHeld);
    settled |= larger(size_of(step.position), lever * abs(step.phi)).values < kSettled;
  }
  const Lanes off = larger(size_of(sum(position, wanted, Lanes(-1.0))), lever * abs(phi - block.pose.phi));
  block.good &= settled & held & (off.values < kNear);
  block.target = {.x = position[0], .y = position[1], .z = position[2], .phi = phi};
}

template <std::size_t N>
void solve(const LaneLimbs& limbs, bool tilts_plate, Block& block) {
  Arms<Lanes, N> arms = closure::closed_arms<N>(limbs, block.pose, closure::LevelPlate{});
  if (block.nominal == nullptr) closure::joints_of(limbs, arms, block.joints);
  block.good = block.pose.phi.values == (N == 4 ? block.pose.phi : Lanes(0.0)).values;
  if (tilts_plate) {
    arms = settle<N>(limbs, arms, block);
  } else if (block.nominal != nullptr) {
    arms = closure::unit_arms(limbs, arms);
  }
  if (block.nominal != nullptr) find_target<N>(arms, block);
  for (std::size_t i = 0; i < N; ++i) block.good &= is_finite(block.joints[i]);
}

PARACAL_FOR_EVERY_WIDTH
void solve_four(const LaneLimbs& limbs, bool tilts_plate, Block& block) { solve<4>(limbs, tilts_plate, block); }

PARACAL_FOR_EVERY_WIDTH
void solve_three(const LaneLimbs& limbs, bool tilts_plate, Block& block) { solve<3>(limbs, tilts_plate, block); }

/// The last pose again where there are fewer than lanes.
CompensatorPose<Lanes> load(std::span<const CompensatorPose<double>> poses) {
  CompensatorPose<Lanes> lanes;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const CompensatorPose<double>& pose = poses[std::min(k, poses.size() - 1)];
    lanes.x.set(k, pose.x);
    lanes.y.set(k, pose.y);
    lanes.z.set(k, pose.z);
    lanes.phi.set(k, pose.phi);
  }
  return lanes;
}

}  // namespace

namespace {

void solve(const CompensatorParameters<double>& parameters, const LaneLimbs& limbs, Block& block) {
  const bool tilts_plate = parameters.tilts_plate != 0;
  parameters.limb_count == 4 ? solve_four(limbs, tilts_plate, block) : solve_three(limbs, tilts_plate, block);
}

/// The nominal robot, and by how much its joints differ from the identified arms.
Nominal nominal_robot(const CompensatorParameters<double>& parameters) {
  Nominal nominal{in_lanes(parameters.nominal), {}};
  for (std::size_t i = 0; i < kLevelLimbs; ++i) {
    const ClosureLimb<double>&is = parameters.identified[i], &meant = parameters.nominal[i];
    const double ratio = is.joint_per_mm / meant.joint_per_mm;
    const double offset = ratio * is.joint_offset - meant.joint_offset;
    nominal.offsets[i] = closure::moves_in_mm(meant)
                             ? ArmDirection<Lanes>{Lanes(ratio), Lanes(offset)}
                             : ArmDirection<Lanes>{Lanes(std::cos(offset)), Lanes(std::sin(offset))};
  }
  return nominal;
}

}  // namespace

void compensate_path(const CompensatorParameters<double>& parameters, std::span<const CompensatorPose<double>> poses,
                     std::span<CompensatorJoints<double>> joints, std::span<CompensationStatus> statuses,
                     std::span<CompensatorTilt<double>> tilts) {
  const std::size_t size = poses.size();
  if (joints.size() != size || statuses.size() != size || (!tilts.empty() && tilts.size() != size)) {
    throw std::invalid_argument("compensate_path: expected joints, statuses and tilts for each pose");
  }
  if (parameters.is_level == 0) {
    for (std::size_t k = 0; k < size; ++k) {
      CompensatorTilt<double>* const tilt = tilts.empty() ? nullptr : &tilts[k];
      statuses[k] = compensate(parameters, CompensationWay::exact, poses[k], joints[k], tilt);
    }
    return;
  }
  const LaneLimbs limbs = in_lanes(parameters.identified);
  for (std::size_t first = 0; first < size; first += kLanes) {
    Block block{.pose = load(poses.subspan(first)), .joints = {}, .tilt = {}, .good = {}};
    solve(parameters, limbs, block);
    for (std::size_t k = 0; k < std::min(kLanes, size - first); ++k) {
      const std::size_t at = first + k;
      CompensatorTilt<double>* const tilt = tilts.empty() ? nullptr : &tilts[at];
      if (block.good[k] == 0) {
        statuses[at] = compensate(parameters, CompensationWay::exact, poses[at], joints[at], tilt);
        continue;
      }
      joints[at] = {};
      for (std::size_t i = 0; i < parameters.limb_count; ++i) {
        joints[at][i] = parameters.drives[i].commanded(block.joints[i][k]);
      }
      if (tilt != nullptr) *tilt = {block.tilt[0][k], block.tilt[1][k], block.tilt[2][k]};
      statuses[at] = CompensationStatus::ok;
    }
  }
}

void nominal_targets(const CompensatorParameters<double>& parameters, std::span<const CompensatorPose<double>> poses,
                     std::span<std::optional<CompensatorPose<double>>> targets) {
  if (targets.size() != poses.size()) throw std::invalid_argument("nominal_targets: expected a target for each pose");
  std::ranges::fill(targets, std::nullopt);
  const bool are_even = std::ranges::all_of(parameters.drives, [](const auto& one) { return one.is_even(); });
  if (parameters.is_level == 0 || !are_even) return;
  const LaneLimbs limbs = in_lanes(parameters.identified);
  const Nominal nominal = nominal_robot(parameters);
  for (std::size_t first = 0; first < poses.size(); first += kLanes) {
    Block block{.pose = load(poses.subspan(first)), .joints = {}, .tilt = {}, .good = {}, .nominal = &nominal};
    solve(parameters, limbs, block);
    const ClosurePose<Lanes>& at = block.target;
    for (std::size_t k = 0; k < std::min(kLanes, poses.size() - first); ++k) {
      if (block.good[k] == 0) continue;
      targets[first + k] = CompensatorPose<double>{.x = at.x[k], .y = at.y[k], .z = at.z[k], .phi = at.phi[k]};
    }
  }
}

}  // namespace paracal
