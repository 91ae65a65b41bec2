#pragma once

// Private to calibration: readings that contradict the others.

#include <Eigen/Core>
#include <vector>

#include "observation.hpp"
#include "scatter.hpp"

namespace paracal::detail {

/// A reading (by its place among the groups) and how much it contradicts the others; see Suspect.
struct Contradiction {
  std::size_t group = 0;
  double statistic = 0.0;  ///< F
  double freedom = 0.0;    ///< of the rest, by which it is judged
  int rows = 0;

  /// That the worst of `count` good readings has at least this F. Costs more than all else that is known of a reading.
  double chance(std::size_t count) const;
};

/// Every reading with the drop of the weighted squares if it were left out (for a reading left out already: the rise if
/// it were taken in) over the scatter of the others, exact for a linear model:
///
///   T = v^T S^-1 v,   S = I - J C J^T  (I + J C J^T when left out),   F = (T / rows) / (sum' / redundancy')
///
/// where sum' and redundancy' are those of the other readings without this one, priors not counted (see Scatter): what
/// leaving it out takes from the priors is no drop of the others' squares. Where these tell no noise, F is 0 of a
/// reading that was left out: nothing contradicts it.
///
/// with v its residuals and J its rows at the answer. F is Fisher distributed whatever the true scale of the noise: the
/// externally studentised residual of several rows  [baarda1968].
/// @param covariance  of all unknowns. @returns worst first.
std::vector<Contradiction> contradictions(const Observation& observation, const Eigen::VectorXd& unknowns,
                                          const Eigen::MatrixXd& covariance, const Scatter& scatter);

/// Studentised size of every reading's residual, |v| / sqrt(tr(I - w J C J^T)), over the median of all active ones:
/// about 1 for a good reading, whatever its leverage and the scale of the noise. Readings left out have 0.
std::vector<double> studentised(const Observation& observation, const Eigen::VectorXd& unknowns,
                                const Eigen::MatrixXd& covariance);

/// Studentised size over the median that one reading in 1 / `chance` exceeds, of as many rows and good:
///
///   sqrt(Q(1 - chance) / Q(1/2)),   Q: quantile of chi-square with `rows` degrees of freedom
double size_by_chance(double rows, double chance);

/// Some reading stands out among `sizes`, as studentised() gives them: beyond 3.5 where readings are few; where they
/// are many beyond what the largest of as many good ones exceeds in one set of a hundred. (By 3.5, with which two
/// distances in a hundred differ, every large set stands out.)
bool one_stands_out(const Observation& observation, const std::vector<double>& sizes);

/// Leaves out points that lie far from where the machine can be: more than 8 times the median distance after a robust
/// alignment. They would spoil even the first linearization.
void leave_out_gross_points(Observation& observation, const Eigen::VectorXd& start);

}  // namespace paracal::detail
