#pragma once

#include "paracal/mechanism/drives/rail.hpp"

namespace paracal::closure {

/// A rod that extends from C = b to the length  s = q / joint_per_mm + joint_offset. Its drive is a length, as that of
/// a rail.
template <typename Scalar>
struct StrutDrive : RailDrive<Scalar> {
  /// It reaches any plate joint, d from b.
  static ArmDirection<Scalar> close(const ClosureLimb<Scalar>&, const Vector<Scalar>& d) noexcept {
    using std::sqrt;
    return {Scalar(1), sqrt(dot(d, d))};
  }

  static ClosedElbow<Scalar> elbow(const ClosureLimb<Scalar>& limb, const ArmDirection<Scalar>&) noexcept {
    return {limb.radial, limb.normal, limb.base};
  }
  static const Scalar& length(const ClosureLimb<Scalar>&, const ArmDirection<Scalar>& arm, std::size_t) noexcept {
    return arm.sine;
  }

  static Scalar rod_by_joint(const ClosureLimb<Scalar>& limb, const Vector<Scalar>&, const Vector<Scalar>&) noexcept {
    return -(Scalar(1) / limb.joint_per_mm);
  }

  // As of ArmDrive.
  static Levers<Scalar> levers(const ClosureLimb<Scalar>&, const ArmDirection<Scalar>&) noexcept {
    return {Scalar(0), Scalar(0)};
  }
  static Scalar by_place(const Levers<Scalar>&, const Vector<Scalar>&, const ClosedElbow<Scalar>&) noexcept {
    return Scalar(-1);
  }
  static Scalar by_arm(const Vector<Scalar>&, const ClosedElbow<Scalar>&) noexcept { return Scalar(0); }
  static Scalar by_rod() noexcept { return Scalar(0); }
};

}  // namespace paracal::closure
