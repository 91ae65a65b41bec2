#pragma once

// The compensator that runs in a controller: from a commanded pose to the joint coordinates that bring the identified
// machine there. This header needs the standard library alone and may be copied by itself. Everything in it is
// real-time safe: noexcept, no allocation, no lock, no exception, no unbounded loop, no state between calls.
//
// Its parameters are made once, outside of the control thread, by compensator_parameters (parameters.hpp).

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "compensator.hpp tells unreachable poses by numbers that are not finite: compile without -ffinite-math-only"
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
  CompensatorVector<Scalar> slide{};                     ///< mu_i r_g shat, in {O'}: motion of A_i a rad of phi
  CompensatorVector<Scalar> elbow_half{};                ///< (c_c / 2) R_2 e_3, along u_1, v_1, w_0
  CompensatorVector<Scalar> plate_half{};                ///< (c_a / 2) R_3 e_3, in {O'}
  std::array<Scalar, 2> rod{};                           ///< l_1, l_2
  Scalar arm{};                                          ///< L_i
  Scalar joint_offset{};                                 ///< added to the believed joint coordinate, rad
};

/// All that a compensator knows: plain numbers of fixed size, without padding, to be copied as bytes.
template <typename Scalar>
struct CompensatorParameters {
  std::array<CompensatorLimb<Scalar>, kCompensatorLimbs> identified{}, nominal{};
  /// dp_d of each limb, mm: L theta_offset, e_x, e_y, e_z, arm_length, L alpha0, L beta0, rod_mean.
  std::array<std::array<Scalar, 8>, kCompensatorLimbs> position_errors{};
  /// dp_e of each limb, rad: rod_difference / c, width_difference / c, alpha03, beta03, alpha2, beta2.
  std::array<std::array<Scalar, 6>, kCompensatorLimbs> tilt_errors{};
  std::uint32_t limb_count = 0;   ///< 4 with a slide, 3 with a rigid plate
  std::uint32_t tilts_plate = 0;  ///< 1: some error of the tilt group is not zero
};

/// The same robot without errors: what a controller falls back to.
template <typename Scalar>
CompensatorParameters<Scalar> without_errors(const CompensatorParameters<Scalar>& parameters) noexcept {
  CompensatorParameters<Scalar> nominal;
  nominal.identified = nominal.nominal = parameters.nominal;
  nominal.limb_count = parameters.limb_count;
  return nominal;
}

/// What the controller is asked for: O' in {O}, mm; phi of the end-effector, rad (0 for a rigid plate).
template <typename Scalar>
struct CompensatorPose {
  Scalar x{}, y{}, z{};
  Scalar phi{};
};

/// Joint coordinates to command, rad, one a limb; entries beyond the number of limbs are not used.
template <typename Scalar>
using CompensatorJoints = std::array<Scalar, kCompensatorLimbs>;

/// Tilt of the plate that no joint command removes, rad.
template <typename Scalar>
struct CompensatorTilt {
  Scalar eps_x{}, eps_y{};
};

enum class CompensationWay : std::uint8_t {
  linear,      ///< nominal inverse + dq_m of the position group [huang2016, Eqs. (22), (23)]
  tilt_aware,  ///< and of what the tilt group moves the plate by [huang2016, Eq. (8)]
  exact,       ///< inverse of the identified machine with all errors
};

