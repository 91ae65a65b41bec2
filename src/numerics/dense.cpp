#include "numerics/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace paracal::detail {
namespace {

Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> complete(const Eigen::MatrixXd& A,
                                                                 std::optional<double> threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  if (threshold) decomposition.setThreshold(*threshold);
  decomposition.compute(A);
  return decomposition;
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

Cholesky::Cholesky(const Eigen::MatrixXd& M) {
  const Eigen::LLT<Eigen::MatrixXd> root(M);
  ok_ = root.info() == Eigen::Success;
  lower_ = root.matrixLLT();
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

Eigen::MatrixXd Cholesky::inverse() const {
  const Eigen::Index n = lower_.rows();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, n);
  add_square(inverse, forward(Eigen::MatrixXd::Identity(n, n)).transpose());
  complete_from_lower(inverse);
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
