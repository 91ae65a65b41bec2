#pragma once

// The compensator that runs in a controller: from a commanded pose to the joint coordinates that bring the identified
// machine there. This header and limb_closure.hpp need only the standard library and may be copied alone.
// Everything in them is real-time safe: noexcept, no allocation, no lock, no exception, no unbounded loop, no state
// between calls.
//
// Its parameters are computed once, outside the control thread, by compensator_parameters (parameters.hpp).

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "paracal/mechanism/limb_closure.hpp"

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "compensator.hpp detects unreachable poses by non-finite numbers: compile without -ffinite-math-only"
#endif

namespace paracal {

inline constexpr std::size_t kCompensatorLimbs = 4;

template <typename Scalar>
using CompensatorVector = std::array<Scalar, 3>;

/// One limb of a machine as the closure needs it [huang2016, Eq. (1)]; mm, in the base frame {O} unless said otherwise.
template <typename Scalar>
struct CompensatorLimb {
  CompensatorVector<Scalar> base{};                      ///< b_i
  CompensatorVector<Scalar> radial{}, normal{}, axis{};  ///< u_0, v_0, w_0: columns of R_0
  CompensatorVector<Scalar> plate{};                     ///< a_i, in {O'}
  CompensatorVector<Scalar> slide{};                     ///< mu_i r_g shat, in {O'}: motion of A_i per rad of phi
  CompensatorVector<Scalar> elbow_half{};                ///< (c_c / 2) R_2 e_3, along u_1, v_1, w_0
  CompensatorVector<Scalar> plate_half{};                ///< (c_a / 2) R_3 e_3, in {O'}
  std::array<Scalar, 2> rod{};                           ///< l_1, l_2
  Scalar arm{};                                          ///< L_i
  Scalar joint_offset{};                                 ///< added to the commanded joint coordinate, rad or mm
  /// 0: the joint rotates an arm, C = b + L u_1; 1: it moves a carriage along a rail,
  /// C = b - L u_0 + (q / joint_per_mm + joint_offset) v_0
  Scalar on_rail{};
  /// On a rail: mm of the joint coordinate per mm of travel of the carriage, 1 / gain.
  Scalar joint_per_mm = Scalar(1);
};

/// All parameters of a compensator: plain numbers of fixed size, without padding, to be copied as bytes.
template <typename Scalar>
struct CompensatorParameters {
  std::array<CompensatorLimb<Scalar>, kCompensatorLimbs> identified{}, nominal{};
  /// dp_d of each limb, mm: L theta_offset, e_x, e_y, e_z, arm_length, L alpha0, L beta0, rod_mean. On a
  /// rail: theta_offset (a length), rod length instead of L, and gain, mm/m, instead of arm_length.
  std::array<std::array<Scalar, 8>, kCompensatorLimbs> position_errors{};
  /// dp_e of each limb, rad: rod_difference / c, width_difference / c, alpha03, beta03, alpha2, beta2.
  std::array<std::array<Scalar, 6>, kCompensatorLimbs> tilt_errors{};
  std::uint32_t limb_count = 0;   ///< 4 with a slide, 3 with a rigid plate
  std::uint32_t tilts_plate = 0;  ///< 1: at least one error of the tilt group is not zero
};

/// The same robot without errors: the fallback of a controller.
template <typename Scalar>
CompensatorParameters<Scalar> without_errors(const CompensatorParameters<Scalar>& parameters) noexcept {
  CompensatorParameters<Scalar> nominal;
  nominal.identified = nominal.nominal = parameters.nominal;
  nominal.limb_count = parameters.limb_count;
  return nominal;
}

/// The commanded pose: O' in {O}, mm; phi of the end-effector, rad (0 for a rigid plate).
template <typename Scalar>
struct CompensatorPose {
  Scalar x{}, y{}, z{};
  Scalar phi{};
};

/// Joint coordinates to command, rad (mm on rails), one per limb; entries beyond the number of limbs are not used.
template <typename Scalar>
using CompensatorJoints = std::array<Scalar, kCompensatorLimbs>;

/// Tilt of the plate that no joint command can remove, rad.
template <typename Scalar>
struct CompensatorTilt {
  Scalar eps_x{}, eps_y{};
};

enum class CompensationWay : std::uint8_t {
  linear,      ///< nominal inverse + dq_m of the position group [huang2016, Eqs. (22), (23)]
  tilt_aware,  ///< also the displacement of the plate by the tilt group [huang2016, Eq. (8)]
  exact,       ///< inverse of the identified machine with all errors
};

enum class CompensationStatus : std::uint8_t {
  ok,
  unreachable,  ///< an arm and its rods do not meet there, or a rigid plate should turn
  not_finite,   ///< the commanded pose contains NaN or infinity
  singular,     ///< the limbs do not hold the plate there: the correction has no solution
};

namespace compensation_detail {

template <typename Scalar>
using Vector = CompensatorVector<Scalar>;

template <typename Scalar>
Scalar dot(const Vector<Scalar>& a, const Vector<Scalar>& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <typename Scalar>
Vector<Scalar> cross(const Vector<Scalar>& a, const Vector<Scalar>& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// a + factor b
template <typename Scalar>
Vector<Scalar> sum(const Vector<Scalar>& a, const Vector<Scalar>& b, Scalar factor = Scalar(1)) noexcept {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

template <typename Scalar>
Vector<Scalar> scaled(const Vector<Scalar>& a, Scalar factor) noexcept {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}

/// x a + y b + z c
template <typename Scalar>
Vector<Scalar> combination(const Vector<Scalar>& weights, const Vector<Scalar>& a, const Vector<Scalar>& b,
                           const Vector<Scalar>& c) noexcept {
  const auto [x, y, z] = weights;
  return {x * a[0] + y * b[0] + z * c[0], x * a[1] + y * b[1] + z * c[1], x * a[2] + y * b[2] + z * c[2]};
}

template <typename Scalar, std::size_t Size>
bool all_finite(const std::array<Scalar, Size>& values, std::size_t count = Size) noexcept {
  for (std::size_t k = 0; k < count; ++k) {
    if (!std::isfinite(values[k])) return false;
  }
  return true;
}

/// a_i + phi mu_i r_g shat: the plate joint from O', in {O'}.
template <typename Scalar>
Vector<Scalar> plate_joint(const CompensatorLimb<Scalar>& limb, Scalar phi) noexcept {
  return sum(limb.plate, limb.slide, phi);
}

template <typename Scalar>
bool runs_on_rail(const CompensatorLimb<Scalar>& limb) noexcept {
  return limb.on_rail != Scalar(0);
}

/// Position of the arm or the carriage at one mean rod length from the plate joint, d from b_i.
template <typename Scalar>
ArmDirection<Scalar> close_limb(const CompensatorLimb<Scalar>& limb, const Vector<Scalar>& d) noexcept {
  const Scalar rod = Scalar(0.5) * (limb.rod[0] + limb.rod[1]);
  const Scalar radial = dot(d, limb.radial), normal = dot(d, limb.normal);
  if (!runs_on_rail(limb)) return close_triangle(ArmReach<Scalar>{radial, normal, dot(d, d), limb.arm, rod});
  return {Scalar(1), close_on_rail(RailReach<Scalar>{radial, normal, dot(d, limb.axis), limb.arm, rod})};
}

/// The elbow (on a rail the carriage) in {O}: its centre C and the directions fixed to its short side.
template <typename Scalar>
struct ClosedElbow {
  Vector<Scalar> u1, v1, centre;
};

/// @param arm  of unit length.
template <typename Scalar>
ClosedElbow<Scalar> elbow_of(const CompensatorLimb<Scalar>& limb, const ArmDirection<Scalar>& arm) noexcept {
  if (runs_on_rail(limb)) {
    return {limb.radial, limb.normal, sum(sum(limb.base, limb.radial, -limb.arm), limb.normal, arm.sine)};
  }
  const Vector<Scalar> u1 = sum(scaled(limb.radial, arm.cosine), limb.normal, arm.sine);
  const Vector<Scalar> v1 = sum(scaled(limb.normal, arm.cosine), limb.radial, -arm.sine);
  return {u1, v1, sum(limb.base, u1, limb.arm)};
}

template <typename Scalar, std::size_t N>
using Arms = std::array<ArmDirection<Scalar>, N>;

/// Closed form for all limbs with a level plate. All triangles come before the first arctangent, so the short chains of
/// arithmetic of the limbs overlap.
template <std::size_t N, typename Scalar>
Arms<Scalar, N> level_arms(const std::array<CompensatorLimb<Scalar>, kCompensatorLimbs>& limbs,
                           const CompensatorPose<Scalar>& pose) noexcept {
  const Vector<Scalar> position{pose.x, pose.y, pose.z};
  Arms<Scalar, N> arms;
  for (std::size_t i = 0; i < N; ++i) {
    const Vector<Scalar> joint_at_plate = sum(position, plate_joint(limbs[i], pose.phi));
    const Vector<Scalar> d = sum(joint_at_plate, limbs[i].base, Scalar(-1));
    arms[i] = close_limb(limbs[i], d);
  }
  return arms;
}

/// Position of the arm, rad, or of the carriage, mm, for a joint coordinate.
template <typename Scalar>
Scalar place_of(const CompensatorLimb<Scalar>& limb, Scalar joint) noexcept {
  return (runs_on_rail(limb) ? joint / limb.joint_per_mm : joint) + limb.joint_offset;
}

/// Joint coordinates to command for arms in these directions.
template <typename Scalar, std::size_t N>
void joints_of(const std::array<CompensatorLimb<Scalar>, kCompensatorLimbs>& limbs, const Arms<Scalar, N>& arms,
               CompensatorJoints<Scalar>& joints) noexcept {
  using std::atan2;
  for (std::size_t i = 0; i < N; ++i) {
    const auto [c, s] = arms[i];
    joints[i] = runs_on_rail(limbs[i]) ? (s - limbs[i].joint_offset) * limbs[i].joint_per_mm
                                       : atan2(s, c) - limbs[i].joint_offset;
  }
}

/// @returns whether every limb reaches; joints are then finite.
template <std::size_t N, typename Scalar>
bool level_inverse(const std::array<CompensatorLimb<Scalar>, kCompensatorLimbs>& limbs,
                   const CompensatorPose<Scalar>& pose, CompensatorJoints<Scalar>& joints) noexcept {
  joints_of(limbs, level_arms<N>(limbs, pose), joints);
  return all_finite(joints, N);
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

/// cos and sin by their series, to 3e-17 for angles within 0.1 rad.
template <typename Scalar>
ArmDirection<Scalar> turn_by_series(Scalar angle) noexcept {
  const Scalar one(1), u = angle * angle;
  return {one - u / Scalar(2) * (one - u / Scalar(12) * (one - u / Scalar(30) * (one - u / Scalar(56)))),
          angle * (one - u / Scalar(6) * (one - u / Scalar(20) * (one - u / Scalar(42) * (one - u / Scalar(72)))))};
}

inline constexpr double kSeriesReach = 0.1;  ///< rad

/// cos and sin of an angle that is nearly always small.
template <typename Scalar>
ArmDirection<Scalar> turn_by(Scalar angle) noexcept {
  if (std::abs(angle) <= Scalar(kSeriesReach)) return turn_by_series(angle);
  return {std::cos(angle), std::sin(angle)};
}

/// R of the plate.
template <typename Scalar>
struct PlateFrame : PlateColumns<Scalar> {
  Vector<Scalar> turned(const Vector<Scalar>& v) const noexcept { return combination(v, this->x, this->y, this->z); }
};

template <typename Scalar>
PlateFrame<Scalar> plate_frame(const Vector<Scalar>& tilt) noexcept {
  return {plate_columns(turn_by(tilt[0]), turn_by(tilt[1]), turn_by(tilt[2]))};
}

/// Arms and plate during the search for the tilt; position and slide of the plate stay on the pose.
template <typename Scalar, std::size_t N>
struct TiltedPose {
  Arms<Scalar, N> arms;           ///< of unit length
  std::array<Scalar, N> moved{};  ///< changes of the joints since the level plate, rad or mm
  Vector<Scalar> tilt{};          ///< rad
};

template <typename Scalar, std::size_t N>
TiltedPose<Scalar, N> level_pose(const std::array<CompensatorLimb<Scalar>, kCompensatorLimbs>& limbs,
                                 const Arms<Scalar, N>& arms) noexcept {
  using std::sqrt;
  TiltedPose<Scalar, N> state;
  for (std::size_t i = 0; i < N; ++i) {
    const auto [c, s] = arms[i];
    const Scalar scale = runs_on_rail(limbs[i]) ? Scalar(1) : Scalar(1) / sqrt(c * c + s * s);
    state.arms[i] = {c * scale, s * scale};
  }
  return state;
}

/// Load of the rods on the plate if each is a spring of tension f = |rod| - l. The least-squares closure is reached
/// when force, moment and the force along the slide are zero (J^T f = 0, J = df / d(plate)).
template <typename Scalar>
struct Pull {
  Vector<Scalar> force{}, moment{};
  Scalar slide{};
};

template <typename Scalar, std::size_t N>
Pull<Scalar> pull_of_rods(const std::array<CompensatorLimb<Scalar>, kCompensatorLimbs>& limbs,
                          const CompensatorPose<Scalar>& pose, const TiltedPose<Scalar, N>& state) noexcept {
  using std::sqrt;
  const PlateFrame<Scalar> frame = plate_frame(state.tilt);
  Pull<Scalar> pull;
  for (std::size_t i = 0; i < N; ++i) {
    const CompensatorLimb<Scalar>& limb = limbs[i];
    const ClosedElbow<Scalar> elbow = elbow_of(limb, state.arms[i]);
    const Vector<Scalar> elbow_half = combination(limb.elbow_half, elbow.u1, elbow.v1, limb.axis);
    const Vector<Scalar> centre = frame.turned(plate_joint(limb, pose.phi));
    const Vector<Scalar> plate_half = frame.turned(limb.plate_half);
    const Vector<Scalar> mean_rod = sum(sum({pose.x, pose.y, pose.z}, centre), elbow.centre, Scalar(-1));
    const Vector<Scalar> half_rod = sum(plate_half, elbow_half, Scalar(-1));
    Vector<Scalar> both{};
    for (std::size_t j = 0; j < 2; ++j) {
      const Scalar side = j == 0 ? Scalar(1) : Scalar(-1);
      const Vector<Scalar> rod = sum(mean_rod, half_rod, side);
      const Scalar length = sqrt(dot(rod, rod));
      const Vector<Scalar> tension = scaled(rod, (length - limb.rod[j]) / length);
      both = sum(both, tension);
      pull.moment = sum(pull.moment, cross(sum(centre, plate_half, side), tension));
    }
    pull.force = sum(pull.force, both);
    pull.slide = pull.slide + dot(frame.turned(limb.slide), both);
  }
  return pull;
}

/// Change of a limb's mean rod by motions of the plate: n by its position, n . slide by phi (mm per rad). The dual has
/// the same form: the motion of the plate if only this limb's rod changes by 1 mm.
template <typename Scalar>
struct RodMotion {
  Vector<Scalar> position{};
  Scalar phi{};
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
    const Scalar phi = -dot(a, bc);
    const Scalar scale = Scalar(1) / (dot(position, m[i].position) + phi * m[i].phi);
    dual[i] = {scaled(position, scale), phi * scale};
  }
  return dual;
}

/// Response of arms and plate to a pull, with parallel rods in each limb: J^T (f + J_q dq + J_tilt dtilt) = 0 then
/// splits into the limbs and three equations for the tilt. Computed once, for the level plate. Errors of the tilt group
/// change it by their own size, so each step leaves about a thousandth of the error.
template <typename Scalar, std::size_t N>
struct Answer {
  std::array<RodMotion<Scalar>, N> dual;
  std::array<Vector<Scalar>, N> moment;   ///< plate joint x n
  std::array<Scalar, N> by_joint;         ///< change of the rods by the joint, mm per rad or mm
  std::array<Vector<Scalar>, 3> by_tilt;  ///< inverse of 2 sum h h^T, h = plate half x n
};

template <typename Scalar, std::size_t N>
Answer<Scalar, N> answer_at(const std::array<CompensatorLimb<Scalar>, kCompensatorLimbs>& limbs,
                            const CompensatorPose<Scalar>& pose, const Arms<Scalar, N>& arms) noexcept {
  using std::sqrt;
  Answer<Scalar, N> answer;
  std::array<RodMotion<Scalar>, N> motions;
  std::array<Vector<Scalar>, 3> tilt{};
  for (std::size_t i = 0; i < N; ++i) {
    const CompensatorLimb<Scalar>& limb = limbs[i];
    const ClosedElbow<Scalar> elbow = elbow_of(limb, arms[i]);
    const Vector<Scalar> centre = plate_joint(limb, pose.phi);
    const Vector<Scalar> rod = sum(sum({pose.x, pose.y, pose.z}, centre), elbow.centre, Scalar(-1));
    const Vector<Scalar> n = scaled(rod, Scalar(1) / sqrt(dot(rod, rod)));
    motions[i] = {n, dot(n, limb.slide)};
    answer.moment[i] = cross(centre, n);
    answer.by_joint[i] = -dot(n, elbow.v1) * (runs_on_rail(limb) ? Scalar(1) / limb.joint_per_mm : limb.arm);
    const Vector<Scalar> h = cross(limb.plate_half, n);
    for (std::size_t k = 0; k < 3; ++k) tilt[k] = sum(tilt[k], h, Scalar(2) * h[k]);
  }
  answer.dual = dual_motions(motions);
  answer.by_tilt = inverse_of_symmetric(tilt);
  return answer;
}

/// Moves an arm or a carriage by a change of its joint.
template <typename Scalar>
ArmDirection<Scalar> moved_by(const CompensatorLimb<Scalar>& limb, const ArmDirection<Scalar>& arm,
                              Scalar change) noexcept {
  if (runs_on_rail(limb)) return {arm.cosine, arm.sine + change / limb.joint_per_mm};
  const auto [c, s] = turn_by(change);
  return {arm.cosine * c - arm.sine * s, arm.sine * c + arm.cosine * s};
}

/// One step towards equilibrium.
/// @returns rotations of each arm (of the rods for a carriage) and of the plate, rad.
template <typename Scalar, std::size_t N>
std::array<Scalar, N + 3> step(const std::array<CompensatorLimb<Scalar>, kCompensatorLimbs>& limbs,
                               const CompensatorPose<Scalar>& pose, const Answer<Scalar, N>& answer,
                               TiltedPose<Scalar, N>& state) noexcept {
  const Pull<Scalar> pull = pull_of_rods(limbs, pose, state);
  std::array<Scalar, N> both;  // change of the sum of a limb's rods
  Vector<Scalar> moment = pull.moment;
  for (std::size_t i = 0; i < N; ++i) {
    both[i] = -(dot(answer.dual[i].position, pull.force) + answer.dual[i].phi * pull.slide);
    moment = sum(moment, answer.moment[i], both[i]);
  }
  const Vector<Scalar> tilt =
      scaled(combination(moment, answer.by_tilt[0], answer.by_tilt[1], answer.by_tilt[2]), Scalar(-1));
  state.tilt = sum(state.tilt, tilt);
  std::array<Scalar, N + 3> changes;
  for (std::size_t i = 0; i < N; ++i) {
    const Scalar change = (Scalar(0.5) * both[i] - dot(answer.moment[i], tilt)) / answer.by_joint[i];
    state.arms[i] = moved_by(limbs[i], state.arms[i], change);
    state.moved[i] = state.moved[i] + change;
    changes[i] = runs_on_rail(limbs[i]) ? change / limbs[i].rod[0] : change;
  }
  for (std::size_t k = 0; k < 3; ++k) changes[N + k] = tilt[k];
  return changes;
}

/// Largest remaining error, rad: each further step would be smaller by the ratio of the last two.
template <typename Scalar>
inline constexpr Scalar kSettled = Scalar(100) * std::numeric_limits<Scalar>::epsilon();

inline constexpr int kMostSteps = 20;  ///< usually three or four

/// From the joints of the level plate to those of the tilted one. inverse (kinematics/inverse.hpp) finds the same by
/// Newton's method.
template <std::size_t N, typename Scalar>
CompensationStatus settle(const CompensatorParameters<Scalar>& parameters, const CompensatorPose<Scalar>& pose,
                          const Arms<Scalar, N>& level, CompensatorJoints<Scalar>& joints,
                          Vector<Scalar>& tilt) noexcept {
  TiltedPose<Scalar, N> state = level_pose(parameters.identified, level);
  const Answer<Scalar, N> answer = answer_at(parameters.identified, pose, state.arms);
  Scalar before(1);
  for (int count = 0; count < kMostSteps; ++count) {
    const std::array<Scalar, N + 3> changes = step(parameters.identified, pose, answer, state);
    if (!all_finite(changes)) break;
    Scalar largest{};
    for (const Scalar change : changes) largest = std::abs(change) > largest ? std::abs(change) : largest;
    if (largest <= before && largest * largest <= kSettled<Scalar> * before) {
      for (std::size_t i = 0; i < N; ++i) joints[i] += state.moved[i];
      tilt = state.tilt;
      return all_finite(joints, N) && all_finite(tilt) ? CompensationStatus::ok : CompensationStatus::singular;
    }
    before = largest;
  }
  return CompensationStatus::singular;
}

template <std::size_t N, typename Scalar>
CompensationStatus exact(const CompensatorParameters<Scalar>& parameters, const CompensatorPose<Scalar>& pose,
                         CompensatorJoints<Scalar>& joints, Vector<Scalar>& tilt) noexcept {
  const Arms<Scalar, N> arms = level_arms<N>(parameters.identified, pose);
  joints_of(parameters.identified, arms, joints);
  if (!all_finite(joints, N)) return CompensationStatus::unreachable;
  return parameters.tilts_plate != 0 ? settle(parameters, pose, arms, joints, tilt) : CompensationStatus::ok;
}

/// Rows of the linear error model of one limb at a pose, nominal [huang2016, Eq. (4)].
template <typename Scalar>
struct LinearLimb {
  std::array<Scalar, 8> B_d;  ///< of dp_d (CompensatorParameters::position_errors)
  std::array<Scalar, 6> B_e;  ///< of dp_e (CompensatorParameters::tilt_errors)
  Vector<Scalar> A_de, A_ee;  ///< mm and 1
  Scalar by_joint;            ///< B_m, mm per rad or mm
  Vector<Scalar> rod;         ///< l, unit vector
};

template <typename Scalar>
Vector<Scalar> unit(const Vector<Scalar>& v) noexcept {
  return scaled(v, Scalar(1) / std::sqrt(dot(v, v)));
}

/// @param first  its arm (on a rail its rod) scales angles to lengths.
template <typename Scalar>
LinearLimb<Scalar> linear_limb(const CompensatorLimb<Scalar>& limb, const CompensatorLimb<Scalar>& first,
                               const CompensatorPose<Scalar>& pose, Scalar joint) noexcept {
  const bool on_rail = runs_on_rail(limb);
  const Scalar place = place_of(limb, joint);
  const Scalar c = on_rail ? Scalar(1) : std::cos(place), s = on_rail ? place : std::sin(place);
  const auto [u1, v1, elbow] = elbow_of(limb, {c, s});
  const Vector<Scalar> a = plate_joint(limb, pose.phi), lever = sum(elbow, limb.base, Scalar(-1));
  const Vector<Scalar> l = unit(sum(sum({pose.x, pose.y, pose.z}, a), elbow, Scalar(-1)));
  const Scalar lu = dot(l, u1), lv = dot(l, v1), lw = dot(l, limb.axis);
  // How far the elbow goes along the rod when the frame turns about an axis: first the radial one, on which the plate
  // joint stands, then the arm's normal or the actuator's axis.
  const auto turned = [&](const Vector<Scalar>& axis) {
    return dot(l, cross(axis, lever)) / (on_rail ? first.rod[0] : first.arm);
  };
  const Vector<Scalar> radial = unit(limb.plate);
  // The short side at the plate turns about the radial direction, then about the normal of its own frame.
  const Vector<Scalar> w3 = unit(limb.plate_half), u3 = cross(unit(cross(w3, radial)), w3);
  return {{on_rail ? lv : lv * (limb.arm / first.arm), l[0], l[1], l[2], on_rail ? lv * joint / Scalar(1000) : lu,
           turned(radial), turned(on_rail ? limb.axis : limb.normal), Scalar(1)},
          {Scalar(1), lw, dot(l, cross(radial, w3)), dot(l, u3), -lv, lu},
          cross(a, l),
          cross(limb.axis, l),
          on_rail ? lv / limb.joint_per_mm : limb.arm * lv,
          l};
}

template <typename Scalar, std::size_t Size>
Scalar inner(const std::array<Scalar, Size>& a, const std::array<Scalar, Size>& b) noexcept {
  Scalar value{};
  for (std::size_t k = 0; k < Size; ++k) value += a[k] * b[k];
  return value;
}

/// A_ee^+ per limb: epsilon = sum of its columns, each times B_e dp_e of its limb, rad [huang2016, Eq. (6)].
template <std::size_t N, typename Scalar>
std::array<Vector<Scalar>, N> tilt_by_limb(const std::array<LinearLimb<Scalar>, N>& limbs) noexcept {
  std::array<Vector<Scalar>, 3> normal{};  // A_ee^T A_ee
  for (const LinearLimb<Scalar>& limb : limbs) {
    for (std::size_t r = 0; r < 3; ++r) normal[r] = sum(normal[r], limb.A_ee, limb.A_ee[r]);
  }
  const std::array<Vector<Scalar>, 3> inverse = inverse_of_symmetric(normal);
  std::array<Vector<Scalar>, N> columns;
  for (std::size_t i = 0; i < N; ++i) columns[i] = combination(limbs[i].A_ee, inverse[0], inverse[1], inverse[2]);
  return columns;
}

/// q = q_nominal - B_m^-1 (B_d dp_d - A_de epsilon)    [huang2016, Eq. (8)]; without epsilon Eqs. (22), (23).
template <std::size_t N, typename Scalar>
CompensationStatus linear(const CompensatorParameters<Scalar>& parameters, const CompensatorPose<Scalar>& pose,
                          bool tilt_aware, CompensatorJoints<Scalar>& joints, Vector<Scalar>& tilt) noexcept {
  if (!level_inverse<N>(parameters.nominal, pose, joints)) return CompensationStatus::unreachable;
  std::array<LinearLimb<Scalar>, N> limbs;
  for (std::size_t i = 0; i < N; ++i)
    limbs[i] = linear_limb(parameters.nominal[i], parameters.nominal[0], pose, joints[i]);
  if (parameters.tilts_plate != 0) {
    const std::array<Vector<Scalar>, N> columns = tilt_by_limb<N>(limbs);
    for (std::size_t i = 0; i < N; ++i) tilt = sum(tilt, columns[i], inner(limbs[i].B_e, parameters.tilt_errors[i]));
  }
  for (std::size_t i = 0; i < N; ++i) {
    const Scalar coupling = tilt_aware ? dot(limbs[i].A_de, tilt) : Scalar(0);
    joints[i] -= (inner(limbs[i].B_d, parameters.position_errors[i]) - coupling) / limbs[i].by_joint;
  }
  return all_finite(joints, N) && all_finite(tilt) ? CompensationStatus::ok : CompensationStatus::singular;
}

template <std::size_t N, typename Scalar>
CompensationStatus compensate(const CompensatorParameters<Scalar>& parameters, CompensationWay way,
                              const CompensatorPose<Scalar>& pose, CompensatorJoints<Scalar>& joints,
                              Vector<Scalar>& tilt) noexcept {
  if (way == CompensationWay::exact) return exact<N>(parameters, pose, joints, tilt);
  return linear<N>(parameters, pose, way == CompensationWay::tilt_aware, joints, tilt);
}

/// Whether a pose can be commanded at all.
template <typename Scalar>
CompensationStatus asked(const CompensatorParameters<Scalar>& parameters,
                         const CompensatorPose<Scalar>& pose) noexcept {
  if (!all_finite(std::array{pose.x, pose.y, pose.z, pose.phi})) return CompensationStatus::not_finite;
  const bool turns = parameters.limb_count == 4 || pose.phi == Scalar(0);
  return turns ? CompensationStatus::ok : CompensationStatus::unreachable;
}

}  // namespace compensation_detail

/// Joint coordinates that bring the identified machine to a pose.
///
/// `joints` and `tilt` are written if the status is ok, else unchanged. A controller that passes the same `joints` in
/// every cycle therefore keeps the last valid ones. It must set them before the first call, to the present joints of
/// the machine. Values written with status ok are always finite.
///
/// @param pose    mm, rad, in {O}.
/// @param joints  rad (mm on rails), as the controller should command them.
/// @param tilt    if given: the remaining tilt, rad; of first order for the linear methods.
/// Real-time: yes.
template <typename Scalar>
[[nodiscard]] CompensationStatus compensate(const CompensatorParameters<Scalar>& parameters, CompensationWay way,
                                            const CompensatorPose<Scalar>& pose, CompensatorJoints<Scalar>& joints,
                                            CompensatorTilt<Scalar>* tilt = nullptr) noexcept {
  CompensationStatus status = compensation_detail::asked(parameters, pose);
  if (status != CompensationStatus::ok) return status;
  CompensatorJoints<Scalar> answer{};
  CompensatorVector<Scalar> remaining{};
  status = parameters.limb_count == 4 ? compensation_detail::compensate<4>(parameters, way, pose, answer, remaining)
                                      : compensation_detail::compensate<3>(parameters, way, pose, answer, remaining);
  if (status != CompensationStatus::ok) return status;
  joints = answer;
  if (tilt != nullptr) *tilt = {remaining[0], remaining[1]};
  return status;
}

/// Parameters and method of one machine, for controllers that keep both at run time (else: parameter_buffer.hpp).
template <typename Scalar>
class Compensator {
 public:
  explicit Compensator(const CompensatorParameters<Scalar>& parameters,
                       CompensationWay way = CompensationWay::exact) noexcept
      : parameters_(parameters), way_(way) {}

  /// As paracal::compensate.
  [[nodiscard]] CompensationStatus compensate(const CompensatorPose<Scalar>& pose, CompensatorJoints<Scalar>& joints,
                                              CompensatorTilt<Scalar>* tilt = nullptr) const noexcept {
    return paracal::compensate(parameters_, way_, pose, joints, tilt);
  }

  const CompensatorParameters<Scalar>& parameters() const noexcept { return parameters_; }
  CompensationWay way() const noexcept { return way_; }

 private:
  CompensatorParameters<Scalar> parameters_;
  CompensationWay way_;
};

}  // namespace paracal
