#include "paracal/compensation/path.hpp"

#include <algorithm>
#include <bit>
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

using compensation_detail::Arms, compensation_detail::choose, compensation_detail::kLanes, compensation_detail::Lanes;

using Limb = CompensatorLimb<Lanes>;
using Limbs = std::array<Limb, kCompensatorLimbs>;

/// The same limbs in every lane.
Limbs in_lanes(const std::array<CompensatorLimb<double>, kCompensatorLimbs>& limbs) {
  constexpr std::size_t kNumbers = sizeof(limbs) / sizeof(double);
  const auto numbers = std::bit_cast<std::array<double, kNumbers>>(limbs);
  std::array<Lanes, kNumbers> lanes;
  std::ranges::transform(numbers, lanes.begin(), [](double number) { return Lanes(number); });
  return std::bit_cast<Limbs>(lanes);
}

struct Block {
  CompensatorPose<Lanes> pose;
  CompensatorJoints<Lanes> joints;
  CompensatorVector<Lanes> tilt{};
  Lanes::Mask good;  ///< lanes whose answer stands
};

/// Takes turns that grow smaller, as settle (compensator.hpp) does, until every lane has settled or left the finite.
template <std::size_t N>
void settle(const Limbs& limbs, const Arms<Lanes, N>& level, Block& block) {
  constexpr int kMaxSteps = 8;
  auto state = compensation_detail::level_pose(limbs, level);
  const auto answer = compensation_detail::answer_at(limbs, block.pose, state.arms);
  Lanes before(1.0);
  Lanes::Mask settled{};
  for (int count = 0; count < kMaxSteps; ++count) {
    Lanes largest(0.0), sum(0.0);
    for (const Lanes& change : compensation_detail::step(limbs, block.pose, answer, state)) {
      largest = choose(abs(change).values > largest.values, abs(change), largest);
      sum = sum + change;
    }
    const Lanes::Mask finite = is_finite(sum);
    settled |= finite & (largest.values <= before.values) &
               ((largest * largest).values <= (Lanes(compensation_detail::kSettled<double>) * before).values);
    bool done = true;
    for (std::size_t k = 0; k < kLanes; ++k) done = done && (settled[k] != 0 || finite[k] == 0);
    if (done) break;
    before = largest;
  }
  for (std::size_t i = 0; i < N; ++i) block.joints[i] = block.joints[i] + state.moved[i];
  block.tilt = state.tilt;
  block.good &= settled;
}

template <std::size_t N>
void solve(const Limbs& limbs, bool tilts_plate, Block& block) {
  const Arms<Lanes, N> arms = compensation_detail::level_arms<N>(limbs, block.pose);
  compensation_detail::joints_of(limbs, arms, block.joints);
  block.good = block.pose.phi.values == (N == 4 ? block.pose.phi : Lanes(0.0)).values;
  if (tilts_plate) settle<N>(limbs, arms, block);
  for (std::size_t i = 0; i < N; ++i) block.good &= is_finite(block.joints[i]);
}

PARACAL_FOR_EVERY_WIDTH
void solve_four(const Limbs& limbs, bool tilts_plate, Block& block) { solve<4>(limbs, tilts_plate, block); }

PARACAL_FOR_EVERY_WIDTH
void solve_three(const Limbs& limbs, bool tilts_plate, Block& block) { solve<3>(limbs, tilts_plate, block); }

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

void compensate_path(const CompensatorParameters<double>& parameters, std::span<const CompensatorPose<double>> poses,
                     std::span<CompensatorJoints<double>> joints, std::span<CompensationStatus> statuses,
                     std::span<CompensatorTilt<double>> tilts) {
  const std::size_t size = poses.size();
  if (joints.size() != size || statuses.size() != size || (!tilts.empty() && tilts.size() != size)) {
    throw std::invalid_argument("compensate_path: expected joints, statuses and tilts for each pose");
  }
  const Limbs limbs = in_lanes(parameters.identified);
  const bool tilts_plate = parameters.tilts_plate != 0;
  for (std::size_t first = 0; first < size; first += kLanes) {
    Block block{.pose = load(poses.subspan(first)), .joints = {}, .tilt = {}, .good = {}};
    parameters.limb_count == 4 ? solve_four(limbs, tilts_plate, block) : solve_three(limbs, tilts_plate, block);
    for (std::size_t k = 0; k < std::min(kLanes, size - first); ++k) {
      const std::size_t at = first + k;
      CompensatorTilt<double>* const tilt = tilts.empty() ? nullptr : &tilts[at];
      if (block.good[k] == 0) {
        statuses[at] = compensate(parameters, CompensationWay::exact, poses[at], joints[at], tilt);
        continue;
      }
      joints[at] = {};
      for (std::size_t i = 0; i < parameters.limb_count; ++i) joints[at][i] = block.joints[i][k];
      if (tilt != nullptr) *tilt = {block.tilt[0][k], block.tilt[1][k]};
      statuses[at] = CompensationStatus::ok;
    }
  }
}

}  // namespace paracal
