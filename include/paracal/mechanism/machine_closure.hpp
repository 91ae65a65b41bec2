#pragma once

// How a machine closes, once: the library's kinematics, the compensator of a controller (compensation/compensator.hpp)
// and all exports are these lines, over double, float, the lanes of a vector register, or formulas that are printed for
// another language. They need only the standard library, limb_closure.hpp and drives/. Real-time: yes (noexcept, no
// allocation, no exception, no unbounded loop).

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "paracal/mechanism/drives/arm.hpp"
#include "paracal/mechanism/drives/rail.hpp"
#include "paracal/mechanism/drives/strut.hpp"
#include "paracal/mechanism/limb_closure.hpp"

namespace paracal {

/// A commanded pose: O' in {O}, mm; phi of an end-effector on a slide, rad; tilts of a plate that can be turned, rad:
/// R = Rot(x, tilt_x) Rot(y, tilt_y) Rot(z, tilt_z).
template <typename Scalar>
struct ClosurePose {
  Scalar x{}, y{}, z{};
  Scalar phi{};
  Scalar tilt_x{}, tilt_y{}, tilt_z{};
};

namespace closure {

template <typename Scalar, std::size_t Size>
bool all_finite(const std::array<Scalar, Size>& values, std::size_t count = Size) noexcept {
  for (std::size_t k = 0; k < count; ++k) {
    if (!std::isfinite(values[k])) return false;
  }
  return true;
}

/// Rows of the inverse of a symmetric matrix; not finite if it is singular.
template <typename Scalar>
std::array<Vector<Scalar>, 3> inverse_of_symmetric(const std::array<Vector<Scalar>, 3>& rows) noexcept {
  std::array<Vector<Scalar>, 3> inverse;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector<Scalar> normal = cross(rows[(k + 1) % 3], rows[(k + 2) % 3]);
    inverse[k] = scaled(normal, Scalar(1) / dot(normal, rows[k]));
  }
  return inverse;
}

/// Calls task(drive) with the one of drives/ that a limb has.
template <typename Scalar, typename Task>
constexpr auto with_drive(const ClosureLimb<Scalar>& limb, Task&& task) noexcept {
  switch (drive_of(limb)) {
    case Drive::arm:
      return task(ArmDrive<Scalar>{});
    case Drive::rail:
      return task(RailDrive<Scalar>{});
    default:
      return task(StrutDrive<Scalar>{});
  }
}

/// Its coordinate is a length, not an angle.
template <typename Scalar>
bool moves_in_mm(const ClosureLimb<Scalar>& limb) noexcept {
  return with_drive(limb, [](auto drive) { return drive.is_length; });
}

/// R of the plate, and the axes about which its three angles turn it: dR p = axis x R p d(tilt).
template <typename Scalar>
struct TurnedPlate : PlateColumns<Scalar> {
  std::array<Vector<Scalar>, 3> axes;

