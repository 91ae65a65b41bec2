#pragma once

#include "dense.hpp"

namespace paracal::detail {

/// B = B^T with B B = C, whether C has full rank or not. The symmetric root: unlike a triangular one or eigenvectors it
/// is continuous in C, so that rounding does not draw other machines.
inline Eigen::MatrixXd square_root(const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return covariance;  // Eigen decomposes nothing that is empty
  if (covariance.isDiagonal(0.0)) return covariance.diagonal().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  return eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
}

}  // namespace paracal::detail
