#pragma once

#include <Eigen/Core>
#include <array>

#include "paracal/kinematics/closure.hpp"

namespace paracal::test {

/// Residuals of all rods, |r + R plate_joint - elbow_joint| - l_j in mm [huang2016, Eq. (1)], in the order limb 1 rod
/// 1, limb 1 rod 2, limb 2 rod 1, ...; entries beyond the last rod are zero. A closed machine has them all zero, up to
/// what one over-constraint leaves.
template <typename Scalar>
Eigen::Matrix<Scalar, 2 * kMaxLimbs, 1> rod_residuals(const BasicMachine<Scalar>& machine,
                                                      const BasicPlateState<Scalar>& plate,
                                                      const std::array<Scalar, kMaxLimbs>& joints) {
  using Residuals = Eigen::Matrix<Scalar, 2 * kMaxLimbs, 1>;
  Residuals residuals = Residuals::Constant(Scalar(0));
  const Matrix3<Scalar> rotation = plate_rotation(plate.tilt).matrix;
  Eigen::Index row = 0;
  const Scalar phi = machine.has_slide() ? Scalar(plate.slide / machine.pinion_radius) : Scalar(0);
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const BasicLimb<Scalar>& limb = machine.limbs[i];
    const auto upper = ends_at(limb, joints[i]);
    const auto lower = closure::lower_ends<2, Scalar>(limb, phi);
    for (std::size_t j = 0; j < limb.actuator.rods; ++j, ++row) {
      const Vector3<Scalar> rod = plate.position + rotation * as_eigen(lower[j]) - as_eigen(upper.place[j]);
      residuals(row) = rod.norm() - upper.length[j];
    }
  }
  return residuals;
}

}  // namespace paracal::test
