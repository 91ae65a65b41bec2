#pragma once

// The linear error model of one limb that keeps its plate level [huang2016, Eq. (4)], once: for the library's
// error_model() and for the linear ways of a controller's compensator. Needs only the standard library and
// machine_closure.hpp. Real-time: yes.

#include <array>
#include <cmath>

#include "paracal/mechanism/machine_closure.hpp"

namespace paracal::closure {

/// Its rows at a pose of the nominal robot.
template <typename Scalar>
struct LinearLimb {
  /// Of dp_d, mm: L theta_offset, e_x, e_y, e_z, arm_length, L alpha0, L beta0, rod_mean; on a rail theta_offset is a
  /// length, the rod takes the place of L, and gain, mm/m, that of arm_length.
  std::array<Scalar, 8> B_d;
  /// Of dp_e, rad: rod_difference / c, width_difference / c, alpha03, beta03, alpha2, beta2.
  std::array<Scalar, 6> B_e;
  Vector<Scalar> A_de, A_ee;  ///< mm and 1
  Scalar by_joint;            ///< B_m, mm per rad or mm
  Vector<Scalar> rod;         ///< l, unit vector
};

template <typename Scalar>
Vector<Scalar> unit(const Vector<Scalar>& v) noexcept {
  return scaled(v, Scalar(1) / std::sqrt(dot(v, v)));
}

/// @param first   its arm (on a rail its rod) scales angles to lengths.
/// @param radial  the axis about which alpha0 and alpha3 turn.
/// @param joint   where it is, rad or mm.
template <typename Scalar>
LinearLimb<Scalar> linear_limb(const ClosureLimb<Scalar>& limb, const ClosureLimb<Scalar>& first,
                               const Vector<Scalar>& radial, const ClosurePose<Scalar>& pose, Scalar joint) noexcept {
  const bool on_rail = drive_of(limb) == Drive::rail;
  const auto [u1, v1, elbow] = elbow_of(limb, arm_at(limb, joint));
  const Vector<Scalar> a = plate_joint(limb, pose.phi), lever = sum(elbow, limb.base, Scalar(-1));
  const Vector<Scalar> l = unit(sum(sum({pose.x, pose.y, pose.z}, a), elbow, Scalar(-1)));
  const Scalar lu = dot(l, u1), lv = dot(l, v1), lw = dot(l, limb.axis);
  // How far the elbow goes along the rod when the frame turns about an axis: first the radial one, then the arm's
  // normal or the actuator's axis.
  const auto turned = [&](const Vector<Scalar>& axis) {
    return dot(l, cross(axis, lever)) / (on_rail ? first.rod[0] : first.arm);
  };
  // The short side at the plate turns about the radial direction, then about the normal of its own frame.
  const Vector<Scalar> w3 = unit(limb.plate_half), u3 = cross(unit(cross(w3, radial)), w3);
  return {{on_rail ? lv : lv * (limb.arm / first.arm), l[0], l[1], l[2], on_rail ? lv * joint / Scalar(1000) : lu,
           turned(radial), turned(on_rail ? limb.axis : limb.normal), Scalar(1)},
          {Scalar(1), lw, dot(l, cross(radial, w3)), dot(l, u3), -lv, lu},
          cross(a, l),
          cross(limb.axis, l),
          on_rail ? lv / limb.joint_per_mm : limb.arm * lv,
          l};
}

}  // namespace paracal::closure
