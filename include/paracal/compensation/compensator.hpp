#pragma once

// The compensator that runs in a controller: from a commanded pose to the joint coordinates that bring the identified
// machine there. This header and those of mechanism/ that it includes (machine_closure.hpp, limb_closure.hpp, drives/,
// linear_limb.hpp and drive_curve.hpp) need only the standard library and may be copied alone. Everything in them is
// real-time safe: noexcept, no allocation, no lock, no exception, no unbounded loop, no state between calls.
//
// Its parameters are computed once, outside the control thread, by compensator_parameters (parameters.hpp).

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "paracal/mechanism/drive_curve.hpp"
#include "paracal/mechanism/linear_limb.hpp"
#include "paracal/mechanism/machine_closure.hpp"

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "compensator.hpp detects unreachable poses by non-finite numbers: compile without -ffinite-math-only"
#endif

namespace paracal {

inline constexpr std::size_t kCompensatorLimbs = 8;
inline constexpr std::size_t kLevelLimbs = 4;  ///< of machines whose plate three or four parallelograms keep level

/// The commanded pose. What the machine cannot command is 0, or where guides hold it.
template <typename Scalar>
using CompensatorPose = ClosurePose<Scalar>;

/// All parameters of a compensator: plain numbers of fixed size, without padding, to be copied as bytes.
template <typename Scalar>
struct CompensatorParameters {
  ClosureLimbs<Scalar, kCompensatorLimbs> identified{}, nominal{};
  /// For the linear methods, of machines that stay level: dp_d of each limb, mm: L theta_offset, e_x, e_y, e_z,
  /// arm_length, L alpha0, L beta0, rod_mean. On a rail: theta_offset (a length), rod length instead of L, and gain,
  /// mm/m, instead of arm_length.
  std::array<std::array<Scalar, 8>, kLevelLimbs> position_errors{};
  /// dp_e of each limb, rad: rod_difference / c, width_difference / c, alpha03, beta03, alpha2, beta2.
  std::array<std::array<Scalar, 6>, kLevelLimbs> tilt_errors{};
  /// Of each limb, nominal: the axis about which alpha0 and alpha3 turn (radial_of()), in {O}.
  std::array<ClosureVector<Scalar>, kLevelLimbs> radial{};
  std::array<DriveCurve<Scalar>, kCompensatorLimbs> drives{};
  std::array<Scalar, 2> held_z{};  ///< twice where guides hold z, mm
  std::uint32_t limb_count = 0;
  std::uint32_t tilts_plate = 0;  ///< 1: errors of limbs with two rods turn the plate
  std::uint32_t is_level = 0;     ///< 1: three or four parallelograms keep the plate level
  std::uint32_t commanded = 0;    ///< bit k: coordinate k of x, y, z, tilt_x, tilt_y, tilt_z, phi can be commanded
};

/// The same robot without errors: the fallback of a controller.
template <typename Scalar>
CompensatorParameters<Scalar> without_errors(const CompensatorParameters<Scalar>& parameters) noexcept {
  CompensatorParameters<Scalar> nominal = parameters;
  nominal.identified = parameters.nominal;
  nominal.position_errors = {};
  nominal.tilt_errors = {};
  nominal.drives = {};
  nominal.tilts_plate = 0;
  return nominal;
}

/// Joint coordinates to command, rad (mm on rails and struts), one per limb; entries beyond the number of limbs are not
/// used.
template <typename Scalar>
using CompensatorJoints = std::array<Scalar, kCompensatorLimbs>;

/// Tilt of the plate that no joint command can remove, rad.
template <typename Scalar>
struct CompensatorTilt {
  Scalar eps_x{}, eps_y{}, eps_z{};
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

using namespace closure;  // NOLINT(google-build-using-namespace): what both namespaces are made of

/// Closed form with a level plate.
/// @returns whether every limb reaches; joints are then finite.
template <std::size_t N, typename Scalar>
bool level_inverse(const ClosureLimbs<Scalar, kCompensatorLimbs>& limbs, const CompensatorPose<Scalar>& pose,
                   CompensatorJoints<Scalar>& joints) noexcept {
  joints_of(limbs, closed_arms<N>(limbs, pose, LevelPlate{}), joints);
  return all_finite(joints, N);
}

/// The fourth coordinate of a machine whose limbs have two rods.
template <typename Scalar>
std::size_t fourth_of(const CompensatorParameters<Scalar>& parameters) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    if ((parameters.commanded >> (3 + k)) % 2 == 1) return k;
  }
  return kSlide;
}

