#pragma once

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// Identifies the source errors of a machine from any mix of distances, points, second reflectors and rotations.
///
/// Rough stage: the encoder offsets alone, without priors  [huang2016, Eqs. (16), (17), (21)]. Fine stage, from there:
///
/// - Method::paper: the position group from the distances of all pairs of points, unweighted, by the pseudo-inverse of
///   the Jacobian at the nominal machine  [huang2016, Eq. (19)], repeated with the exact residuals until it settles.
/// - Method::best: maximum a posteriori, over the errors p and the setup n,
///
///   \f[ min_{p,n} sum_k |W_k (predicted_k(p, n) - measured_k)|^2 + sum_j (p_j / sigma_j)^2 \f]
///
/// There p has all 14 errors a limb with their tolerances as priors sigma_j, n frames and other setup without priors,
/// and W_k^T W_k is the inverse covariance of reading k. The priors of the tilt group are the covariance G_de Sigma
/// G_de^T of what [huang2016, Eq. (14)] neglects; those of the position group decide only where the readings are
/// silent. Where no sigma is stated, the residuals' scatter replaces it. Outliers are excluded
/// one at a time, and named. Standard deviations are those of the posterior.
///
/// Accepted when the fit converged, the parameters are determined, and an F test (chi-square where all sigmas are
/// stated) finds the improvement significant.
///
/// @throws InvalidArgument for readings that make no sense (see check()) or nothing to estimate, and Unreachable for a
/// station out of the robot's reach.
Calibration calibrate(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options = {});

}  // namespace paracal
