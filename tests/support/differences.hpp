#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <string>

namespace paracal::test {

/// Central differences of f at x with the given step per variable.
inline Eigen::MatrixXd central_differences(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& f,
                                           const Eigen::VectorXd& x, const Eigen::VectorXd& step) {
  Eigen::MatrixXd jacobian;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    Eigen::VectorXd above = x, below = x;
    above(k) += step(k);
    below(k) -= step(k);
    const Eigen::VectorXd column = (f(above) - f(below)) / (2.0 * step(k));
    if (jacobian.size() == 0) jacobian.resize(column.size(), x.size());
    jacobian.col(k) = column;
  }
  return jacobian;
}

/// Compares two Jacobians entry by entry, relative to the largest entry of each row (rows may differ in unit), and
/// names the worst one.
inline ::testing::AssertionResult jacobians_agree(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& reference,
                                                  double tolerance,
                                                  const std::function<std::string(Eigen::Index)>& column_name) {
  if (ours.rows() != reference.rows() || ours.cols() != reference.cols()) {
    return ::testing::AssertionFailure() << "sizes differ: " << ours.rows() << " x " << ours.cols() << " and "
                                         << reference.rows() << " x " << reference.cols();
  }
  double worst = 0.0;
  Eigen::Index worst_row = 0, worst_column = 0;
  for (Eigen::Index row = 0; row < ours.rows(); ++row) {
    constexpr double kNothing = 1e-5;  // of the largest: what does not move but for rounding
    const double scale = std::max(reference.row(row).cwiseAbs().maxCoeff(), kNothing * reference.cwiseAbs().maxCoeff());
    for (Eigen::Index column = 0; column < ours.cols(); ++column) {
      const double difference = std::abs(ours(row, column) - reference(row, column)) / scale;
      if (!(difference > worst)) continue;
      worst = difference;
      worst_row = row;
      worst_column = column;
    }
  }
  if (worst <= tolerance && ours.allFinite()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "row " << worst_row << ", column " << column_name(worst_column) << ": ours "
                                       << ours(worst_row, worst_column) << ", reference "
                                       << reference(worst_row, worst_column) << ", relative difference " << worst;
}

}  // namespace paracal::test
