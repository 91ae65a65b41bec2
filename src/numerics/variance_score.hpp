#pragma once

// Private to calibration: a component of variance on trial before it is sought.

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>

namespace paracal::detail {

/// Score and information of three variances at zero: of joints, and of noise of positions and orientations. With
/// whitened residuals e, Q = I - J C J^T of each reading, and what they add to its covariance, A = H H^T and parts of
/// I,
///
///   u_k = sum e^T A_k e - tr(A_k Q),   I_kl = 2 sum tr(A_k Q A_l Q)
struct VarianceScore {
  Eigen::Vector3d score = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();

  void add(const std::array<Eigen::MatrixXd, 3>& A, const Eigen::MatrixXd& Q, const Eigen::VectorXd& e) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      const Eigen::MatrixXd& of_k = A.at(static_cast<std::size_t>(k));
      score(k) += e.dot(of_k * e) - (of_k * Q).trace();
      for (Eigen::Index l = 0; l < 3; ++l) {
        information(k, l) += 2.0 * (of_k * Q * A.at(static_cast<std::size_t>(l)) * Q).trace();
      }
    }
  }

  /// z^2 of the first with the others sought: z = (u_j - I_jn I_nn^-1 u_n) / sqrt(I_jj - I_jn I_nn^-1 I_nj); 0 where
  /// the variance would be negative.
  double drop_of_first() const {
    const Eigen::RowVector2d follows = information.block<1, 2>(0, 1) * information.bottomRightCorner<2, 2>().inverse();
    const double left = information(0, 0) - follows * information.block<2, 1>(1, 0);
    const double beyond = score(0) - follows * score.tail<2>();
    return left > 0.0 && beyond > 0.0 ? beyond * beyond / left : 0.0;
  }
};

}  // namespace paracal::detail