  Vector<Scalar> turned(const Vector<Scalar>& v) const noexcept { return combination(v, this->x, this->y, this->z); }
};

/// @param x, y, z  cos and sin of the three angles.
template <typename Scalar>
TurnedPlate<Scalar> turned_plate(const ArmDirection<Scalar>& x, const ArmDirection<Scalar>& y,
                                 const ArmDirection<Scalar>& z) noexcept {
  const PlateColumns<Scalar> columns = plate_columns(x, y, z);
  const Scalar zero(0);
  return {columns, {Vector<Scalar>{Scalar(1), zero, zero}, {zero, x.cosine, x.sine}, columns.z}};
}

/// The plate turned as commanded.
template <typename Scalar>
TurnedPlate<Scalar> commanded_plate(const ClosurePose<Scalar>& pose) noexcept {
  return turned_plate(turn_by_any(pose.tilt_x), turn_by_any(pose.tilt_y), turn_by_any(pose.tilt_z));
}

/// The plate that stays level: no turn is computed.
struct LevelPlate {
  template <typename Scalar>
  const Vector<Scalar>& turned(const Vector<Scalar>& v) const noexcept {
    return v;
  }
};

/// a_i + phi mu_i r_g shat: the plate joint from O', in {O'}.
template <typename Scalar>
Vector<Scalar> plate_joint(const ClosureLimb<Scalar>& limb, const Scalar& phi) noexcept {
  return sum(limb.plate, limb.slide, phi);
}

/// Position of the drive at one mean rod length from the plate joint, d from b_i; NaN when out of reach.
template <typename Scalar>
ArmDirection<Scalar> close_limb(const ClosureLimb<Scalar>& limb, const Vector<Scalar>& d) noexcept {
  return with_drive(limb, [&](auto drive) -> ArmDirection<Scalar> { return drive.close(limb, d); });
}

/// @param arm  of unit length.
template <typename Scalar>
ClosedElbow<Scalar> elbow_of(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>& arm) noexcept {
  return with_drive(limb, [&](auto drive) { return drive.elbow(limb, arm); });
}

/// How long a rod is with the drive there.
template <typename Scalar>
Scalar rod_length(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>& arm, std::size_t rod) noexcept {
  return with_drive(limb, [&](auto drive) -> Scalar { return drive.length(limb, arm, rod); });
}

/// How the tension |A - C| - l of a rod along n grows with the joint, mm per rad or mm.
template <typename Scalar>
Scalar rod_by_joint(const ClosureLimb<Scalar>& limb, const Vector<Scalar>& n, const Vector<Scalar>& v1) noexcept {
  return with_drive(limb, [&](auto drive) -> Scalar { return drive.rod_by_joint(limb, n, v1); });
}

/// Where a joint coordinate takes the drive: the unit vector of an arm; of a rail or strut 1, and travel or length.
template <typename Scalar>
ArmDirection<Scalar> arm_at(const ClosureLimb<Scalar>& limb, const Scalar& joint) noexcept {
  return with_drive(limb, [&](auto drive) -> ArmDirection<Scalar> {
    if constexpr (drive.is_length) return drive.at(Scalar(joint / limb.joint_per_mm + limb.joint_offset));
    return drive.at(Scalar(joint + limb.joint_offset));
  });
}

/// Joint coordinate for an arm in this direction, of any length.
template <typename Scalar>
Scalar joint_of(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>& arm) noexcept {
  return with_drive(limb, [&](auto drive) -> Scalar {
    const Scalar way = drive.place_of(arm) - limb.joint_offset;
    if constexpr (drive.is_length) return way * limb.joint_per_mm;
    return way;
  });
}

/// Moves an arm, a carriage or a strut by a change of its joint.
template <typename Scalar>
ArmDirection<Scalar> moved_by(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>& arm,
                              const Scalar& change) noexcept {
  return with_drive(limb, [&](auto drive) { return drive.moved(limb, arm, change); });
}

/// The upper ends of the rods of a limb in {O}, and how long its rods are; of one rod twice.
template <typename Scalar, std::size_t Rods = 2>
struct UpperEnds {
  ArmDirection<Scalar> arm;   ///< of unit length
  ClosedElbow<Scalar> elbow;  ///< between them
  std::array<Vector<Scalar>, Rods> place;
  std::array<Scalar, Rods> length;
};

/// @param arm  of unit length.
template <std::size_t Rods = 2, typename Scalar>
UpperEnds<Scalar, Rods> upper_ends(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>& arm) noexcept {
  UpperEnds<Scalar, Rods> ends{arm, elbow_of(limb, arm), {}, {}};
  if constexpr (Rods == 1) {
    ends.place[0] = ends.elbow.centre;
  } else {
    const Vector<Scalar> half = combination(limb.elbow_half, ends.elbow.u1, ends.elbow.v1, limb.axis);
    ends.place = {sum(ends.elbow.centre, half), sum(ends.elbow.centre, half, Scalar(-1))};
  }
  for (std::size_t j = 0; j < Rods; ++j) ends.length[j] = rod_length(limb, arm, j);
  return ends;
}

/// Their lower ends from O', in {O'}.
template <std::size_t Rods = 2, typename Scalar>
std::array<Vector<Scalar>, Rods> lower_ends(const ClosureLimb<Scalar>& limb, const Scalar& phi) noexcept {
  const Vector<Scalar> centre = plate_joint(limb, phi);
  if constexpr (Rods == 1) {
    return {centre};
  } else {
    return {sum(centre, limb.plate_half), sum(centre, limb.plate_half, Scalar(-1))};
  }
}

template <typename Scalar, std::size_t N>
using Arms = std::array<ArmDirection<Scalar>, N>;

/// Closed form of all limbs at a pose, the plate turned as commanded. All triangles come before the first arctangent,
/// so the short chains of arithmetic of the limbs overlap.
template <std::size_t N, typename Limbs, typename Scalar, typename Plate>
Arms<Scalar, N> closed_arms(const Limbs& limbs, const ClosurePose<Scalar>& pose, const Plate& plate) noexcept {
  const Vector<Scalar> position{pose.x, pose.y, pose.z};
  Arms<Scalar, N> arms;
  for (std::size_t i = 0; i < N; ++i) {
    const Vector<Scalar> joint_at_plate = sum(position, plate.turned(plate_joint<Scalar>(limbs[i], pose.phi)));
    arms[i] = close_limb<Scalar>(limbs[i], sum(joint_at_plate, limbs[i].base, Scalar(-1)));
  }
  return arms;
}

template <typename Limbs, typename Scalar, std::size_t N, typename Joints>
void joints_of(const Limbs& limbs, const Arms<Scalar, N>& arms, Joints& joints) noexcept {
  for (std::size_t i = 0; i < N; ++i) joints[i] = joint_of<Scalar>(limbs[i], arms[i]);
}

/// Arms of unit length.
template <typename Limbs, typename Scalar, std::size_t N>
Arms<Scalar, N> unit_arms(const Limbs& limbs, const Arms<Scalar, N>& arms) noexcept {
  Arms<Scalar, N> unit;
  for (std::size_t i = 0; i < N; ++i) {
    unit[i] =
        with_drive<Scalar>(limbs[i], [&](auto drive) -> ArmDirection<Scalar> { return drive.of_unit_length(arms[i]); });
  }
  return unit;
}

/// Change of all joints by the pose: x, y, z, tilt_x, tilt_y, tilt_z, phi; rad or mm per mm or rad.
template <typename Scalar>
using JointRates = std::array<Scalar, 7>;

/// From n . d(plate joint) + rod_by_joint dq = 0 for every limb, the mean rod along n. Exact for limbs of one rod. For
/// two, errors of the tilt group change it by their own size.
/// @param arms  of unit length.
template <std::size_t N, typename Limbs, typename Scalar, typename Turned>
std::array<JointRates<Scalar>, N> joint_rates(const Limbs& limbs, const ClosurePose<Scalar>& pose, const Turned& plate,
                                              const Arms<Scalar, N>& arms) noexcept {
  std::array<JointRates<Scalar>, N> rates;
  for (std::size_t i = 0; i < N; ++i) {
    const ClosedElbow<Scalar> elbow = elbow_of<Scalar>(limbs[i], arms[i]);
    const Vector<Scalar> lever = plate.turned(plate_joint<Scalar>(limbs[i], pose.phi));
    const Vector<Scalar> rod = sum(sum({pose.x, pose.y, pose.z}, lever), elbow.centre, Scalar(-1));
    // The length of the rod cancels, but for a strut, whose length is the joint's.
    const Scalar length = drive_of<Scalar>(limbs[i]) == Drive::strut ? arms[i].sine : Scalar(1);
    const Vector<Scalar> along = scaled(rod, Scalar(-1) / (length * rod_by_joint<Scalar>(limbs[i], rod, elbow.v1)));
    const Vector<Scalar> moment = cross(lever, along);
    rates[i] = {along[0],
                along[1],
                along[2],
                dot(plate.axes[0], moment),
                dot(plate.axes[1], moment),
                dot(plate.axes[2], moment),
                dot(along, plate.turned(limbs[i].slide))};
  }
  return rates;
}

// Limbs of two rods. They keep the plate from turning about some axes, and their errors turn it: the plate then stands
// where its rods, as springs of tension f = |rod| - l, are in balance (J^T f = 0, J = df / d(plate)). At a commanded
// pose the joints and the held angles are found from the closed form on: as many limbs as coordinates are commanded.

/// Arms and plate during the search; position, slide and commanded angles of the plate stay on the pose.
template <typename Scalar, std::size_t N>
struct TiltedPose {
  Arms<Scalar, N> arms;           ///< of unit length
  std::array<Scalar, N> moved{};  ///< changes of the joints since the closed form, rad or mm
  Vector<Scalar> tilt{};          ///< away from the commanded one, rad
};

/// The fourth coordinate that is commanded besides x, y and z: an angle of the plate (0, 1, 2), or the slide, if any.
inline constexpr std::size_t kSlide = 3;

/// The plate with angles that errors of two rods leave, all small, and a commanded one.
template <typename Scalar>
TurnedPlate<Scalar> plate_at(const ClosurePose<Scalar>& pose, std::size_t fourth, const Vector<Scalar>& tilt) noexcept {
  const std::array commanded{pose.tilt_x, pose.tilt_y, pose.tilt_z};
  const auto about = [&](std::size_t k) { return k == fourth ? turn_by_any(commanded[k]) : turn_by(tilt[k]); };
  return turned_plate(about(0), about(1), about(2));
}

/// Load of the rods on the plate.
template <typename Scalar>
struct Pull {
  Vector<Scalar> force{}, moment{};
  Scalar fourth{};
};

/// Components along the axes about which the plate's angles turn it; of a plate that stays level along x, y and z.
template <typename Scalar>
Vector<Scalar> about_axes(std::size_t fourth, const TurnedPlate<Scalar>& plate, const Vector<Scalar>& v) noexcept {
  if (fourth == kSlide) return v;
  return {dot(plate.axes[0], v), dot(plate.axes[1], v), dot(plate.axes[2], v)};
}

template <typename Limbs, typename Scalar, std::size_t N>
Pull<Scalar> pull_of_rods(const Limbs& limbs, const ClosurePose<Scalar>& pose, std::size_t fourth,
                          const TiltedPose<Scalar, N>& state) noexcept {
  using std::sqrt;
  const TurnedPlate<Scalar> plate = plate_at(pose, fourth, state.tilt);
  Pull<Scalar> pull;
  for (std::size_t i = 0; i < N; ++i) {
    const ClosureLimb<Scalar>& limb = limbs[i];
    const ClosedElbow<Scalar> elbow = elbow_of(limb, state.arms[i]);
    const Vector<Scalar> elbow_half = combination(limb.elbow_half, elbow.u1, elbow.v1, limb.axis);
    const Vector<Scalar> centre = plate.turned(plate_joint(limb, pose.phi));
    const Vector<Scalar> plate_half = plate.turned(limb.plate_half);
    const Vector<Scalar> mean_rod = sum(sum({pose.x, pose.y, pose.z}, centre), elbow.centre, Scalar(-1));
    const Vector<Scalar> half_rod = sum(plate_half, elbow_half, Scalar(-1));
    Vector<Scalar> both{};
    for (std::size_t j = 0; j < rod_count(limb); ++j) {
      const Scalar side = j == 0 ? Scalar(1) : Scalar(-1);
      const Vector<Scalar> rod = sum(mean_rod, half_rod, side);
      const Scalar length = sqrt(dot(rod, rod));
      const Scalar tight = rod_length(limb, state.arms[i], j);
      const Vector<Scalar> tension = scaled(rod, (length - tight) / length);
      both = sum(both, tension);
      pull.moment = sum(pull.moment, cross(sum(centre, plate_half, side), tension));
    }
    pull.force = sum(pull.force, both);
    if (fourth == kSlide) pull.fourth = pull.fourth + dot(plate.turned(limb.slide), both);
  }
  pull.moment = about_axes(fourth, plate, pull.moment);
  if (fourth != kSlide) pull.fourth = pull.moment[fourth];
  return pull;
}

/// Change of a limb's mean rod by motions of the plate: n by its position, and by the fourth coordinate (mm per rad).
/// The dual has the same form: the motion of the plate if only this limb's rod changes by 1 mm.
template <typename Scalar>
struct RodMotion {
  Vector<Scalar> position{};
  Scalar fourth{};
};

template <typename Scalar>
std::array<RodMotion<Scalar>, 3> dual_motions(const std::array<RodMotion<Scalar>, 3>& m) noexcept {
  std::array<RodMotion<Scalar>, 3> dual;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector<Scalar> normal = cross(m[(i + 1) % 3].position, m[(i + 2) % 3].position);
    dual[i] = {scaled(normal, Scalar(1) / dot(normal, m[i].position)), Scalar(0)};
  }
  return dual;
}