enum class CompensationStatus : std::uint8_t {
  ok,
  unreachable,  ///< an arm and its rods do not meet there, or a rigid plate is asked to turn
  not_finite,   ///< the commanded pose holds NaN or infinity
  singular,     ///< the machine does not hold the plate there: the correction has no answer
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

/// Direction of an arm: (cos(th), sin(th)) times any positive factor; NaN when out of reach.
template <typename Scalar>
struct ArmDirection {
  Scalar cosine, sine;
};

/// Triangle of arm and mean rod in closed form, elbow outward; the same lines as close_triangle (mechanism/limb.hpp).
///
///   |d - L u_1(th)| = l   <=>   A cos(th) + B sin(th) = K,    d = joint at the plate - b_i
template <typename Scalar>
ArmDirection<Scalar> close_triangle(const CompensatorLimb<Scalar>& limb, const Vector<Scalar>& d) noexcept {
  const Scalar diameter = Scalar(2) * limb.arm;
  const Scalar a = diameter * dot(d, limb.radial);
  const Scalar b = diameter * dot(d, limb.normal);
  const Scalar rod = Scalar(0.5) * (limb.rod[0] + limb.rod[1]);
  const Scalar k = dot(d, d) + limb.arm * limb.arm - rod * rod;
  const Scalar w = std::copysign(std::sqrt(a * a + b * b - k * k), -b);
  return {a * k - b * w, b * k + a * w};
}

/// Closed form for all limbs, plate level.
/// @returns whether every limb reaches; joints are then finite.
template <std::size_t N, typename Scalar>
bool level_inverse(const std::array<CompensatorLimb<Scalar>, kCompensatorLimbs>& limbs,
                   const CompensatorPose<Scalar>& pose, CompensatorJoints<Scalar>& joints) noexcept {
  const Vector<Scalar> position{pose.x, pose.y, pose.z};
  // All triangles before the first arctangent: the short chains of arithmetic then overlap, limb with limb.
  std::array<ArmDirection<Scalar>, N> direction;
  for (std::size_t i = 0; i < N; ++i) {
    const Vector<Scalar> joint_at_plate = sum(position, plate_joint(limbs[i], pose.phi));
    direction[i] = close_triangle(limbs[i], sum(joint_at_plate, limbs[i].base, Scalar(-1)));
  }
  for (std::size_t i = 0; i < N; ++i) {
    joints[i] = std::atan2(direction[i].sine, direction[i].cosine) - limbs[i].joint_offset;
  }
  return all_finite(joints, N);
}

/// Solves rows [A | b] by elimination with the largest pivot of each column.
/// @returns the solution; not finite where A is singular.
template <typename Scalar, std::size_t Size>
std::array<Scalar, Size> solve(std::array<std::array<Scalar, Size + 1>, Size>& rows) noexcept {
  for (std::size_t k = 0; k < Size; ++k) {
    std::size_t pivot = k;
    for (std::size_t r = k + 1; r < Size; ++r) {
      if (std::abs(rows[r][k]) > std::abs(rows[pivot][k])) pivot = r;
    }
    if (pivot != k) rows[k].swap(rows[pivot]);
    for (std::size_t r = k + 1; r < Size; ++r) {
      const Scalar factor = rows[r][k] / rows[k][k];
      for (std::size_t c = k + 1; c <= Size; ++c) rows[r][c] -= factor * rows[k][c];
    }
  }
  std::array<Scalar, Size> solution{};
  for (std::size_t k = Size; k-- > 0;) {
    Scalar rest = rows[k][Size];
    for (std::size_t c = k + 1; c < Size; ++c) rest -= rows[k][c] * solution[c];
    solution[k] = rest / rows[k][k];
  }
  return solution;
}

/// R = Rot(x, tilt_x) Rot(y, tilt_y) Rot(z, tilt_z) and the axes about which the three angles turn, in {O}.
template <typename Scalar>
struct PlateFrame {
  Vector<Scalar> x, y, z;  ///< columns of R
  std::array<Vector<Scalar>, 3> axes;

