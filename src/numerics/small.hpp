#pragma once

// Private to the library: a few equations in as many unknowns. Eigen's factorizations of this size cost two to three
// times as much at run time, since their loops are made for larger ones, and each takes seconds to compile.

#include <Eigen/Core>
#include <Eigen/LU>  // IWYU pragma: export: inverse() and determinant() of at most 4 x 4, closed forms
#include <array>
#include <cmath>
#include <utility>

namespace paracal::detail {

/// Gauss's elimination with partial pivoting: L U = P A.
template <int N>
class Elimination {
 public:
  explicit Elimination(const Eigen::Matrix<double, N, N>& A) : rows_(A) {
    for (int k = 0; k < N; ++k) {
      int pivot = k;
      for (int i = k + 1; i < N; ++i) pivot = std::abs(rows_(i, k)) > std::abs(rows_(pivot, k)) ? i : pivot;
      swapped_[k] = pivot;
      if (pivot != k) rows_.row(k).swap(rows_.row(pivot));
      inverse_(k) = 1.0 / rows_(k, k);
      for (int i = k + 1; i < N; ++i) {
        const double share = rows_(i, k) * inverse_(k);
        for (int j = k + 1; j < N; ++j) rows_(i, j) -= share * rows_(k, j);
        rows_(i, k) = share;
      }
    }
  }

  /// x of A x = b; not finite where A is singular.
  Eigen::Matrix<double, N, 1> solve(Eigen::Matrix<double, N, 1> b) const {
    for (int k = 0; k < N; ++k) std::swap(b(k), b(swapped_[k]));
    for (int k = 0; k < N; ++k) {
      for (int i = k + 1; i < N; ++i) b(i) -= rows_(i, k) * b(k);
    }
    for (int k = N - 1; k >= 0; --k) {
      b(k) *= inverse_(k);
      for (int i = 0; i < k; ++i) b(i) -= rows_(i, k) * b(k);
    }
    return b;
  }

 private:
  Eigen::Matrix<double, N, N, Eigen::RowMajor> rows_;  ///< U, and L below its diagonal
  Eigen::Matrix<double, N, 1> inverse_;                ///< of U's diagonal
  std::array<int, N> swapped_{};
};

/// det M by the same elimination.
/// @tparam Matrix  of fixed size, or of a size with a fixed maximum.
template <typename Matrix>
double small_determinant(Matrix M) {
  double determinant = 1.0;
  for (Eigen::Index k = 0; k < M.rows(); ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < M.rows(); ++i) pivot = std::abs(M(i, k)) > std::abs(M(pivot, k)) ? i : pivot;
    if (M(pivot, k) == 0.0) return 0.0;
    if (pivot != k) {
      M.row(k).swap(M.row(pivot));
      determinant = -determinant;
    }
    determinant *= M(k, k);
    for (Eigen::Index i = k + 1; i < M.rows(); ++i) {
      const double share = M(i, k) / M(k, k);
      for (Eigen::Index j = k + 1; j < M.rows(); ++j) M(i, j) -= share * M(k, j);
    }
  }
  return determinant;
}

/// M = L L^T of a small symmetric matrix; its lower triangle is read.
/// @tparam Matrix  of fixed size, or of a size with a fixed maximum.
template <typename Matrix>
class SmallCholesky {
 public:
  using Vector = Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1, Eigen::ColMajor, Matrix::MaxRowsAtCompileTime, 1>;

  explicit SmallCholesky(const Matrix& M) : lower_(M), inverse_(M.rows()) {
    for (Eigen::Index k = 0; k < lower_.rows(); ++k) {
      double pivot = lower_(k, k);
      for (Eigen::Index j = 0; j < k; ++j) pivot -= lower_(k, j) * lower_(k, j);
      if (pivot <= 0.0) return;
      lower_(k, k) = std::sqrt(pivot);
      inverse_(k) = 1.0 / lower_(k, k);
      for (Eigen::Index i = k + 1; i < lower_.rows(); ++i) {
        double rest = lower_(i, k);
        for (Eigen::Index j = 0; j < k; ++j) rest -= lower_(i, j) * lower_(k, j);
        lower_(i, k) = rest * inverse_(k);
      }
    }
    ok_ = true;
  }

  /// M is positive definite, or holds NaN, as the solutions then do.
  bool ok() const { return ok_; }

  /// M^-1 b. @pre ok()
  Vector solve(Vector b) const {
    for (Eigen::Index k = 0; k < b.size(); ++k) {
      b(k) *= inverse_(k);
      for (Eigen::Index i = k + 1; i < b.size(); ++i) b(i) -= lower_(i, k) * b(k);
    }
    for (Eigen::Index k = b.size(); k-- > 0;) {
      b(k) *= inverse_(k);
      for (Eigen::Index i = 0; i < k; ++i) b(i) -= lower_(k, i) * b(k);
    }
    return b;
  }

  /// tr(M^-1 B). @pre ok()
  double trace_of_solution(const Matrix& B) const {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < B.cols(); ++k) sum += solve(B.col(k))(k);
    return sum;
  }

  /// log det L = (log det M) / 2. @pre ok()
  double log_root() const { return lower_.diagonal().array().log().sum(); }

 private:
  Matrix lower_;    ///< L; what is above its diagonal is M's
  Vector inverse_;  ///< of L's diagonal
  bool ok_ = false;
};

}  // namespace paracal::detail
