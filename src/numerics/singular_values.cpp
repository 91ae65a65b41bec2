#include <Eigen/SVD>

#include "numerics/dense.hpp"

namespace paracal::detail {

SingularValues singular_values(const Eigen::MatrixXd& A) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace paracal::detail