  Vector<Scalar> turned(const Vector<Scalar>& v) const noexcept { return combination(v, x, y, z); }
};

template <typename Scalar>
PlateFrame<Scalar> plate_frame(const Vector<Scalar>& tilt) noexcept {
  const Scalar ca = std::cos(tilt[0]), sa = std::sin(tilt[0]);
  const Scalar cb = std::cos(tilt[1]), sb = std::sin(tilt[1]);
  const Scalar cg = std::cos(tilt[2]), sg = std::sin(tilt[2]);
  const Vector<Scalar> z{sb, -sa * cb, ca * cb};
  return {{cb * cg, ca * sg + sa * sb * cg, sa * sg - ca * sb * cg},
          {-cb * sg, ca * cg - sa * sb * sg, sa * cg + ca * sb * sg},
          z,
          {Vector<Scalar>{Scalar(1), Scalar(0), Scalar(0)}, Vector<Scalar>{Scalar(0), ca, sa}, z}};
}

/// An elbow as its rods see it, mm, in {O}, from the base joint: its centre L u_1, and from there to the hinge of
/// rod 1.
template <typename Scalar>
struct ElbowPosition {
  Vector<Scalar> centre, half;
};

template <typename Scalar>
ElbowPosition<Scalar> elbow_at(const CompensatorLimb<Scalar>& limb, Scalar joint) noexcept {
  const Scalar c = std::cos(joint + limb.joint_offset), s = std::sin(joint + limb.joint_offset);
  const Vector<Scalar> u1 = combination({c, s, Scalar(0)}, limb.radial, limb.normal, limb.axis);
  const Vector<Scalar> v1 = combination({-s, c, Scalar(0)}, limb.radial, limb.normal, limb.axis);
  return {sum({}, u1, limb.arm), combination(limb.elbow_half, u1, v1, limb.axis)};
}

/// Newton's equations for the joints and the tilt of N limbs, position and slide held on the pose:
///
///   J^T (f + J_q dq + J_tilt dtilt) = 0        N + 3 equations in N + 3 unknowns
///
/// f_j = |rod_j| - l_j, J = df / d(position, slide, tilt); the last column of a row is the right-hand side.
template <typename Scalar, std::size_t N>
struct NewtonSystem {
  std::array<std::array<Scalar, N + 4>, N + 3> rows{};

  /// @param gradient  row of J;  @param by_joint  derivative by the joint of that limb.
  void add_rod(std::size_t limb, const std::array<Scalar, N + 3>& gradient, Scalar by_joint, Scalar residual) noexcept {
    for (std::size_t r = 0; r < N + 3; ++r) {
      rows[r][limb] += gradient[r] * by_joint;
      for (std::size_t k = N; k < N + 3; ++k) rows[r][k] += gradient[r] * gradient[k];
      rows[r][N + 3] -= gradient[r] * residual;
    }
  }
};

/// Adds both rods of a limb.
template <typename Scalar, std::size_t N>
void add_limb(NewtonSystem<Scalar, N>& system, std::size_t number, const CompensatorLimb<Scalar>& limb,
              const CompensatorPose<Scalar>& pose, const PlateFrame<Scalar>& frame, Scalar joint) noexcept {
  const ElbowPosition<Scalar> elbow = elbow_at(limb, joint);
  const Vector<Scalar> centre = plate_joint(limb, pose.phi);
  const Vector<Scalar> position_from_base = sum({pose.x, pose.y, pose.z}, limb.base, Scalar(-1));
  const Vector<Scalar> slide = frame.turned(limb.slide);
  for (std::size_t j = 0; j < 2; ++j) {
    const Scalar side = j == 0 ? Scalar(1) : Scalar(-1);
    const Vector<Scalar> hinge = sum(elbow.centre, elbow.half, side);
    const Vector<Scalar> lever = frame.turned(sum(centre, limb.plate_half, side));
    const Vector<Scalar> rod = sum(sum(position_from_base, lever), hinge, Scalar(-1));
    const Scalar length = std::sqrt(dot(rod, rod));
    const Vector<Scalar> n = sum({}, rod, Scalar(1) / length);
    const Vector<Scalar> moment = cross(lever, n);
    std::array<Scalar, N + 3> gradient{n[0], n[1], n[2]};
    if constexpr (N == 4) gradient[3] = dot(n, slide);
    for (std::size_t k = 0; k < 3; ++k) gradient[N + k] = dot(frame.axes[k], moment);
    system.add_rod(number, gradient, -dot(n, cross(limb.axis, hinge)), length - limb.rod[j]);
  }
}

/// From the joints of the level plate to those of the tilted one: the same iteration as inverse
/// (kinematics/inverse.hpp). It gains three to five digits a step; 20 steps are the most.
template <std::size_t N, typename Scalar>
CompensationStatus settle(const CompensatorParameters<Scalar>& parameters, const CompensatorPose<Scalar>& pose,
                          CompensatorJoints<Scalar>& joints, Vector<Scalar>& tilt) noexcept {
  constexpr int kMaxIterations = 20;
  // rad, of the last step in the joints: a step more would be smaller by three digits or more; in float it would be
  // rounding.
  constexpr Scalar kRounding = Scalar(100) * std::numeric_limits<Scalar>::epsilon();
  constexpr Scalar kTolerance = kRounding > Scalar(1e-10) ? kRounding : Scalar(1e-10);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const PlateFrame<Scalar> frame = plate_frame(tilt);
    NewtonSystem<Scalar, N> system;
    for (std::size_t i = 0; i < N; ++i) add_limb(system, i, parameters.identified[i], pose, frame, joints[i]);
    const std::array<Scalar, N + 3> step = solve(system.rows);
    if (!all_finite(step)) return CompensationStatus::singular;
    Scalar largest{};
    for (std::size_t i = 0; i < N; ++i) {
      joints[i] += step[i];
      largest = std::abs(step[i]) > largest ? std::abs(step[i]) : largest;
    }
    for (std::size_t k = 0; k < 3; ++k) tilt[k] += step[N + k];
    if (largest < kTolerance) return all_finite(joints, N) ? CompensationStatus::ok : CompensationStatus::singular;
  }
  return CompensationStatus::singular;
}

