#include "paracal/calibration/least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace paracal {
namespace {

/// y = p0 exp(p1 x) at x = 0 ... 4, generated with p = (2, -0.5).
bool exponential(const Eigen::VectorXd& p, Linearization& out) {
  out.residual.resize(5);
  out.jacobian.resize(5, 2);
  for (int k = 0; k < 5; ++k) {
    const double decay = std::exp(p(1) * k);
    out.residual(k) = p(0) * decay - 2.0 * std::exp(-0.5 * k);
    out.jacobian.row(k) << decay, p(0) * k * decay;
  }
  return out.residual.allFinite();
}

TEST(LeastSquares, FindsParametersFromFarAway) {
  const LeastSquaresResult fit = solve_least_squares(exponential, Eigen::Vector2d(10.0, 1.0));
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  EXPECT_NEAR(fit.parameters(0), 2.0, 1e-6);
  EXPECT_NEAR(fit.parameters(1), -0.5, 1e-6);
  EXPECT_EQ(fit.rank, 2);
  EXPECT_EQ(fit.null_space.cols(), 0);
}

TEST(LeastSquares, CovarianceIsTheInverseNormalMatrix) {
  const LeastSquaresResult fit = solve_least_squares(exponential, Eigen::Vector2d(1.5, -0.3));
  const Eigen::MatrixXd expected = (fit.at_answer.jacobian.transpose() * fit.at_answer.jacobian).inverse();
  EXPECT_LT((fit.covariance - expected).norm(), 1e-10 * expected.norm());
}

/// Only p0 + p1 acts on the residuals, and p2 does not act at all.
bool degenerate(const Eigen::VectorXd& p, Linearization& out) {
  out.residual = Eigen::Vector3d(p(0) + p(1) - 1.0, 2.0 * (p(0) + p(1)) - 2.0, 0.0);
  out.jacobian = Eigen::MatrixXd::Zero(3, 3);
  out.jacobian.leftCols(2) << 1, 1, 2, 2, 0, 0;
  return true;
}

TEST(LeastSquares, LeavesUnseenDirectionsWhereTheyStarted) {
  const LeastSquaresResult fit = solve_least_squares(degenerate, Eigen::Vector3d(0.2, 0.0, 7.0));
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  EXPECT_EQ(fit.rank, 1);
  ASSERT_EQ(fit.null_space.cols(), 2);
  EXPECT_LT((fit.at_answer.jacobian * fit.null_space).norm(), 1e-12);
  EXPECT_NEAR(fit.parameters(0), 0.6, 1e-12);
  EXPECT_NEAR(fit.parameters(1), 0.4, 1e-12);
  EXPECT_EQ(fit.parameters(2), 7.0);
}

TEST(LeastSquares, ShortensStepsThatLeaveTheModelsDomain) {
  const ResidualModel root = [](const Eigen::VectorXd& p, Linearization& out) {
    if (p(0) <= 0.0) return false;
    out.residual = Eigen::VectorXd::Constant(1, std::log(p(0)));
    out.jacobian = Eigen::MatrixXd::Constant(1, 1, 1.0 / p(0));
    return true;
  };
  const LeastSquaresResult fit = solve_least_squares(root, Eigen::VectorXd::Constant(1, 20.0));
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  EXPECT_NEAR(fit.parameters(0), 1.0, 1e-6);
}

TEST(LeastSquares, SaysSoWhenItRunsOutOfIterationsOrCannotStart) {
  LeastSquaresOptions hurried;
  hurried.max_iterations = 1;
  EXPECT_EQ(solve_least_squares(exponential, Eigen::Vector2d(10.0, 1.0), hurried).status,
            LeastSquaresStatus::not_converged);
  const ResidualModel never = [](const Eigen::VectorXd&, Linearization&) { return false; };
  const LeastSquaresResult fit = solve_least_squares(never, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(fit.status, LeastSquaresStatus::not_evaluable);
  EXPECT_EQ(fit.parameters, Eigen::Vector2d(3.0, 4.0));
}

}  // namespace
}  // namespace paracal
