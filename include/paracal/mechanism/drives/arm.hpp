#pragma once

#include "paracal/mechanism/limb_closure.hpp"

namespace paracal::closure {

/// An arm that a motor turns:  C = b + L u_1,  u_1 = cos(th) u_0 + sin(th) v_0,  th = q + joint_offset.
template <typename Scalar>
struct ArmDrive {
  static constexpr bool is_length = false;  ///< its joint coordinate is an angle, rad

  static ArmDirection<Scalar> at(const Scalar& angle) noexcept { return turn_by_any(angle); }
  static Scalar place_of(const ArmDirection<Scalar>& arm) noexcept {
    using std::atan2;
    return atan2(arm.sine, arm.cosine);
  }

  /// Closes the triangle: the arm that puts the elbow one rod away from the plate joint, d from b. Of the two roots it
  /// takes the working mode with the elbow outward, the larger u_1.u_0.
  ///
  ///   |d - L u_1(th)| = l  <=>  A cos(th) + B sin(th) = K
  ///       A = 2 L d.u_0,   B = 2 L d.v_0,   K = d.d + L^2 - l^2
  ///
  /// (A^2 + B^2) (cos(th), sin(th)) needs one square root and no division, since only the direction matters.
  static ArmDirection<Scalar> close(const ClosureLimb<Scalar>& limb, const Vector<Scalar>& d) noexcept {
    using std::copysign, std::sqrt;
    const Scalar diameter = Scalar(2) * limb.arm, rod = mean_rod(limb);
    const Scalar a = diameter * dot(d, limb.radial), b = diameter * dot(d, limb.normal);
    const Scalar k = dot(d, d) + limb.arm * limb.arm - rod * rod;
    const Scalar w = copysign(sqrt(a * a + b * b - k * k), -b);
    return {a * k - b * w, b * k + a * w};
  }

  static ClosedElbow<Scalar> elbow(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>& arm) noexcept {
    const Vector<Scalar> u1 = sum(scaled(limb.radial, arm.cosine), limb.normal, arm.sine);
    const Vector<Scalar> v1 = sum(scaled(limb.normal, arm.cosine), limb.radial, -arm.sine);
    return {u1, v1, sum(limb.base, u1, limb.arm)};
  }
  static const Scalar& length(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>&, std::size_t rod) noexcept {
    return limb.rod[rod];
  }

  static Scalar rod_by_joint(const ClosureLimb<Scalar>& limb, const Vector<Scalar>& n,
                             const Vector<Scalar>& v1) noexcept {
    return -dot(n, v1) * limb.arm;
  }
  static ArmDirection<Scalar> moved(const ClosureLimb<Scalar>&, const ArmDirection<Scalar>& arm,
                                    const Scalar& change) noexcept {
    const auto [c, s] = turn_by(change);
    return {arm.cosine * c - arm.sine * s, arm.sine * c + arm.cosine * s};
  }
  static ArmDirection<Scalar> of_unit_length(const ArmDirection<Scalar>& arm) noexcept {
    using std::sqrt;
    const Scalar scale = Scalar(1) / sqrt(arm.cosine * arm.cosine + arm.sine * arm.sine);
    return {arm.cosine * scale, arm.sine * scale};
  }

  // Derivatives of a rod along n, whose upper end is b + u u_1 + v v_1 + ...; C itself at:
  static Levers<Scalar> levers(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>&) noexcept {
    return {limb.arm, Scalar(0)};
  }
  /// By where the drive is.
  static Scalar by_place(const Levers<Scalar>& end, const Vector<Scalar>& n,
                         const ClosedElbow<Scalar>& elbow) noexcept {
    return end.v * dot(n, elbow.u1) - end.u * dot(n, elbow.v1);
  }
  /// By L.
  static Scalar by_arm(const Vector<Scalar>& n, const ClosedElbow<Scalar>& elbow) noexcept { return -dot(n, elbow.u1); }
  /// By its own length.
  static Scalar by_rod() noexcept { return Scalar(-1); }
};

}  // namespace paracal::closure