template <std::size_t N, typename Scalar>
CompensationStatus exact(const CompensatorParameters<Scalar>& parameters, const CompensatorPose<Scalar>& pose,
                         CompensatorJoints<Scalar>& joints, Vector<Scalar>& tilt) noexcept {
  if (!level_inverse<N>(parameters.identified, pose, joints)) return CompensationStatus::unreachable;
  return parameters.tilts_plate != 0 ? settle<N>(parameters, pose, joints, tilt) : CompensationStatus::ok;
}

/// Rows of the linear error model of one limb at a pose, nominal [huang2016, Eq. (4)].
template <typename Scalar>
struct LinearLimb {
  Scalar position_error;      ///< B_d dp_d, mm
  Scalar tilt_error;          ///< B_e dp_e, rad
  Vector<Scalar> A_de, A_ee;  ///< mm and 1
  Scalar by_joint;            ///< B_m, mm a rad
};

template <typename Scalar>
LinearLimb<Scalar> linear_limb(const CompensatorParameters<Scalar>& parameters, std::size_t i,
                               const CompensatorPose<Scalar>& pose, Scalar joint) noexcept {
  const CompensatorLimb<Scalar>& limb = parameters.nominal[i];
  const std::array<Scalar, 8>& p = parameters.position_errors[i];
  const std::array<Scalar, 6>& e = parameters.tilt_errors[i];
  const Scalar c = std::cos(joint), s = std::sin(joint);
  const Vector<Scalar> u1 = combination({c, s, Scalar(0)}, limb.radial, limb.normal, limb.axis);
  const Vector<Scalar> v1 = combination({-s, c, Scalar(0)}, limb.radial, limb.normal, limb.axis);
  const Vector<Scalar> a = plate_joint(limb, pose.phi);
  const Vector<Scalar> elbow = sum(limb.base, u1, limb.arm);
  const Vector<Scalar> rod = sum(sum({pose.x, pose.y, pose.z}, a), elbow, Scalar(-1));
  const Vector<Scalar> l = sum({}, rod, Scalar(1) / std::sqrt(dot(rod, rod)));
  const Scalar lu = dot(l, u1), lv = dot(l, v1), lw = dot(l, limb.axis);
  return {p[0] * lv + dot({p[1], p[2], p[3]}, l) + p[4] * lu + (p[5] * s - p[6] * c) * lw + p[7],
          e[0] + e[1] * lw - e[2] * dot(l, limb.normal) + e[3] * dot(l, limb.radial) - e[4] * lv + e[5] * lu,
          cross(a, l), cross(limb.axis, l), limb.arm * lv};
}

