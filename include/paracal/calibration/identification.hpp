#pragma once

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// Rough calibration: the encoder offsets of all limbs from point-to-point distances [huang2016, Eqs. (16), (17),
/// (21)], and from relative rotations where they were read.
///
///   rho_k = |r_to - r_from|,   d rho_k = n_k^T (dr_to/dp - dr_from/dp) dp,   p = (theta_offset of each limb)
///
/// The paper linearises at the nominal machine and repeats measurement and fit until the offsets settle. Here r is the
/// exact pose of the machine with the offsets found so far (forward), its derivative is exact_jacobian, and
/// Gauss-Newton with Levenberg-Marquardt safeguard repeats until nothing moves: one set of readings is enough. Standard
/// deviations come from (H^T W H)^-1, scaled by the scatter of the residuals: always where readings state no sigma,
/// upwards only where all do.
///
/// Accepted when the fit converged, all offsets are determined, and an F test (chi-square where all sigmas are stated)
/// finds the improvement unlikely to be chance.
///
/// @throws InvalidArgument for readings that make no sense (see check()) and Unreachable for a station
/// out of the robot's reach.
Calibration calibrate(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options = {});

}  // namespace paracal
