#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "paracal/mechanism/pose.hpp"

namespace paracal {

template <typename Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
template <typename Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

/// One limb as built: an actuated revolute joint at the base, an arm, and a parallelogram of two rods down to the
/// plate. The members are the constants of the loop closure [huang2016, Eq. (1)], errors included; lengths in mm.
///
///   base      b_i      base joint B_i in the base frame {O}
///   frame     R_0,i    columns u_0, v_0, w_0 in {O}: radial, vertical, actuator axis
///   arm       L_i      arm (proximal link) from B_i to the elbow C_i
///   joint_offset       added to the believed joint coordinate, rad
///   elbow_frame R_2,i  short side of the parallelogram at the elbow, relative to the arm
///   elbow_width c_c,i  its length
///   plate     a_i      plate joint A_i in the plate frame {O'}
///   plate_frame R_3,i  short side at the plate, relative to {O'}
///   plate_width c_a,i  its length
///   rod       l_1,i, l_2,i
///   slide_sign mu_i    how the slide of an articulated plate moves A_i; 0 for a rigid plate
///   radial             nominal (cos gamma, sin gamma, 0): the axis about which alpha0 and alpha3 turn
template <typename Scalar>
struct BasicLimb {
  Vector3<Scalar> base;
  Matrix3<Scalar> frame;
  Scalar arm;
  Scalar joint_offset;
  Matrix3<Scalar> elbow_frame;
  Scalar elbow_width;
  Vector3<Scalar> plate;
  Matrix3<Scalar> plate_frame;
  Scalar plate_width;
  std::array<Scalar, 2> rod;
  double slide_sign;
  Eigen::Vector3d radial;

  /// Length of the rod that would replace the pair along the centre line C_i A_i.
  Scalar mean_rod() const { return Scalar(0.5) * (rod[0] + rod[1]); }
};
using Limb = BasicLimb<double>;

/// Where the arm stands: the direction u_1 of the arm, its normal v_1, and both seen from the base frame.
template <typename Scalar>
struct ArmDirections {
  Vector3<Scalar> u1;
  Vector3<Scalar> v1;
};

/// u_1 = cos(th) u_0 + sin(th) v_0,  v_1 = -sin(th) u_0 + cos(th) v_0,  th = believed joint + offset.
template <typename Scalar>
ArmDirections<Scalar> arm_directions(const BasicLimb<Scalar>& limb, Scalar joint) {
  using std::cos, std::sin;
  const Scalar c = cos(joint + limb.joint_offset);
  const Scalar s = sin(joint + limb.joint_offset);
  return {c * limb.frame.col(0) + s * limb.frame.col(1), c * limb.frame.col(1) - s * limb.frame.col(0)};
}

/// Closes the triangle of arm and rod on the centre line of a limb, in closed form: the arm that puts the elbow one
/// (mean) rod away from a point.
///
///   |d - L u_1(th)| = l   <=>   A cos(th) + B sin(th) = K,
///   A = 2 L d.u_0,  B = 2 L d.v_0,  K = d.d + L^2 - l^2,  d = joint_at_plate - b_i.
///
/// Of the two roots it takes the working mode with the elbow outward: the larger u_1.u_0.
/// One square root and no division, since only the direction of the arm matters.
///
/// @param joint_at_plate  A_i in the base frame, mm.
/// @returns (A^2 + B^2) (cos(th), sin(th)); NaN when out of reach.
/// Real-time: yes (no allocation, no exception, no loop).
inline Eigen::Vector2d close_triangle(const Limb& limb, const Eigen::Vector3d& joint_at_plate) noexcept {
  const Eigen::Vector3d d = joint_at_plate - limb.base;
  const double diameter = 2.0 * limb.arm;
  const double a = diameter * d.dot(limb.frame.col(0));
  const double b = diameter * d.dot(limb.frame.col(1));
  const double rod = limb.mean_rod();
  const double k = d.squaredNorm() + limb.arm * limb.arm - rod * rod;
  const double w = std::copysign(std::sqrt(a * a + b * b - k * k), -b);
  return {a * k - b * w, b * k + a * w};
}

/// Joint coordinate of an arm.
struct ArmSolution {
  double joint;  ///< rad; as the controller believes it (offset removed); NaN when out of reach
  bool reached;
};

/// @param direction  (cos(th), sin(th)) times any positive factor.
inline ArmSolution arm_along(const Limb& limb, const Eigen::Vector2d& direction) noexcept {
  const double joint = std::atan2(direction.y(), direction.x()) - limb.joint_offset;
  return {joint, std::isfinite(joint)};
}

/// Joint coordinate that puts the elbow one (mean) rod away from a point.
inline ArmSolution solve_arm(const Limb& limb, const Eigen::Vector3d& joint_at_plate) noexcept {
  return arm_along(limb, close_triangle(limb, joint_at_plate));
}

}  // namespace paracal
