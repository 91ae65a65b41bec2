#include "paracal/numerics/least_squares.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace paracal::least_squares_test {
namespace {

constexpr double kRankTolerance = 1e-7;

/// Rows [J | r] of y = p0 exp(p1 x) at x = 0 ... 4, generated with p = (2, -0.5).
Eigen::MatrixXd exponential_rows(const Eigen::VectorXd& p) {
  Eigen::MatrixXd rows(5, 3);
  for (int k = 0; k < 5; ++k) {
    const double decay = std::exp(p(1) * k);
    rows.row(k) << decay, p(0) * k * decay, p(0) * decay - 2.0 * std::exp(-0.5 * k);
  }
  return rows;
}

bool exponential(const Eigen::VectorXd& p, InformationRoot& rows) {
  const Eigen::MatrixXd block = exponential_rows(p);
  rows.add(block);
  return block.allFinite();
}

TEST(LeastSquares, FindsParametersFromFarAway) {
  const LeastSquaresResult fit = solve_least_squares(exponential, Eigen::Vector2d(10.0, 1.0));
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  EXPECT_NEAR(fit.parameters(0), 2.0, 1e-6);
  EXPECT_NEAR(fit.parameters(1), -0.5, 1e-6);
  const Spectrum spectrum = analyse(fit.at_answer.root(), kRankTolerance);
  EXPECT_EQ(spectrum.rank, 2);
  EXPECT_EQ(spectrum.null_space.cols(), 0);
}

TEST(LeastSquares, TheRootAtTheAnswerIsThatOfTheModelThere) {
  const LeastSquaresResult fit = solve_least_squares(exponential, Eigen::Vector2d(1.5, -0.3));
  const Eigen::MatrixXd rows = exponential_rows(fit.parameters);
  const Eigen::MatrixXd jacobian = rows.leftCols<2>();
  const Eigen::MatrixXd expected = (jacobian.transpose() * jacobian).inverse();
  const Spectrum spectrum = analyse(fit.at_answer.root(), kRankTolerance);
  EXPECT_LT((spectrum.covariance - expected).norm(), 1e-10 * expected.norm());
  EXPECT_EQ(fit.at_answer.row_count(), 5);
  EXPECT_DOUBLE_EQ(fit.at_answer.squared_residuals(), rows.col(2).squaredNorm());
}

/// Only p0 + 3 p1 acts on the residuals, and p2 does not act at all.
bool degenerate(const Eigen::VectorXd& p, InformationRoot& rows) {
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(3, 4);
  block.row(0) << 1.0, 3.0, 0.0, p(0) + 3.0 * p(1) - 2.0;
  block.row(1) = 2.0 * block.row(0);
  rows.add(block);
  return true;
}

class LeastSquaresDamping : public testing::TestWithParam<double> {};

TEST_P(LeastSquaresDamping, LeavesUnseenDirectionsWhereTheyStarted) {
  const LeastSquaresResult fit =
      solve_least_squares(degenerate, Eigen::Vector3d(0.2, 0.0, 7.0), {.initial_damping = GetParam()});
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  const Spectrum spectrum = analyse(fit.at_answer.root(), kRankTolerance);
  EXPECT_EQ(spectrum.rank, 1);
  ASSERT_EQ(spectrum.null_space.cols(), 2);
  EXPECT_LT((fit.at_answer.root() * spectrum.null_space).norm(), 1e-12);
  // In units of the column lengths 1 : 3 both parameters share the way.
  EXPECT_NEAR(fit.parameters(0) + 3.0 * fit.parameters(1), 2.0, 1e-6);
  EXPECT_NEAR(fit.parameters(0) - 3.0 * fit.parameters(1), 0.2, 1e-12);
  EXPECT_EQ(fit.parameters(2), 7.0);
}

TEST_P(LeastSquaresDamping, DoesNotChangeTheAnswer) {
  const LeastSquaresResult fit =
      solve_least_squares(exponential, Eigen::Vector2d(1.0, 0.0), {.initial_damping = GetParam()});
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  EXPECT_NEAR(fit.parameters(0), 2.0, 1e-6);
  EXPECT_NEAR(fit.parameters(1), -0.5, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Initial, LeastSquaresDamping, testing::Values(0.0, 1e-30, 1e-6, 1.0, 1e3));

TEST(LeastSquares, SolvesALinearProblemInOneUndampedStep) {
  const LeastSquaresResult fit = solve_least_squares(degenerate, Eigen::Vector3d(100.0, -20.0, 0.0));
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  EXPECT_EQ(fit.iterations, 1);
}

TEST(LeastSquares, ShortensStepsThatLeaveTheModelsDomain) {
  const RowModel root = [](const Eigen::VectorXd& p, InformationRoot& rows) {
    if (p(0) <= 0.0) return false;
    rows.add(Eigen::RowVector2d(1.0 / p(0), std::log(p(0))));
    return true;
  };
  const LeastSquaresResult fit = solve_least_squares(root, Eigen::VectorXd::Constant(1, 20.0));
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  EXPECT_NEAR(fit.parameters(0), 1.0, 1e-6);
}

/// (p + 1, c p^2 + p - 1), whose answer is 0, where Gauss and Newton's step leads from p to c p: for c near -1 to and
/// fro across the answer, hardly nearer or farther.
TEST(LeastSquares, ShortensStepsThatGoToAndFro) {
  for (const double c : {-0.99, -1.0, -1.5}) {
    const RowModel model = [c](const Eigen::VectorXd& p, InformationRoot& rows) {
      Eigen::Matrix2d block;
      block << 1.0, p(0) + 1.0, 2.0 * c * p(0) + 1.0, c * p(0) * p(0) + p(0) - 1.0;
      rows.add(block);
      return true;
    };
    const LeastSquaresResult fit =
        solve_least_squares(model, Eigen::VectorXd::Constant(1, 0.1), {.step_tolerance = 1e-5});
    EXPECT_EQ(fit.status, LeastSquaresStatus::converged) << c;
    EXPECT_NEAR(fit.parameters(0), 0.0, 1e-4) << c;
    EXPECT_LT(fit.iterations, 20) << c;
  }
}

/// The same for c near 1, where steps lead slowly to the answer: what they bring drowns in rounding long before they
/// are as short as was asked for.
TEST(LeastSquares, SettlesWhereRoundingHidesWhatStepsBring) {
  const RowModel model = [](const Eigen::VectorXd& p, InformationRoot& rows) {
    constexpr double c = 0.95;
    Eigen::Matrix2d block;
    block << 1.0, p(0) + 1.0, 2.0 * c * p(0) + 1.0, c * p(0) * p(0) + p(0) - 1.0;
    rows.add(block);
    return true;
  };
  const LeastSquaresResult fit =
      solve_least_squares(model, Eigen::VectorXd::Constant(1, 0.1), {.max_iterations = 1000, .step_tolerance = 1e-12});
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  EXPECT_NEAR(fit.parameters(0), 0.0, 3e-3);
  EXPECT_LT(fit.iterations, 300);  // 20 after the last that showed
}

TEST(LeastSquares, SaysSoWhenItRunsOutOfIterationsOrCannotStart) {
  LeastSquaresOptions hurried;
  hurried.max_iterations = 1;
  EXPECT_EQ(solve_least_squares(exponential, Eigen::Vector2d(10.0, 1.0), hurried).status,
            LeastSquaresStatus::not_converged);
  const RowModel never = [](const Eigen::VectorXd&, InformationRoot&) { return false; };
  const LeastSquaresResult fit = solve_least_squares(never, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(fit.status, LeastSquaresStatus::not_evaluable);
  EXPECT_EQ(fit.parameters, Eigen::Vector2d(3.0, 4.0));
}

}  // namespace
}  // namespace paracal::least_squares_test
