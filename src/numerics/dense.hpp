#pragma once

// Private to the library: decompositions of dense matrices of any size. Eigen's are templates: every file that uses one
// compiles it again, five to forty seconds each. Here each is compiled once.

#include <Eigen/Core>
#include <optional>

namespace paracal::detail {

/// M = V diag(values) V^T of a symmetric matrix, values ascending. Eigen::SelfAdjointEigenSolver.
/// @param symmetric  of at least one row; its lower triangle is read.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  ///< V
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& symmetric);
/// The values alone.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& symmetric);

/// M^-1/2, symmetric, of a positive definite M.
Eigen::MatrixXd inverse_square_root(const Eigen::MatrixXd& symmetric);

/// A = U diag(values) V^T, values descending. Eigen::JacobiSVD of R of A.
struct SingularValues {
  Eigen::VectorXd values;
  Eigen::MatrixXd right;  ///< V, with a column for every column of A
};
SingularValues singular_values(const Eigen::MatrixXd& A);

/// The X that minimises |A X - B|, by a QR decomposition with pivoting. Eigen::ColPivHouseholderQR.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// Q, square, of the same decomposition: its first columns span those of A as far as they have rank.
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& A);

/// The shortest X of those that minimise |A X - B|, and A^+, where A may lack rank.
/// Eigen::CompleteOrthogonalDecomposition.
/// @param threshold  pivots below it, of the largest, count as none; nothing: rounding alone.
Eigen::MatrixXd shortest_solution(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                  std::optional<double> threshold = {});
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A, std::optional<double> threshold = {});

/// Q^T B, and Q (square) and R of Q R = A without pivoting. Eigen::HouseholderQR.
Eigen::MatrixXd turned_by_q(const Eigen::MatrixXd& A, Eigen::MatrixXd B);
Eigen::MatrixXd orthogonal_factor(const Eigen::MatrixXd& A);
Eigen::MatrixXd upper_of_qr(const Eigen::MatrixXd& A);
/// The X that minimises |A X - B|, without pivoting: A has full rank.
Eigen::MatrixXd full_rank_solution(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// L, lower, of L L^T = M for a positive definite M, and M^-1 B. Eigen::LLT.
Eigen::MatrixXd cholesky(const Eigen::MatrixXd& M);
Eigen::MatrixXd cholesky_solution(const Eigen::MatrixXd& M, const Eigen::MatrixXd& B);

/// M = L L^T, factored once for several solutions.
class Cholesky {
 public:
  /// @param M  its lower triangle is read.
  explicit Cholesky(const Eigen::MatrixXd& M);
  /// M is positive definite; all else needs this.
  bool ok() const { return ok_; }
  Eigen::MatrixXd solve(Eigen::MatrixXd B) const;    ///< M^-1 B
  Eigen::MatrixXd forward(Eigen::MatrixXd B) const;  ///< L^-1 B
  Eigen::MatrixXd inverse() const;                   ///< M^-1, symmetric to the last bit
  double log_root() const;                           ///< log det L = (log det M) / 2

 private:
  Eigen::MatrixXd lower_;
  bool ok_ = true;
};

/// X of M X = b for a symmetric M that may be indefinite. Eigen::LDLT.
Eigen::VectorXd symmetric_solution(const Eigen::MatrixXd& M, const Eigen::VectorXd& b);

/// A B.
Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// Adds weight A A^T to the lower triangle of a symmetric M: half of the work of the product.
void add_square(Eigen::MatrixXd& M, const Eigen::MatrixXd& A, double weight = 1.0);
/// Copies the lower triangle of M to the upper one.
void complete_from_lower(Eigen::MatrixXd& M);

/// det M and M^-1. Eigen::PartialPivLU.
double determinant(const Eigen::MatrixXd& M);
Eigen::MatrixXd inverse(const Eigen::MatrixXd& M);

}  // namespace paracal::detail
