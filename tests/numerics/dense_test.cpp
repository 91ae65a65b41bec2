#include "numerics/dense.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace paracal::detail::dense_test {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

/// Square, tall and wide, of full rank and not, and with columns of very different length, by what defines them: V is
/// square and orthonormal, and the columns of A V = U diag(values) are orthogonal and of lengths `values`, descending.
TEST(SingularValues, TurnTheColumnsOrthogonal) {
  std::vector<Eigen::MatrixXd> all = {random_matrix(6, 6, 1), random_matrix(9, 4, 2), random_matrix(3, 8, 3),
                                      random_matrix(1, 5, 4), random_matrix(5, 1, 5), Eigen::MatrixXd::Zero(4, 3)};
  all.push_back(random_matrix(12, 3, 6) * random_matrix(3, 7, 7));
  all.push_back(random_matrix(4, 2, 8) * random_matrix(2, 9, 9));
  all.push_back(
      random_matrix(40, 20, 10) *
      Eigen::VectorXd::LinSpaced(20, 0.0, -9.0).unaryExpr([](double e) { return std::pow(10.0, e); }).asDiagonal());
  for (const Eigen::MatrixXd& A : all) {
    const SingularValues found = singular_values(A);
    const double scale = 1e-14 * static_cast<double>(A.size()) * (1.0 + A.norm());
    ASSERT_EQ(found.values.size(), std::min(A.rows(), A.cols()));
    EXPECT_TRUE(std::ranges::is_sorted(found.values, std::greater<>()));
    ASSERT_EQ(found.right.rows(), A.cols());
    ASSERT_EQ(found.right.cols(), A.cols());
    EXPECT_TRUE((found.right.transpose() * found.right).isIdentity(1e-12));
    Eigen::VectorXd lengths = Eigen::VectorXd::Zero(A.cols());
    lengths.head(found.values.size()) = found.values;
    const Eigen::MatrixXd turned = A * found.right;
    EXPECT_LT((turned.colwise().norm().transpose() - lengths).norm(), scale);
    Eigen::MatrixXd products = turned.transpose() * turned;
    products.diagonal().setZero();
    EXPECT_LT(products.norm(), scale * (1.0 + A.norm()));
  }
}

TEST(Cholesky, Solves) {
  const Eigen::MatrixXd root = random_matrix(9, 9, 11), B = random_matrix(9, 4, 12);
  const Eigen::MatrixXd M = root * root.transpose() + Eigen::MatrixXd::Identity(9, 9);
  const Cholesky found(M);
  ASSERT_TRUE(found.ok());
  const Eigen::MatrixXd solved = found.solve(B), forward = found.forward(B);
  EXPECT_LT((M * solved - B).norm(), 1e-11);
  EXPECT_LT((forward.transpose() * forward - B.transpose() * solved).norm(), 1e-11);
  EXPECT_LT((found.inverse() * M - Eigen::MatrixXd::Identity(9, 9)).norm(), 1e-11);
  EXPECT_EQ(found.inverse(), found.inverse().transpose());
  EXPECT_NEAR(found.log_root(), 0.5 * std::log(determinant(M)), 1e-11);
}

TEST(Cholesky, RefusesWhatIsNotPositiveDefinite) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(5, 5);
  M(2, 2) = -1e-3;
  EXPECT_FALSE(Cholesky(M).ok());
}

TEST(Dense, SquaresAreAddedToTheLowerTriangle) {
  const Eigen::MatrixXd A = random_matrix(5, 7, 16), start = Eigen::MatrixXd::Identity(5, 5);
  Eigen::MatrixXd sum = start;
  add_square(sum, A, 0.5);
  EXPECT_TRUE(sum.isLowerTriangular(0.0));
  complete_from_lower(sum);
  EXPECT_LT((sum - start - 0.5 * A * A.transpose()).norm(), 1e-13);
}

TEST(Dense, InverseSquareRootAndOrthogonalFactor) {
  const Eigen::MatrixXd root = random_matrix(5, 5, 13), M = root * root.transpose();
  const Eigen::MatrixXd half = inverse_square_root(M);
  EXPECT_TRUE((half * M * half).isIdentity(1e-9));
  EXPECT_LT((half - half.transpose()).norm(), 1e-9 * half.norm());
  const Eigen::MatrixXd A = random_matrix(6, 3, 14), Q = orthogonal_factor(A);
  EXPECT_TRUE((Q.transpose() * Q).isIdentity(1e-12));
  EXPECT_LT((Q.rightCols(3).transpose() * A).norm(), 1e-12);
  EXPECT_LT((M * symmetric_solution(M, A.col(0).head(5)) - A.col(0).head(5)).norm(), 1e-9);
}

}  // namespace
}  // namespace paracal::detail::dense_test
