#pragma once

// Uncertainty of a compensated pose: the covariance of the identified errors, propagated to the pose by the linear
// error model. Needs only the standard library, real-time safe, as compensator.hpp.

#include "paracal/compensation/compensator.hpp"

namespace paracal {

/// Errors of one limb: the 8 of CompensatorParameters::position_errors, then the 6 of tilt_errors.
inline constexpr std::size_t kCompensatorErrors = 14;

/// Covariance of all errors, limb after limb, in mm and rad as in CompensatorParameters; zero for errors that are
/// assumed to be known. Computed by compensator_covariance (parameters.hpp).
template <typename Scalar>
using CompensatorCovariance =
    std::array<std::array<Scalar, kLevelLimbs * kCompensatorErrors>, kLevelLimbs * kCompensatorErrors>;

/// U = 2 standard deviations of the machine's pose, in {O}: mm, and rad (0 for a rigid plate).
template <typename Scalar>
struct CompensatorUncertainty {
  Scalar x{}, y{}, z{}, phi{};
};

namespace compensation_detail {

/// Effect of each limb's two groups of errors, B_d dp_d and B_e dp_e, on the pose: dP = sum_i X_i (B_d dp_d - A_de
/// epsilon) [huang2016, Eqs. (5), (6)], X_i the dual of the limb's rod motion.
template <std::size_t N, typename Scalar>
std::array<RodMotion<Scalar>, 2 * N> pose_by_group(const CompensatorParameters<Scalar>& parameters,
                                                   const std::array<LinearLimb<Scalar>, N>& limbs) noexcept {
  std::array<RodMotion<Scalar>, N> motions;
  for (std::size_t i = 0; i < N; ++i) motions[i] = {limbs[i].rod, dot(limbs[i].rod, parameters.nominal[i].slide)};
  const std::array<RodMotion<Scalar>, N> dual = dual_motions(motions);
  const std::array<Vector<Scalar>, N> tilt = tilt_by_limb<N>(limbs);
  std::array<RodMotion<Scalar>, 2 * N> by_group{};
  for (std::size_t j = 0; j < N; ++j) {
    by_group[2 * j] = dual[j];
    RodMotion<Scalar>& through_tilt = by_group[2 * j + 1];
    for (std::size_t i = 0; i < N; ++i) {
      const Scalar rod = -dot(limbs[i].A_de, tilt[j]);
      through_tilt.position = sum(through_tilt.position, dual[i].position, rod);
      through_tilt.fourth += rod * dual[i].fourth;
    }
  }
  return by_group;
}

/// r^T C s of a block of the covariance.
template <typename Scalar, std::size_t Rows, std::size_t Columns>
Scalar quadratic(const CompensatorCovariance<Scalar>& covariance, std::size_t row, std::size_t column,
                 const std::array<Scalar, Rows>& r, const std::array<Scalar, Columns>& s) noexcept {
  Scalar value{};
  for (std::size_t a = 0; a < Rows; ++a) {
    Scalar part{};
    for (std::size_t b = 0; b < Columns; ++b) part += covariance[row + a][column + b] * s[b];
    value += r[a] * part;
  }
  return value;
}

template <std::size_t N, typename Scalar>
CompensationStatus stated_uncertainty(const CompensatorParameters<Scalar>& parameters,
                                      const CompensatorCovariance<Scalar>& covariance,
                                      const CompensatorPose<Scalar>& pose,
                                      CompensatorUncertainty<Scalar>& uncertainty) noexcept {
  CompensatorJoints<Scalar> joints{};
  if (!level_inverse<N>(parameters.nominal, pose, joints)) return CompensationStatus::unreachable;
  std::array<LinearLimb<Scalar>, N> limbs;
  for (std::size_t i = 0; i < N; ++i)
    limbs[i] = linear_limb(parameters.nominal[i], parameters.nominal[0], parameters.radial[i], pose, joints[i]);
  const std::array<RodMotion<Scalar>, 2 * N> by_group = pose_by_group<N>(parameters, limbs);

  std::array<Scalar, 4> variance{};
  const auto add = [&](std::size_t one, std::size_t other, Scalar product) {
    const RodMotion<Scalar>&a = by_group[one], &b = by_group[other];
    for (std::size_t k = 0; k < 3; ++k) variance[k] += a.position[k] * b.position[k] * product;
    variance[3] += a.fourth * b.fourth * product;
  };
  for (std::size_t i = 0; i < N; ++i) {
    const std::size_t row = i * kCompensatorErrors, tilt_row = row + 8;
    for (std::size_t j = 0; j < N; ++j) {
      const std::size_t column = j * kCompensatorErrors, tilt_column = column + 8;
      add(2 * i, 2 * j, quadratic(covariance, row, column, limbs[i].B_d, limbs[j].B_d));
      add(2 * i, 2 * j + 1, Scalar(2) * quadratic(covariance, row, tilt_column, limbs[i].B_d, limbs[j].B_e));
      add(2 * i + 1, 2 * j + 1, quadratic(covariance, tilt_row, tilt_column, limbs[i].B_e, limbs[j].B_e));
    }
  }
  for (Scalar& one : variance) one = std::sqrt(one < Scalar(0) ? Scalar(0) : one);  // rounding below zero; NaN stays
  if (!all_finite(variance)) return CompensationStatus::singular;
  constexpr Scalar kCoverage(2);
  uncertainty = {kCoverage * variance[0], kCoverage * variance[1], kCoverage * variance[2], kCoverage * variance[3]};
  return CompensationStatus::ok;
}

}  // namespace compensation_detail

/// U of a pose of a machine that stays level; others are unreachable for the linear model. It changes slowly with the
/// pose, and a call takes longer than the compensation itself: call it when needed, not in each cycle.
///
/// @param pose         mm, rad, in {O}.
/// @param uncertainty  written if the status is ok, else unchanged.
/// Real-time: yes.
template <typename Scalar>
[[nodiscard]] CompensationStatus stated_uncertainty(const CompensatorParameters<Scalar>& parameters,
                                                    const CompensatorCovariance<Scalar>& covariance,
                                                    const CompensatorPose<Scalar>& pose,
                                                    CompensatorUncertainty<Scalar>& uncertainty) noexcept {
  if (const CompensationStatus status = compensation_detail::asked(parameters, CompensationWay::linear, pose);
      status != CompensationStatus::ok) {
    return status;
  }
  return parameters.limb_count == 4
             ? compensation_detail::stated_uncertainty<4>(parameters, covariance, pose, uncertainty)
             : compensation_detail::stated_uncertainty<3>(parameters, covariance, pose, uncertainty);
}

}  // namespace paracal
