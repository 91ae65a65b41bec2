#include "numerics/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <array>
#include <type_traits>

namespace paracal::detail {
namespace {

Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> complete(const Eigen::MatrixXd& A,
                                                                 std::optional<double> threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  if (threshold) decomposition.setThreshold(*threshold);
  decomposition.compute(A);
  return decomposition;
}

/// to += sum_k factors[k] columns[k], of so many rows: one pass, which loads and stores a sum once.
template <int Columns>
void add_multiples(const double* first, Eigen::Index stride, const double* factors, Eigen::Index rows,
                   double* __restrict__ to) {
  for (Eigen::Index i = 0; i < rows; ++i) {
    double sum = to[i];
    for (int k = 0; k < Columns; ++k) sum += factors[k] * first[k * stride + i];
    to[i] = sum;
  }
}

/// to += sum_k factor(k) from.col(k), over length(k) rows from `row` on, which do not become fewer. Most columns go
/// together.
template <typename Factor, typename Length>
void add_columns(const Eigen::MatrixXd& from, Eigen::Index first, Eigen::Index end, Eigen::Index row, Factor&& factor,
                 Length&& length, double* to) {
  std::array<double, 8> factors{};
  const auto add = [&]<int Columns>(std::integral_constant<int, Columns>) {
    for (; first + Columns <= end; first += Columns) {
      for (int k = 0; k < Columns; ++k) factors[static_cast<std::size_t>(k)] = factor(first + k);
      add_multiples<Columns>(&from(row, first), from.rows(), factors.data(), length(first + Columns - 1), to);
    }
  };
  add(std::integral_constant<int, 8>());
  add(std::integral_constant<int, 4>());
  add(std::integral_constant<int, 1>());
}

}  // namespace

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd inverse_square_root(const Eigen::MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).operatorInverseSqrt();
}

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(A).solve(B);
}

Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& A) {
  return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(A).householderQ();
}

Eigen::MatrixXd shortest_solution(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, std::optional<double> threshold) {
  return complete(A, threshold).solve(B);
}

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A, std::optional<double> threshold) {
  return complete(A, threshold).pseudoInverse();
}

Eigen::MatrixXd turned_by_q(const Eigen::MatrixXd& A, Eigen::MatrixXd B) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  B.applyOnTheLeft(qr.householderQ().adjoint());
  return B;
}

Eigen::MatrixXd orthogonal_factor(const Eigen::MatrixXd& A) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).householderQ();
}

Eigen::MatrixXd upper_of_qr(const Eigen::MatrixXd& A) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).matrixQR().triangularView<Eigen::Upper>();
}

Eigen::MatrixXd full_rank_solution(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).solve(B);
}

Eigen::MatrixXd cholesky(const Eigen::MatrixXd& M) { return Eigen::LLT<Eigen::MatrixXd>(M).matrixL(); }

Eigen::MatrixXd cholesky_solution(const Eigen::MatrixXd& M, const Eigen::MatrixXd& B) {
  return Eigen::LLT<Eigen::MatrixXd>(M).solve(B);
}

// Eigen's LLT and its triangles have blocks of eight: of 60 rows these take twice as many instructions as whole
// columns.
Cholesky::Cholesky(const Eigen::MatrixXd& M) : lower_(M) {
  const Eigen::Index n = M.rows();
  for (Eigen::Index k = 0; ok_ && k < n; ++k) {
    const auto factor = [&](Eigen::Index before) { return -lower_(k, before); };
    add_columns(
        lower_, 0, k, k, factor, [&](Eigen::Index) { return n - k; }, &lower_(k, k));
    ok_ = lower_(k, k) > 0.0;
    lower_.col(k).tail(n - k) /= std::sqrt(lower_(k, k));
  }
}

Eigen::MatrixXd Cholesky::solve(Eigen::MatrixXd B) const {
  lower_.triangularView<Eigen::Lower>().solveInPlace(B);
  lower_.transpose().triangularView<Eigen::Upper>().solveInPlace(B);
  return B;
}

Eigen::MatrixXd Cholesky::forward(Eigen::MatrixXd B) const {
  lower_.triangularView<Eigen::Lower>().solveInPlace(B);
  return B;
}

/// U = L^-T column by column, then U U^T: upper triangles, of which the zeros take no work.
Eigen::MatrixXd Cholesky::inverse() const {
  const Eigen::Index n = lower_.rows();
  Eigen::MatrixXd U = Eigen::MatrixXd::Zero(n, n), inverse = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double pivot = 1.0 / lower_(k, k);
    const auto factor = [&](Eigen::Index before) { return -pivot * lower_(k, before); };
    add_columns(
        U, 0, k, 0, factor, [](Eigen::Index before) { return before + 1; }, &U(0, k));
    U(k, k) = pivot;
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto factor = [&](Eigen::Index from) { return U(k, from); };
    add_columns(
        U, k, n, 0, factor, [&](Eigen::Index) { return k + 1; }, &inverse(0, k));
  }
  inverse.triangularView<Eigen::StrictlyLower>() = inverse.transpose();
  return inverse;
}

double Cholesky::log_root() const { return lower_.diagonal().array().log().sum(); }

Eigen::VectorXd symmetric_solution(const Eigen::MatrixXd& M, const Eigen::VectorXd& b) {
  return Eigen::LDLT<Eigen::MatrixXd>(M).solve(b);
}

Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) { return A * B; }

void add_square(Eigen::MatrixXd& M, const Eigen::MatrixXd& A, double weight) {
  M.selfadjointView<Eigen::Lower>().rankUpdate(A, weight);
}

void complete_from_lower(Eigen::MatrixXd& M) { M.triangularView<Eigen::StrictlyUpper>() = M.transpose(); }

double determinant(const Eigen::MatrixXd& M) { return M.determinant(); }

Eigen::MatrixXd inverse(const Eigen::MatrixXd& M) { return M.inverse(); }

}  // namespace paracal::detail
