#pragma once

// Private to calibration.

#include "observation.hpp"

namespace paracal::detail {

/// How much readings scatter about a fit, and how much they should: `sum` of weighted squared residuals, and the
/// `redundancy` that it is expected to equal when the sigmas are right,
///
///   rows - tr(J C J^T) = rows - |R_u R^-1|^2,
///
/// with C the covariance of all unknowns, priors included, R its root and R_u the root of the readings alone. Priors do
/// not count as readings: parameters smaller than their tolerances must not make the readings look better.
struct Scatter {
  double sum = 0.0;
  double redundancy = 0.0;
};

/// @param root  of the fit, with priors; must have full rank.
template <typename Choice>
Scatter scatter(const Observation& observation, const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& root,
                Choice&& chosen) {
  InformationRoot readings(observation.unknown_count());
  observation.add_rows(unknowns, readings, chosen);
  const Eigen::MatrixXd hat = root.triangularView<Eigen::Upper>().transpose().solve(readings.root().transpose());
  return {readings.squared_residuals(), static_cast<double>(readings.row_count()) - hat.squaredNorm()};
}

}  // namespace paracal::detail