template <typename Scalar>
std::array<RodMotion<Scalar>, 4> dual_motions(const std::array<RodMotion<Scalar>, 4>& m) noexcept {
  std::array<RodMotion<Scalar>, 4> dual;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& [a, alpha] = m[(i + 1) % 4];
    const auto& [b, beta] = m[(i + 2) % 4];
    const auto& [c, gamma] = m[(i + 3) % 4];
    const Vector<Scalar> bc = cross(b, c);
    const Vector<Scalar> position = sum(sum(scaled(bc, alpha), cross(c, a), beta), cross(a, b), gamma);
    const Scalar fourth = -dot(a, bc);
    const Scalar scale = Scalar(1) / (dot(position, m[i].position) + fourth * m[i].fourth);
    dual[i] = {scaled(position, scale), fourth * scale};
  }
  return dual;
}

/// Response of arms and plate to a pull, with parallel rods in each limb: J^T (f + J_q dq + J_tilt dtilt) = 0 then
/// splits into the commanded coordinates, by their limbs, and the held angles. (The short sides of two rods are
/// parallel to an axis about which the plate can be commanded: else its angle could not change.) Computed once, for the
/// closed form. Errors of the tilt group change it by their own size, so each step leaves about a thousandth of the
/// error.
template <typename Scalar, std::size_t N>
struct Answer {
  std::array<RodMotion<Scalar>, N> dual;
  std::array<Vector<Scalar>, N> moment;   ///< plate joint x n, about the axes of the angles
  std::array<Scalar, N> by_joint;         ///< change of the rods by the joint, mm per rad or mm
  std::array<Vector<Scalar>, 3> by_tilt;  ///< inverse of 2 sum h h^T, h = plate half x n; 0 for a commanded angle
};

