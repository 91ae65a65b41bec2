#pragma once

#include "paracal/mechanism/limb_closure.hpp"

namespace paracal::closure {

/// A carriage on a rail along v_0, with an arm that points inward, or none:
/// C = b - L u_0 + s v_0,  s = q / joint_per_mm + joint_offset.
template <typename Scalar>
struct RailDrive {
  static constexpr bool is_length = true;  ///< its joint coordinate is a length, mm

  static ArmDirection<Scalar> at(const Scalar& travel) noexcept { return {Scalar(1), travel}; }
  static const Scalar& place_of(const ArmDirection<Scalar>& arm) noexcept { return arm.sine; }

  /// The carriage that is one rod away from the plate joint, d from b: above it, or ahead of it or behind.
  ///
  ///   |d + L u_0 - s v_0| = l  <=>  s = d.v_0 +- sqrt(l^2 - (d.u_0 + L)^2 - (d.w_0)^2)
  static ArmDirection<Scalar> close(const ClosureLimb<Scalar>& limb, const Vector<Scalar>& d) noexcept {
    using std::sqrt;
    const Scalar radial = dot(d, limb.radial) + limb.arm, axial = dot(d, limb.axis), rod = mean_rod(limb);
    const Scalar travel = limb.ahead * dot(d, limb.normal) + sqrt(rod * rod - radial * radial - axial * axial);
    return {Scalar(1), limb.ahead * travel};
  }

  static ClosedElbow<Scalar> elbow(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>& arm) noexcept {
    return {limb.radial, limb.normal, sum(sum(limb.base, limb.radial, -limb.arm), limb.normal, arm.sine)};
  }
  static const Scalar& length(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>&, std::size_t rod) noexcept {
    return limb.rod[rod];
  }

  static Scalar rod_by_joint(const ClosureLimb<Scalar>& limb, const Vector<Scalar>& n,
                             const Vector<Scalar>& v1) noexcept {
    return -dot(n, v1) * (Scalar(1) / limb.joint_per_mm);
  }
  static ArmDirection<Scalar> moved(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>& arm,
                                    const Scalar& change) noexcept {
    return {arm.cosine, arm.sine + change / limb.joint_per_mm};
  }
  static const ArmDirection<Scalar>& of_unit_length(const ArmDirection<Scalar>& arm) noexcept { return arm; }

  // As of ArmDrive.
  static Levers<Scalar> levers(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>& arm) noexcept {
    return {-limb.arm, arm.sine};
  }
  static Scalar by_place(const Levers<Scalar>&, const Vector<Scalar>& n, const ClosedElbow<Scalar>& elbow) noexcept {
    return -dot(n, elbow.v1);
  }
  static Scalar by_arm(const Vector<Scalar>& n, const ClosedElbow<Scalar>& elbow) noexcept { return dot(n, elbow.u1); }
  static Scalar by_rod() noexcept { return Scalar(-1); }
};

}  // namespace paracal::closure
