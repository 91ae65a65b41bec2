#pragma once

// Private to kinematics: a few equations in as many unknowns. Eigen's factorizations of this size cost two to three
// times as much: their loops are made for larger ones.

#include <Eigen/Core>
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

}  // namespace paracal::detail
