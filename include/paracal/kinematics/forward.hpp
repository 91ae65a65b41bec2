#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "paracal/kinematics/closure.hpp"
#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/pose.hpp"

namespace paracal {

enum class ForwardStatus : std::uint8_t {
  converged,      ///< the pose is the solution
  strained,       ///< converged, but a rod-length residual is above max_residual: no exact solution
  singular,       ///< the plate can move with fixed joints; the plate state is that of the last iteration
  not_converged,  ///< max_iterations reached, or NaN; the plate state is that of the last iteration
  /// The plate state closes all rods, but outside of the workspace and in another assembly mode: moving from the middle
  /// of the workspace the plate does not get there.
  other_mode,
};

struct ForwardOptions {
  /// First guess, whose assembly mode is meant. Default: on the side of the workspace, as far from the upper ends of
  /// the rods as their lengths say; where this leads out of the workspace, in straight motions of all joints from its
  /// middle.
  std::optional<PlateState> start = {};
  int max_iterations = 50;
  double step_tolerance = 1e-9;  ///< mm (rotations count with half the parallelogram's width): stop below this step
  double max_residual = 1.0;     ///< mm: above it a converged solution is `strained`
  /// The same of limbs more than degrees of freedom: their joints disagree by all that is wrong with the machine.
  double max_disagreement = 20.0;
};

/// Exact pose of a machine, with residuals.
struct [[nodiscard]] ForwardResult {
  ForwardStatus status = ForwardStatus::not_converged;
  PlateState plate;
  double residual = 0.0;  ///< largest rod-length residual, mm, which elastic parts must absorb
  double gradient = 0.0;  ///< norm of J^T f at the solution, mm; zero except for rounding
  int iterations = 0;

  bool ok() const { return status == ForwardStatus::converged; }
  /// The plate state is the minimiser, even if the rods are strained.
  bool usable() const { return ok() || status == ForwardStatus::strained; }
};

/// Why joints have no pose, of a result that is not ok(): "the rods do not meet (largest rod residual 3 mm after 9
/// iterations)".
std::string why_no_pose(const Machine& machine, const ForwardResult& result);

/// Exact pose of a machine from its joint coordinates.
///
///   \f[ plate = arg min sum_ij (|rod_ij(plate, joints)| - l_ij)^2 \f]
///
/// over position, slide and tilt. 8 rods hold 7 unknowns (6 hold 6 for a rigid plate): equal elastic rods share the one
/// over-constraint, which to first order is the pseudo-inverse of [huang2016, Eqs. (5), (6)]. Gauss-Newton with
/// analytic Jacobian, steps halved while they do not descend; of more rods than unknowns Newton near the answer.
///
/// @param joints  commanded joints, rad or mm, one per limb.
/// Real-time: yes (no allocation, no exception, bounded loop).
ForwardResult forward(const Machine& machine, const Joints& joints, const ForwardOptions& options = {}) noexcept;

}  // namespace paracal
