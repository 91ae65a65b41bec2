#pragma once

#include <Eigen/Core>
#include <vector>

namespace paracal {

/// y = rotation x + translation.
struct RigidMotion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator()(const Eigen::Vector3d& x) const { return rotation * x + translation; }
  RigidMotion inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
};

/// The rigid motion that brings `from` closest to `to`: min sum w_k |to_k - motion(from_k)|^2  [kabsch1976].
/// @param weights  one a point; empty: all alike. Points on one line leave the turn about it open; any is returned.
RigidMotion rigid_fit(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to,
                      const std::vector<double>& weights = {});

/// The same for min sum |to_k - motion(from_k)| by reweighting: gross errors in a minority of points hardly move it.
RigidMotion robust_rigid_fit(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to);

}  // namespace paracal
