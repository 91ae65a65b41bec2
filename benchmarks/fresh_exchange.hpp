#pragma once

#include <Eigen/Core>
#include <vector>

#include "paracal/calibration/pose_selection.hpp"

namespace paracal::benchmark {

/// Criterion::pose_uncertainty of a set of poses, computed from the start, where select_stations() updates it.
///
///   tr(B C) = |L^-1 M|^2,   C^-1 = L L^T = I + sum_k A_k^T A_k,   B = M M^T,
///
/// with A_k the whitened rows of a point over (frame | source errors), each in units of its prior.
class FreshCriterion {
 public:
  FreshCriterion(const Robot& robot, const std::vector<Station>& candidates);

  /// C^-1 of these candidates, its lower triangle.
  Eigen::MatrixXd information(const std::vector<std::size_t>& poses) const;
  /// The criterion with one more candidate beside those of `others`.
  double with(const Eigen::MatrixXd& others, std::size_t candidate) const;
  /// The criterion of C^-1, whose lower triangle is read.
  double of(const Eigen::MatrixXd& information) const;

 private:
  auto rows(std::size_t candidate) const { return rows_.middleCols<3>(3 * static_cast<Eigen::Index>(candidate)); }

  Eigen::MatrixXd rows_;  ///< A_k^T side by side
  Eigen::MatrixXd goal_;  ///< M
};

}  // namespace paracal::benchmark
