#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "paracal/mechanism/robot.hpp"

namespace paracal {

enum class ErrorModelStatus : std::uint8_t {
  ok,
  unreachable,  ///< the nominal robot does not reach the pose, or is none of the paper's kind: on struts all of a
                ///< plate's errors are compensable, and nothing falls apart into two groups. No matrix is set.
  singular,     ///< A_dd or A_ee^T A_ee has a reciprocal condition below kSmallestCondition; no G is set
};

/// Linear error model of a nominal robot at a pose [huang2016, Eqs. (3)-(7)], for N limbs:
///
///   \f[ A_dd delta + A_de epsilon = B_d dp_d,    A_ee epsilon = B_e dp_e    (4)
///       delta = G_dd dp_d + G_de dp_e  (5),      epsilon = G_ee dp_e        (6) \f]
///
///   delta    (dr, ds) in {O}, mm: 4, or 3 for a rigid plate, which has no slide
///   epsilon  small rotation of the plate about x, y, z of {O}, rad
///   dp_d     8 a limb, mm:  L theta_offset, e_x, e_y, e_z, arm_length, L alpha0, L beta0, rod_mean
///            (on a rail theta_offset is a length itself, and the rod's length l stands for L)
///   dp_e     6 a limb, rad: rod_difference / c, width_difference / c, alpha03, beta03, alpha2, beta2
///
/// B_d and B_e are block diagonal; here they are stored a row a limb.
struct [[nodiscard]] ErrorModel {
  template <int Columns>
  using PerFreedom = Eigen::Matrix<double, Eigen::Dynamic, Columns, Eigen::ColMajor, kMaxLimbs, Columns>;
  template <int PerLimb>
  using PerFreedomAndSource =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxLimbs, PerLimb * kMaxLimbs>;
  template <int PerLimb>
  using PerTiltAndSource = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, PerLimb * kMaxLimbs>;
  static constexpr int kPosition = 8, kTilt = 6;  ///< source errors of each group
  static constexpr double kSmallestCondition = 1e-9;

  ErrorModelStatus status = ErrorModelStatus::unreachable;
  Joints joints;                                  ///< nominal, rad or mm
  PerFreedomAndSource<1> A_dd;                    ///< N x N
  PerFreedom<3> A_de, A_ee;                       ///< N x 3, mm and 1
  PerFreedom<kPosition> B_d;                      ///< N x 8, one row a limb
  PerFreedom<kTilt> B_e;                          ///< N x 6, one row a limb
  PerFreedomAndSource<kPosition + 2> G_dd;        ///< N x 8N; those of a limb's harmonics follow its 8
  PerFreedomAndSource<kTilt> G_de;                ///< N x 6N, mm per rad
  PerTiltAndSource<kTilt> G_ee;                   ///< 3 x 6N
  double condition_dd = 0.0, condition_ee = 0.0;  ///< reciprocal conditions of A_dd and A_ee^T A_ee

  bool ok() const { return status == ErrorModelStatus::ok; }
};

/// @param pose  mm, rad. Real-time: yes (no allocation, no exception).
ErrorModel error_model(const Robot& robot, const Pose& pose) noexcept;

/// Factor from a source error in mm or rad to its column of dp_d or dp_e: L (l for the angles of a rail), 1 or 1/c.
double paper_scale(const Robot& robot, Source source);

}  // namespace paracal
