#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "paracal/mechanism/pose.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

template <typename Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
template <typename Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

/// One limb as built: an actuator that places the elbow C_i, and a parallelogram of two rods down to the plate. The
/// members are the constants of the loop closure [huang2016, Eq. (1)], errors included; lengths in mm.
///
///   actuator           revolute: C = b + L u_1(q), an arm of length L that the joint turns;
///                      linear:   C = b - L u_1 + q v_1, a carriage on a rail along v_1 whose arm points inward
///   base      b_i      base joint B_i in the base frame {O}; of a rail: where the carriage stands at q = 0
///   frame     R_0,i    columns u_0, v_0, w_0 in {O}: radial, vertical (along the rail), actuator axis (tangent)
///   arm       L_i      arm (proximal link) from B_i, or from the carriage, to the elbow C_i
///   joint_offset       added to the believed joint coordinate, rad or mm
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
  Actuator actuator = Actuator::revolute;
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

/// u_1 = cos(th) u_0 + sin(th) v_0,  v_1 = -sin(th) u_0 + cos(th) v_0,  th = believed joint + offset; a carriage does
/// not turn: u_1 = u_0, v_1 = v_0.
template <typename Scalar>
ArmDirections<Scalar> arm_directions(const BasicLimb<Scalar>& limb, Scalar joint) {
  using std::cos, std::sin;
  if (limb.actuator == Actuator::linear) return {limb.frame.col(0), limb.frame.col(1)};
  const Scalar c = cos(joint + limb.joint_offset);
  const Scalar s = sin(joint + limb.joint_offset);
  return {c * limb.frame.col(0) + s * limb.frame.col(1), c * limb.frame.col(1) - s * limb.frame.col(0)};
}

/// C_i - b_i: from the base joint to the elbow, in {O}, mm.
template <typename Scalar>
Vector3<Scalar> elbow_lever(const BasicLimb<Scalar>& limb, Scalar joint, const ArmDirections<Scalar>& direction) {
  if (limb.actuator == Actuator::linear) return (joint + limb.joint_offset) * direction.v1 - limb.arm * direction.u1;
  return limb.arm * direction.u1;
}

/// mm that the elbow moves per rad or mm of its joint: L, or 1 on a rail.
inline double joint_ratio(const Limb& limb) { return limb.actuator == Actuator::linear ? 1.0 : limb.arm; }

/// (A^2 + B^2) (cos(th), sin(th)) with A cos(th) + B sin(th) = K; of the two roots the one with the larger cosine. One
/// square root and no division, since only the direction of the arm matters.
/// @returns NaN without a root. Real-time: yes (no allocation, no exception, no loop).
inline Eigen::Vector2d outward_direction(double a, double b, double k) noexcept {
  const double w = std::copysign(std::sqrt(a * a + b * b - k * k), -b);
  return {a * k - b * w, b * k + a * w};
}

/// Closes the triangle of arm and rod on the centre line of a limb, in closed form: the arm that puts the elbow one
/// (mean) rod away from a point.
///
///   |d - L u_1(th)| = l   <=>   A cos(th) + B sin(th) = K,
///   A = 2 L d.u_0,  B = 2 L d.v_0,  K = d.d + L^2 - l^2,  d = joint_at_plate - b_i.
///
/// Of the two roots it takes the working mode with the elbow outward: the larger u_1.u_0.
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
  return outward_direction(a, b, k);
}

/// Closes the same triangle where the elbow runs along a rail: the carriage one (mean) rod away from a point.
///
///   |d - q v_1| = l   <=>   q = d.v_1 + sqrt(l^2 - (d.u_1)^2 - (d.w_0)^2),   d = joint_at_plate - (b_i - L u_1)
///
/// Of the two roots it takes the carriage above the plate.
///
/// @returns q with its offset, mm; NaN when out of reach. Real-time: yes.
inline double close_on_rail(const Limb& limb, const Eigen::Vector3d& joint_at_plate) noexcept {
  const Eigen::Vector3d d = limb.frame.transpose() * (joint_at_plate - limb.base);
  const double rod = limb.mean_rod(), radial = d.x() + limb.arm;
  return d.y() + std::sqrt(rod * rod - radial * radial - d.z() * d.z());
}

/// Joint coordinate of a limb.
struct JointSolution {
  double joint;  ///< rad or mm; as the controller believes it (offset removed); NaN when out of reach
  bool reached;
};

/// @param place  where the joint stands, offset included.
inline JointSolution believed_joint(const Limb& limb, double place) noexcept {
  const double joint = place - limb.joint_offset;
  return {joint, std::isfinite(joint)};
}

/// @param direction  (cos(th), sin(th)) times any positive factor.
inline JointSolution arm_along(const Limb& limb, const Eigen::Vector2d& direction) noexcept {
  return believed_joint(limb, std::atan2(direction.y(), direction.x()));
}

/// Joint coordinate that puts the elbow one (mean) rod away from a point.
inline JointSolution solve_joint(const Limb& limb, const Eigen::Vector3d& joint_at_plate) noexcept {
  if (limb.actuator == Actuator::linear) return believed_joint(limb, close_on_rail(limb, joint_at_plate));
  return arm_along(limb, close_triangle(limb, joint_at_plate));
}

}  // namespace paracal
