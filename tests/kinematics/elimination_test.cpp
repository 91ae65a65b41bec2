#include "kinematics/elimination.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace paracal::detail::elimination_test {
namespace {

using Matrix = Eigen::Matrix<double, 6, 6>;
using Vector = Eigen::Matrix<double, 6, 1>;

/// Against Eigen; a matrix of random numbers swaps rows at nearly every pivot.
TEST(Elimination, SolvesAsEigenDoes) {
  std::mt19937_64 engine(3);
  std::normal_distribution<> normal;
  for (int k = 0; k < 1000; ++k) {
    Matrix A = Matrix::NullaryExpr([&] { return normal(engine); });
    if (k % 3 == 0) A(0, 0) = 0.0;  // wants another row
    const Vector b = Vector::NullaryExpr([&] { return normal(engine); });
    const Vector expected = A.fullPivLu().solve(b), found = Elimination<6>(A).solve(b);
    const double conditioned = 1.0 / A.fullPivLu().rcond();
    EXPECT_LT((found - expected).norm(), 1e-13 * conditioned * expected.norm());
  }
}

TEST(Elimination, IsNotFiniteWhereNothingSolves) {
  Matrix A = Matrix::Identity();
  A.row(4) = A.row(2);
  EXPECT_FALSE(Elimination<6>(A).solve(Vector::Ones()).allFinite());
}

}  // namespace
}  // namespace paracal::detail::elimination_test
