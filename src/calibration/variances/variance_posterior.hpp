#pragma once

// Private to calibration: what readings tell of a machine, whatever the variances are.

#include <Eigen/Core>
#include <vector>

#include "variance_table.hpp"

namespace paracal::detail {

/// A table that may hold, and its mode.
struct WeighedTable {
  VarianceTable table;
  VarianceTable::Mode mode;
  double probability = 1.0;
};

/// Averages over variances.
struct VariancePosterior {
  Eigen::VectorXd errors;  ///< means, of parts, then of the splines of drives
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd noise = {};  ///< the part of the noise in that of parts
  /// Variances u of the first table and their weights.
  struct Point {
    Eigen::VectorXd u;
    double weight = 0.0;
  };
  std::vector<Point> points = {};

  /// Root of the mean of exp(2 u) of one term.
  double size(std::size_t term) const;
  /// Of several, the largest; 0 of none.
  double largest(const std::vector<std::size_t>& terms) const;
  /// Of each series.
  NoiseOfSeries noise_of_series(const VarianceTable& table) const;
  /// Probability that the standard deviation of all these terms together is above.
  double probability_above(const std::vector<std::size_t>& terms, double std) const;
};

/// Integrates over each table's variances: samples about its mode, weighed by the density  [rue2009].
VariancePosterior averaged(const std::vector<WeighedTable>& tables);

/// Of more readings than a table holds, at the mode of a table of some of them.
VariancePosterior of_all(const StageFit& fit, const ReadingPlaces& places, const DriveSplines& drives,
                         const WeighedTable& some);

}  // namespace paracal::detail
