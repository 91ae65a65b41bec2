#include "paracal/numerics/information_root.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

#include "numerics/dense.hpp"

namespace paracal::information_root_test {
namespace {

/// T = [R q; 0 e] as far as the interface shows it: T^T T.
Eigen::MatrixXd normal_matrix(const InformationRoot& root) {
  const Eigen::Index n = root.parameter_count();
  const Eigen::MatrixXd r = root.root();
  const Eigen::VectorXd q = root.reachable();
  Eigen::MatrixXd normal(n + 1, n + 1);
  normal << r.transpose() * r, r.transpose() * q, q.transpose() * r, root.squared_residuals();
  return normal;
}

Eigen::MatrixXd normal_matrix(const Eigen::MatrixXd& rows) { return rows.transpose() * rows; }

testing::AssertionResult agree(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected,
                               double tolerance = 1e-13) {
  const double error = (actual - expected).norm() / expected.norm();
  if (error <= tolerance) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "relative error " << error << "\n" << actual << "\ninstead of\n" << expected;
}

InformationRoot root_of(const Eigen::MatrixXd& rows, Eigen::Index block) {
  InformationRoot root(rows.cols() - 1);
  for (Eigen::Index first = 0; first < rows.rows(); first += block)
    root.add(rows.middleRows(first, std::min(block, rows.rows() - first)));
  return root;
}

class InformationRootBlocks : public testing::TestWithParam<int> {};

TEST_P(InformationRootBlocks, DoNotChangeWhatTheRowsSay) {
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(1000, 6);
  const InformationRoot root = root_of(rows, GetParam());
  EXPECT_TRUE(agree(normal_matrix(root), normal_matrix(rows)));
  EXPECT_TRUE(root.root().isUpperTriangular(0.0));
  EXPECT_EQ(root.parameter_count(), 5);
  EXPECT_EQ(root.row_count(), 1000);
}

INSTANTIATE_TEST_SUITE_P(Rows, InformationRootBlocks, testing::Values(1, 7, 63, 64, 65, 300, 1000));

TEST(InformationRoot, SaysNothingBeforeTheFirstRow) {
  const InformationRoot root(3);
  EXPECT_TRUE(root.root().isZero(0.0));
  EXPECT_TRUE(root.reachable().isZero(0.0));
  EXPECT_EQ(root.squared_residuals(), 0.0);
  EXPECT_EQ(root.row_count(), 0);
}

TEST(InformationRoot, HoldsFewerRowsThanParameters) {
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(2, 6);
  EXPECT_TRUE(agree(normal_matrix(root_of(rows, 1)), normal_matrix(rows)));
}

/// |J dp + r|^2 = |R dp + q|^2 + e^2 for any step.
TEST(InformationRoot, PredictsTheResidualsOfAnyStep) {
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(200, 5);
  const InformationRoot root = root_of(rows, 200);
  const double unreachable = root.squared_residuals() - root.reachable().squaredNorm();
  for (int k = 0; k < 10; ++k) {
    const Eigen::VectorXd step = 3.0 * Eigen::VectorXd::Random(4);
    const double after = (rows.leftCols<4>() * step + rows.col(4)).squaredNorm();
    EXPECT_NEAR((root.root() * step + root.reachable()).squaredNorm() + unreachable, after, 1e-12 * after);
  }
}

TEST(InformationRoot, AddingRootsEqualsAddingRows) {
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(300, 5);
  InformationRoot sum = root_of(rows.topRows(100), 100);
  sum.add(root_of(rows.bottomRows(200), 30));
  EXPECT_TRUE(agree(normal_matrix(sum), normal_matrix(rows)));
  EXPECT_EQ(sum.row_count(), 300);
  sum.add(InformationRoot(4));
  EXPECT_TRUE(agree(normal_matrix(sum), normal_matrix(rows)));
  EXPECT_EQ(sum.row_count(), 300);
}

TEST(InformationRoot, APriorIsOneMoreRow) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Random(20, 4);
  InformationRoot root = root_of(rows, 20);
  root.add_prior(1, 3.0, 2.5, 0.1);
  rows.conservativeResize(21, Eigen::NoChange);
  rows.row(20) << 0.0, 10.0, 0.0, 5.0;
  EXPECT_TRUE(agree(normal_matrix(root), normal_matrix(rows)));
  EXPECT_EQ(root.row_count(), 21);
}

TEST(InformationRoot, APriorAloneMovesItsParameterThereAndSetsItsDeviation) {
  InformationRoot root(1);
  root.add_prior(0, 3.0, 2.5, 0.1);
  EXPECT_NEAR(-root.reachable()(0) / root.root()(0, 0), -0.5, 1e-15);
  EXPECT_NEAR(inverse_information(root.root())(0, 0), 0.01, 1e-15);
}

/// More rows than any buffer holds, and a look in between.
TEST(InformationRoot, ReadingBetweenRowsChangesNothing) {
  InformationRoot root(3);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(4, 4);
  for (int block = 0; block < 1000; ++block) {
    const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(100, 4);
    expected += normal_matrix(rows);
    root.add(rows);
    if (block % 100 == 0) {
      EXPECT_TRUE(agree(normal_matrix(root), expected, 1e-12));
    }
  }
  EXPECT_TRUE(agree(normal_matrix(root), expected, 1e-12));
  EXPECT_EQ(root.row_count(), 100'000);
}

/// Lauchli's rows: J^T J = [1 + e^2, 1; 1, 1 + e^2] rounds to a singular matrix, J is far from it.
TEST(InformationRoot, IsAsAccurateAsTheRowsThemselves) {
  constexpr double kSmall = 1e-9;
  InformationRoot root(2);
  root.add(Eigen::RowVector3d(1.0, 1.0, 0.0));
  root.add(Eigen::RowVector3d(kSmall, 0.0, 0.0));
  root.add(Eigen::RowVector3d(0.0, kSmall, 0.0));
  Eigen::Matrix2d expected;
  expected << 1.0 + kSmall * kSmall, -1.0, -1.0, 1.0 + kSmall * kSmall;
  expected /= kSmall * kSmall * (2.0 + kSmall * kSmall);
  EXPECT_TRUE(agree(inverse_information(root.root()), expected, 1e-6));
}

TEST(Spectrum, OfFullRankHasTheCovarianceOfTheNormalEquations) {
  const Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(50, 4) * Eigen::Vector4d(1e-3, 1.0, 20.0, 1e4).asDiagonal();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(50, 5);
  rows.leftCols<4>() = jacobian;
  const Eigen::MatrixXd root = root_of(rows, 50).root();
  const Spectrum spectrum = analyse(root, 1e-7);
  const Eigen::MatrixXd expected = (jacobian.transpose() * jacobian).inverse();
  EXPECT_EQ(spectrum.rank, 4);
  EXPECT_EQ(spectrum.null_space.cols(), 0);
  EXPECT_TRUE(agree(spectrum.covariance, expected, 1e-10));
  EXPECT_TRUE(agree(inverse_information(root), expected, 1e-10));
  EXPECT_TRUE(agree(spectrum.scale, jacobian.colwise().norm().transpose()));
}

/// Column 1 is twice column 0, column 3 is zero.
class RankDeficient : public testing::Test {
 protected:
  RankDeficient() {
    const Eigen::MatrixXd random = Eigen::MatrixXd::Random(30, 3);
    rows << random.col(0), 2.0 * random.col(0), random.col(1), Eigen::VectorXd::Zero(30), random.col(2);
  }
  Eigen::MatrixXd rows{30, 5};
};

TEST_F(RankDeficient, NullSpaceIsWhatTheRowsDoNotSee) {
  const Spectrum spectrum = analyse(root_of(rows, 30).root(), 1e-7);
  EXPECT_EQ(spectrum.rank, 2);
  EXPECT_TRUE(std::is_sorted(spectrum.singular_values.begin(), spectrum.singular_values.end(), std::greater<>()));
  EXPECT_EQ(spectrum.scale(3), 1.0);
  ASSERT_EQ(spectrum.null_space.cols(), 2);
  EXPECT_LT((rows.leftCols<4>() * spectrum.null_space).norm(), 1e-13);
  EXPECT_TRUE(agree(spectrum.null_space.colwise().norm(), Eigen::RowVector2d::Ones()));
  EXPECT_GT(detail::singular_values(spectrum.null_space).values(1), 1e-6);  // two of them
}

/// (R^T R)^+ is a generalized inverse, A A^+ A = A and A^+ A A^+ = A^+, and knows nothing of the unseen parameter.
TEST_F(RankDeficient, CovarianceSpeaksOfSeenDirectionsOnly) {
  const Eigen::MatrixXd root = root_of(rows, 30).root();
  const Eigen::MatrixXd information = root.transpose() * root;
  const Eigen::MatrixXd covariance = analyse(root, 1e-7).covariance;
  EXPECT_TRUE(agree(information * covariance * information, information));
  EXPECT_TRUE(agree(covariance * information * covariance, covariance));
  EXPECT_LT(covariance.col(3).norm(), 1e-15);
}

TEST_F(RankDeficient, PriorsCloseTheNullSpace) {
  InformationRoot root = root_of(rows, 30);
  root.add_prior(0, 0.0, 0.0, 2.0);
  root.add_prior(3, 0.0, 0.0, 0.5);
  const Spectrum spectrum = analyse(root.root(), 1e-7);
  EXPECT_EQ(spectrum.rank, 4);
  EXPECT_NEAR(spectrum.covariance(0, 0), 4.0, 1e-12);
  EXPECT_NEAR(spectrum.covariance(3, 3), 0.25, 1e-12);
}

/// With a scale of one's own a weak column counts as unseen, which its own length would hide.
TEST(Spectrum, CountsRankInTheScaleItIsGiven) {
  const Eigen::MatrixXd root = Eigen::Vector3d(1.0, 1e-3, 1e-12).asDiagonal();
  EXPECT_EQ(analyse(root, 1e-7).rank, 3);
  const Spectrum spectrum = analyse(root, 1e-7, Eigen::Vector3d::Ones());
  EXPECT_EQ(spectrum.rank, 2);
  ASSERT_EQ(spectrum.null_space.cols(), 1);
  EXPECT_NEAR(std::abs(spectrum.null_space(2, 0)), 1.0, 1e-15);
}

}  // namespace
}  // namespace paracal::information_root_test