/// epsilon = A_ee^+ B_e dp_e, rad [huang2016, Eq. (6)].
template <std::size_t N, typename Scalar>
Vector<Scalar> linear_tilt(const std::array<LinearLimb<Scalar>, N>& limbs) noexcept {
  std::array<std::array<Scalar, 4>, 3> normal{};  // [A_ee^T A_ee | A_ee^T B_e dp_e]
  for (const LinearLimb<Scalar>& limb : limbs) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) normal[r][c] += limb.A_ee[r] * limb.A_ee[c];
      normal[r][3] += limb.A_ee[r] * limb.tilt_error;
    }
  }
  return solve(normal);
}

/// q = q_nominal - B_m^-1 (B_d dp_d - A_de epsilon)    [huang2016, Eq. (8)]; without epsilon Eqs. (22), (23).
template <std::size_t N, typename Scalar>
CompensationStatus linear(const CompensatorParameters<Scalar>& parameters, const CompensatorPose<Scalar>& pose,
                          bool tilt_aware, CompensatorJoints<Scalar>& joints, Vector<Scalar>& tilt) noexcept {
  if (!level_inverse<N>(parameters.nominal, pose, joints)) return CompensationStatus::unreachable;
  std::array<LinearLimb<Scalar>, N> limbs;
  for (std::size_t i = 0; i < N; ++i) limbs[i] = linear_limb(parameters, i, pose, joints[i]);
  if (parameters.tilts_plate != 0) tilt = linear_tilt<N>(limbs);
  for (std::size_t i = 0; i < N; ++i) {
    const Scalar coupling = tilt_aware ? dot(limbs[i].A_de, tilt) : Scalar(0);
    joints[i] -= (limbs[i].position_error - coupling) / limbs[i].by_joint;
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

}  // namespace compensation_detail

/// Joint coordinates that bring the identified machine to a pose.
///
/// Last safe behaviour: `joints` and `tilt` are written when the status is ok, and left as they are otherwise. A
/// controller that passes the same `joints` in every cycle so keeps the last good ones; it must have set them before
/// the first call (to where the machine stands). What is written with status ok is finite, whatever came in.
///
/// @param pose    mm, rad, in {O}.
/// @param joints  rad, as the controller should command them.
/// @param tilt    on request: what tilt remains, rad; of first order for the linear ways.
/// Real-time: yes.
template <typename Scalar>
[[nodiscard]] CompensationStatus compensate(const CompensatorParameters<Scalar>& parameters, CompensationWay way,
                                            const CompensatorPose<Scalar>& pose, CompensatorJoints<Scalar>& joints,
                                            CompensatorTilt<Scalar>* tilt = nullptr) noexcept {
  using compensation_detail::all_finite;
  if (!all_finite(std::array{pose.x, pose.y, pose.z, pose.phi})) return CompensationStatus::not_finite;
  const bool has_slide = parameters.limb_count == 4;
  if (!has_slide && pose.phi != Scalar(0)) return CompensationStatus::unreachable;
  CompensatorJoints<Scalar> answer{};
  CompensatorVector<Scalar> remaining{};
  const CompensationStatus status = has_slide
                                        ? compensation_detail::compensate<4>(parameters, way, pose, answer, remaining)
                                        : compensation_detail::compensate<3>(parameters, way, pose, answer, remaining);
  if (status != CompensationStatus::ok) return status;
  joints = answer;
  if (tilt != nullptr) *tilt = {remaining[0], remaining[1]};
  return status;
}

/// Parameters and way of one machine, for controllers that change neither while they run (else: parameter_buffer.hpp).
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
