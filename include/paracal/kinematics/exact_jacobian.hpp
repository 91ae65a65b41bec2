#pragma once

#include <Eigen/Core>

#include "paracal/kinematics/closure.hpp"
#include "paracal/mechanism/differentiable_machine.hpp"

namespace paracal {

/// Derivatives of the plate state with respect to the geometric errors of all limbs, at a machine that already has
/// errors. Identification uses it because the linear model is valid only near zero error. At zero error it
/// contains the columns of G (error_model) divided by paper_scale, in the order of the errors.
struct [[nodiscard]] ExactJacobian {
  static constexpr int kStates = 7;
  static constexpr int kColumns = static_cast<int>(kMostSources) * kMaxLimbs;
  /// Rows: position (mm), slide (mm; absent without one), tilt_x, tilt_y, tilt_z (rad).
  /// Columns: as Robot::parameters(), per mm or per rad; Machine::parameter() finds one.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kStates, kColumns> plate;
  bool ok = false;  ///< false at a singular closure; `plate` is then empty
};

/// From stationarity of the least-squares closure, J^T f = 0, with J = df/dplate and J_p = df/dp:
///
///   \f[ dplate / dp = -(J^T J)^-1 J^T J_p \f]
///
/// Exact for 3 limbs and for 6. For 4 the one over-constraint leaves residuals f, whose curvature f d2f is neglected:
/// with tilt errors as large as the tolerances of huang2016 that is below 1e-3 of a row's largest entry
/// (measured: 6.5e-4).
///
/// @param plate   the answer of forward(machine, joints).
/// @param joints  commanded joint coordinates, rad or mm. Real-time: yes.
ExactJacobian exact_jacobian(const DifferentiableMachine& machine, const PlateState& plate,
                             const Joints& joints) noexcept;

}  // namespace paracal