template <std::size_t N, typename Scalar>
CompensationStatus exact(const CompensatorParameters<Scalar>& parameters, const CompensatorPose<Scalar>& pose,
                         CompensatorJoints<Scalar>& joints, Vector<Scalar>& tilt) noexcept {
  const auto& limbs = parameters.identified;
  const Arms<Scalar, N> arms = parameters.is_level != 0 ? closed_arms<N>(limbs, pose, LevelPlate{})
                                                        : closed_arms<N>(limbs, pose, commanded_plate(pose));
  joints_of(limbs, arms, joints);
  if (!all_finite(joints, N)) return CompensationStatus::unreachable;
  if (parameters.tilts_plate == 0) return CompensationStatus::ok;
  if constexpr (N == 3 || N == 4) {
    const int steps = settle(limbs, pose, fourth_of(parameters), arms, joints, tilt);
    if (steps > 0 && all_finite(joints, N) && all_finite(tilt)) return CompensationStatus::ok;
  }
  return CompensationStatus::singular;
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
    limbs[i] = linear_limb(parameters.nominal[i], parameters.nominal[0], parameters.radial[i], pose, joints[i]);
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
  if constexpr (N == 3 || N == 4) {
    if (way != CompensationWay::exact) {
      return linear<N>(parameters, pose, way == CompensationWay::tilt_aware, joints, tilt);
    }
  }
  return exact<N>(parameters, pose, joints, tilt);
}

/// Whether a pose can be commanded at all, and in this way.
template <typename Scalar>
CompensationStatus asked(const CompensatorParameters<Scalar>& parameters, CompensationWay way,
                         const CompensatorPose<Scalar>& pose) noexcept {
  constexpr auto kSlack = static_cast<Scalar>(1e-6);  // mm, rad: of poses that went through a file
  const std::array coordinates{pose.x, pose.y, pose.z, pose.tilt_x, pose.tilt_y, pose.tilt_z, pose.phi};
  if (!all_finite(coordinates)) return CompensationStatus::not_finite;
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    const Scalar held = k == 2 ? parameters.held_z[0] : Scalar(0);
    const bool is_commanded = (parameters.commanded >> k) % 2 == 1;
    if (!is_commanded && !(std::abs(coordinates[k] - held) <= kSlack)) return CompensationStatus::unreachable;
  }
  const bool knows_way = way == CompensationWay::exact || parameters.is_level != 0;
  return knows_way ? CompensationStatus::ok : CompensationStatus::unreachable;
}

/// For the number of limbs, which the compiler then knows.
template <std::size_t N = kCompensatorLimbs, typename Scalar>
CompensationStatus compensate_limbs(const CompensatorParameters<Scalar>& parameters, CompensationWay way,
                                    const CompensatorPose<Scalar>& pose, CompensatorJoints<Scalar>& joints,
                                    Vector<Scalar>& tilt) noexcept {
  if (parameters.limb_count == N) return compensate<N>(parameters, way, pose, joints, tilt);
  if constexpr (N > 1) return compensate_limbs<N - 1>(parameters, way, pose, joints, tilt);
  return CompensationStatus::unreachable;
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
  CompensationStatus status = compensation_detail::asked(parameters, way, pose);
  if (status != CompensationStatus::ok) return status;
  CompensatorJoints<Scalar> answer{};
  ClosureVector<Scalar> remaining{};
  status = compensation_detail::compensate_limbs(parameters, way, pose, answer, remaining);
  if (status != CompensationStatus::ok) return status;
  for (std::size_t i = 0; i < parameters.limb_count; ++i) answer[i] = parameters.drives[i].commanded(answer[i]);
  joints = answer;
  if (tilt != nullptr) *tilt = {remaining[0], remaining[1], remaining[2]};
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
