#pragma once

#include <Eigen/Eigenvalues>

namespace paracal::detail {

/// B = B^T with B B = C, whether C has full rank or not. The symmetric root: unlike a triangular one or eigenvectors it
/// is continuous in C, so that rounding does not draw other machines.
inline Eigen::MatrixXd square_root(const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return covariance;  // Eigen decomposes nothing that is empty
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace paracal::detail