template <typename Limbs, typename Scalar, std::size_t N>
Answer<Scalar, N> answer_at(const Limbs& limbs, const ClosurePose<Scalar>& pose, std::size_t fourth,
                            const Arms<Scalar, N>& arms) noexcept {
  using std::sqrt;
  const TurnedPlate<Scalar> plate = plate_at(pose, fourth, Vector<Scalar>{Scalar(0), Scalar(0), Scalar(0)});
  Answer<Scalar, N> answer;
  std::array<RodMotion<Scalar>, N> motions;
  std::array<Vector<Scalar>, 3> tilt{};
  for (std::size_t i = 0; i < N; ++i) {
    const ClosureLimb<Scalar>& limb = limbs[i];
    const ClosedElbow<Scalar> elbow = elbow_of(limb, arms[i]);
    const Vector<Scalar> centre = plate.turned(plate_joint(limb, pose.phi));
    const Vector<Scalar> rod = sum(sum({pose.x, pose.y, pose.z}, centre), elbow.centre, Scalar(-1));
    const Vector<Scalar> n = scaled(rod, Scalar(1) / sqrt(dot(rod, rod)));
    answer.moment[i] = about_axes(fourth, plate, cross(centre, n));
    motions[i] = {n, fourth == kSlide ? dot(n, plate.turned(limb.slide)) : answer.moment[i][fourth]};
    answer.by_joint[i] = rod_by_joint(limb, n, elbow.v1);
    const Vector<Scalar> h = about_axes(fourth, plate, cross(plate.turned(limb.plate_half), n));
    for (std::size_t k = 0; k < 3; ++k) tilt[k] = sum(tilt[k], h, Scalar(2) * h[k]);
  }
  answer.dual = dual_motions(motions);
  for (std::size_t k = 0; fourth != kSlide && k < 3; ++k) {
    tilt[fourth][k] = tilt[k][fourth] = k == fourth ? Scalar(1) : Scalar(0);
  }
  answer.by_tilt = inverse_of_symmetric(tilt);
  if (fourth != kSlide) answer.by_tilt[fourth] = {Scalar(0), Scalar(0), Scalar(0)};
  return answer;
}

