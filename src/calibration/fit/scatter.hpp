#pragma once

// Private to calibration.

#include "observation.hpp"

namespace paracal::detail {

/// How much readings scatter about a fit, and how much they should: `sum` of weighted squared residuals, and the
/// `redundancy` that it is expected to equal when the sigmas are right,
///
///   n - tr(J C J^T) = n - |R_u R^-1|^2
///
/// of n rows, with C the covariance of all unknowns, priors included, R its root and R_u the root of the checked rows
/// alone. Priors do not count as readings: parameters smaller than their tolerances must not make the readings look
/// better.
struct Scatter {
  double sum = 0.0;
  double redundancy = 0.0;
};

/// @param root    of the fit, with priors; must have full rank.
/// @param chosen  (group, its rows) -> first row and count of those that count.
template <typename Choice>
Scatter scatter_of_rows(const Observation& observation, const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& root,
                        Choice&& chosen) {
  InformationRoot readings(observation.unknown_count());
  double worth = 0.0;
  observation.check_each(unknowns, [&](std::size_t g, const Eigen::MatrixXd& rows) {
    const Group& group = observation.groups()[g];
    if (!group.active) return;
    const auto [first, count] = chosen(group, rows.rows());
    if (count == 0) return;
    readings.add(rows.middleRows(first, count));
    worth += static_cast<double>(count);
  });
  const Eigen::MatrixXd hat = root.triangularView<Eigen::Upper>().transpose().solve(readings.root().transpose());
  return {readings.squared_residuals(), worth - hat.squaredNorm()};
}

/// The same of all rows of the chosen readings.
template <typename Choice>
Scatter scatter(const Observation& observation, const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& root,
                Choice&& chosen) {
  return scatter_of_rows(observation, unknowns, root, [&](const Group& group, Eigen::Index rows) {
    return std::pair(Eigen::Index{0}, chosen(group) ? rows : Eigen::Index{0});
  });
}

/// The same of all active readings, without looking at one again: with P the information of the priors and C the
/// covariance of the unknowns, tr(J C J^T) = n - tr(C P).
///
/// @param at_answer  rows of the readings and of the priors, as they are now.
Scatter scatter_at_answer(const Observation& observation, const Eigen::VectorXd& unknowns,
                          const InformationRoot& at_answer);

/// How repeated visits of a station scatter about their mean, by rows as weighted for the fit: pure error.
Scatter scatter_of_visits(const Observation& observation, const Eigen::VectorXd& unknowns);

}  // namespace paracal::detail
