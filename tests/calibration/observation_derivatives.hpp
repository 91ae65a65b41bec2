#pragma once

#include <gtest/gtest.h>

#include <string>

#include "calibration/fit/observation.hpp"
#include "support/differences.hpp"

namespace paracal::test {

/// Rows [J | r] of all readings.
inline Eigen::MatrixXd rows_of(const detail::Observation& observation, const Eigen::VectorXd& unknowns) {
  Eigen::MatrixXd all(0, observation.unknown_count() + 1), block;
  for (const detail::Group& group : observation.groups()) {
    observation.rows(group, *observation.stations(unknowns), unknowns, block);
    all.conservativeResize(all.rows() + block.rows(), Eigen::NoChange);
    all.bottomRows(block.rows()) = block;
  }
  return all;
}

inline ::testing::AssertionResult derivatives_are_differences(const detail::Observation& observation,
                                                              const Eigen::VectorXd& unknowns) {
  const auto residuals = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    return rows_of(observation, at).rightCols<1>();
  };
  constexpr double kStep = 1e-5, kCurvature = 1e-3;  // the latter four limbs neglect (exact_jacobian.hpp)
  return jacobians_agree(rows_of(observation, unknowns).leftCols(observation.unknown_count()),
                         central_differences(residuals, unknowns, Eigen::VectorXd::Constant(unknowns.size(), kStep)),
                         kCurvature, [](Eigen::Index k) { return std::to_string(k); });
}

}  // namespace paracal::test