/// One step towards balance.
/// @returns rotations of each arm (of the rods for a length) and of the plate, rad.
template <typename Limbs, typename Scalar, std::size_t N>
std::array<Scalar, N + 3> step(const Limbs& limbs, const ClosurePose<Scalar>& pose, std::size_t fourth,
                               const Answer<Scalar, N>& answer, TiltedPose<Scalar, N>& state) noexcept {
  const Pull<Scalar> pull = pull_of_rods(limbs, pose, fourth, state);
  std::array<Scalar, N> both;  // change of the sum of a limb's rods
  Vector<Scalar> moment = pull.moment;
  for (std::size_t i = 0; i < N; ++i) {
    both[i] = -(dot(answer.dual[i].position, pull.force) + answer.dual[i].fourth * pull.fourth);
    moment = sum(moment, answer.moment[i], both[i]);
  }
  const Vector<Scalar> tilt =
      scaled(combination(moment, answer.by_tilt[0], answer.by_tilt[1], answer.by_tilt[2]), Scalar(-1));
  state.tilt = sum(state.tilt, tilt);
  std::array<Scalar, N + 3> changes;
  for (std::size_t i = 0; i < N; ++i) {
    const Scalar change = (both[i] * (Scalar(1) / limbs[i].rods) - dot(answer.moment[i], tilt)) / answer.by_joint[i];
    state.arms[i] = moved_by<Scalar>(limbs[i], state.arms[i], change);
    state.moved[i] = state.moved[i] + change;
    changes[i] = moves_in_mm<Scalar>(limbs[i]) ? change / limbs[i].rod[0] : change;
  }
  for (std::size_t k = 0; k < 3; ++k) changes[N + k] = tilt[k];
  return changes;
}

