#include "paracal/numerics/rigid_fit.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

#include "paracal/interruption.hpp"

namespace paracal {

RigidMotion rigid_fit(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to,
                      const std::vector<double>& weights) {
  let_interrupt();
  const auto weight = [&](std::size_t k) { return weights.empty() ? 1.0 : weights[k]; };
  Eigen::Vector3d from_centre = Eigen::Vector3d::Zero(), to_centre = Eigen::Vector3d::Zero();
  double sum = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    from_centre += weight(k) * from[k];
    to_centre += weight(k) * to[k];
    sum += weight(k);
  }
  if (!(sum > 0.0)) return {};
  from_centre /= sum;
  to_centre /= sum;
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) {
    correlation += weight(k) * (to[k] - to_centre) * (from[k] - from_centre).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d handedness = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) handedness.z() = -1.0;
  RigidMotion motion;
  motion.rotation = svd.matrixU() * handedness.asDiagonal() * svd.matrixV().transpose();
  motion.translation = to_centre - motion.rotation * from_centre;
  return motion;
}

RigidMotion robust_rigid_fit(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to) {
  constexpr int kRounds = 30;
  constexpr double kSmallest = 1e-3;  // mm: nearer points weigh no more than this
  RigidMotion motion = rigid_fit(from, to);
  std::vector<double> weights(from.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < from.size(); ++k) {
      weights[k] = 1.0 / std::max((to[k] - motion(from[k])).norm(), kSmallest);
    }
    motion = rigid_fit(from, to, weights);
  }
  return motion;
}

}  // namespace paracal
