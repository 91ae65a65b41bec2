#pragma once

// Private to calibration.

#include "observation.hpp"

namespace paracal::detail {

/// Covariance of an unweighted fit to the distances of pairs of measured points. The distances share points, so the
/// usual sigma^2 (H^T H)^-1 is wrong [docs/paper-slips.md, 2.4]; with D = d rho / d points and one variance sigma^2 of
/// every coordinate
///
///   cov(p) = sigma^2 H^+ D D^T H^+T,   sigma^2 = e^T e / tr((I - H H^+) D D^T),
///
/// by sums over the stations' 3 columns of H^T D: neither H nor D is stored.
/// @param pseudo_inverse  (H^T H)^+. @param sum  e^T e.
Eigen::MatrixXd covariance_of_pairs(const Measurements& measurements, const Observation& observation,
                                    const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& pseudo_inverse, double sum);

}  // namespace paracal::detail
