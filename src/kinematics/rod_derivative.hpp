#pragma once

// Private to kinematics: the closure of one rod by the errors of its limb.

#include <Eigen/Core>

#include "paracal/kinematics/closure.hpp"

namespace paracal::detail {

/// A column a source error of one limb.
using SourceRow = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, static_cast<int>(kMostSources)>;

/// df / dp of a limb with one rod, f = |r + R a - C| - l. All its errors but those of the joint at the plate move its
/// upper end C by m and shorten f by n.m, or make the rod longer.
SourceRow single_rod_derivative(const Limb& limb, double joint, const Eigen::Matrix3d& rotation,
                                const Eigen::Vector3d& n);

/// df / dq: mm of a rod's residual per rad or mm of where the joint of its limb is.
inline double by_joint(const Limb& limb, const Elbow<double>& elbow, std::size_t rod,
                       const Eigen::Vector3d& direction) {
  return limb.is_strut() ? -limb.gain : -direction.dot(hinge_motion(limb, elbow, rod));
}

}  // namespace paracal::detail
