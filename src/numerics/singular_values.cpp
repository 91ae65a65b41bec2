#include <Eigen/SVD>
#include <algorithm>

#include "numerics/dense.hpp"

namespace paracal::detail {

/// A and R of Q R = A have the same singular values and V. Eigen's own preconditioner and its divide-and-conquer take a
/// minute to compile; without a preconditioner the matrix must be square: R, or A with rows of zeros below.
SingularValues singular_values(const Eigen::MatrixXd& A) {
  const Eigen::Index n = A.cols(), count = std::min(n, A.rows());
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(n, n);
  square.topRows(count) = A.rows() > n ? Eigen::MatrixXd(upper_of_qr(A).topRows(n)) : A;
  const Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner> svd(square, Eigen::ComputeFullV);
  return {svd.singularValues().head(count), svd.matrixV()};
}

}  // namespace paracal::detail