/// Largest remaining error, rad: each further step would be smaller by the ratio of the last two.
template <typename Scalar>
inline constexpr Scalar kSettled = Scalar(100) * std::numeric_limits<Scalar>::epsilon();

inline constexpr int kMostSteps = 20;  ///< usually three or four

/// From the closed form to the balance of the rods.
/// @param arms    the closed form; N is 3, or 4 with a fourth coordinate.
/// @param joints  of the closed form; of the balance when it is found.
/// @returns steps; 0 when it is not found, at singular poses.
template <std::size_t N, typename Limbs, typename Scalar, typename Joints>
int settle(const Limbs& limbs, const ClosurePose<Scalar>& pose, std::size_t fourth, const Arms<Scalar, N>& arms,
           Joints& joints, Vector<Scalar>& tilt) noexcept {
  TiltedPose<Scalar, N> state{unit_arms(limbs, arms)};
  const Answer<Scalar, N> answer = answer_at(limbs, pose, fourth, state.arms);
  Scalar before(1);
  for (int count = 1; count <= kMostSteps; ++count) {
    const std::array<Scalar, N + 3> changes = step(limbs, pose, fourth, answer, state);
    if (!all_finite(changes)) return 0;
    Scalar largest{};
    for (const Scalar change : changes) largest = std::abs(change) > largest ? std::abs(change) : largest;
    if (largest <= before && largest * largest <= kSettled<Scalar> * before) {
      for (std::size_t i = 0; i < N; ++i) joints[i] += state.moved[i];
      tilt = state.tilt;
      return count;
    }
    before = largest;
  }
  return 0;
}

}  // namespace closure
}  // namespace paracal
