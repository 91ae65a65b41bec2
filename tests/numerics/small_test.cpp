#include "numerics/small.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "numerics/dense.hpp"

namespace paracal::detail::small_test {
namespace {

using Matrix = Eigen::Matrix<double, 6, 6>;
using Vector = Eigen::Matrix<double, 6, 1>;

/// A matrix of random numbers swaps rows at nearly every pivot.
TEST(Elimination, Solves) {
  std::mt19937_64 engine(3);
  std::normal_distribution<> normal;
  for (int k = 0; k < 1000; ++k) {
    Matrix A = Matrix::NullaryExpr([&] { return normal(engine); });
    if (k % 3 == 0) A(0, 0) = 0.0;  // wants another row
    const Vector b = Vector::NullaryExpr([&] { return normal(engine); });
    const Vector found = Elimination<6>(A).solve(b);
    EXPECT_LT((A * found - b).norm(), 1e-13 * A.norm() * found.norm());
  }
}

TEST(Elimination, IsNotFiniteWhereNothingSolves) {
  Matrix A = Matrix::Identity();
  A.row(4) = A.row(2);
  EXPECT_FALSE(Elimination<6>(A).solve(Vector::Ones()).allFinite());
}

/// Of fixed size, and of a size with a maximum.
template <typename Matrix>
void check_solutions(Eigen::Index n) {
  std::mt19937_64 engine(5);
  std::normal_distribution<> normal;
  for (int k = 0; k < 200; ++k) {
    Matrix root(n, n), B(n, n);
    root = Matrix::NullaryExpr(n, n, [&] { return normal(engine); });
    B = Matrix::NullaryExpr(n, n, [&] { return normal(engine); });
    const Matrix M = root * root.transpose() + Matrix::Identity(n, n);
    Matrix lower = M;
    lower.template triangularView<Eigen::StrictlyUpper>().setConstant(7.0);  // not read
    const SmallCholesky<Matrix> found(lower);
    ASSERT_TRUE(found.ok());
    EXPECT_LT((M * found.solve(B.col(0)) - B.col(0)).norm(), 1e-12 * M.norm());
    EXPECT_NEAR(found.trace_of_solution(M * B), B.trace(), 1e-12 * M.norm());
    EXPECT_NEAR(found.log_root(), 0.5 * std::log(determinant(M)), 1e-12);
  }
}

TEST(SmallCholesky, Solves) {
  check_solutions<Eigen::Matrix3d>(3);
  check_solutions<Eigen::Matrix<double, 6, 6>>(6);
  check_solutions<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 7, 7>>(5);
}

TEST(SmallDeterminant, IsThatOfEigen) {
  std::mt19937_64 engine(4);
  std::normal_distribution<> normal;
  using Any = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 16, 6>;
  for (int k = 0; k < 100; ++k) {
    Matrix M = Matrix::NullaryExpr([&] { return normal(engine); });
    if (k % 2 == 0) M(0, 0) = 0.0;  // wants another row, which turns the sign
    EXPECT_NEAR(small_determinant(M), determinant(M), 1e-12 * M.norm());
    EXPECT_NEAR(small_determinant(Any(M.topLeftCorner<3, 3>())), determinant(M.topLeftCorner<3, 3>()), 1e-13);
    M.row(4) = 2.0 * M.row(1);
    EXPECT_NEAR(small_determinant(M), 0.0, 1e-12);
  }
  EXPECT_EQ(small_determinant(Matrix(Matrix::Zero())), 0.0);
}

TEST(SmallCholesky, RefusesWhatIsNotPositiveDefinite) {
  Matrix M = Matrix::Identity();
  M(3, 3) = 0.0;
  EXPECT_FALSE(SmallCholesky<Matrix>(M).ok());
  M(3, 3) = -1.0;
  EXPECT_FALSE(SmallCholesky<Matrix>(M).ok());
  M(3, 3) = std::nan("");
  ASSERT_TRUE(SmallCholesky<Matrix>(M).ok());
  EXPECT_FALSE(SmallCholesky<Matrix>(M).solve(Vector::Ones()).allFinite());
}

}  // namespace
}  // namespace paracal::detail::small_test
