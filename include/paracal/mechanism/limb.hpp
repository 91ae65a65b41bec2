#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "paracal/mechanism/drive_curve.hpp"
#include "paracal/mechanism/limb_closure.hpp"
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
///   actuator           revolute, crank:   C = b + L u_1(q), an arm of length L that the joint turns;
///                      linear, carriage:  C = b - L u_1 + (gain q + joint_offset) v_1, a carriage on a rail along
///                                         v_1 whose arm points inward (linear) or has none (carriage)
///                      strut:             C = b, from which the rod extends: l = l_1 + gain q + joint_offset
///   base      b_i      base joint B_i in the base frame {O}; of a rail: where the carriage stands at q = 0
///   frame     R_0,i    columns u_0, v_0, w_0 in {O}: radial, vertical (along the rail), actuator axis (tangent); of
///                      limbs with one rod see frame_of()
///   arm       L_i      arm (proximal link) from B_i, or from the carriage, to the elbow C_i
///   joint_offset       added to the commanded joint coordinate, rad or mm
///   turn               the joint is at q + turn.off(q) for q commanded, which all lines above mean
///   gain               mm of extension of a strut, or travel of a carriage, per mm of its joint coordinate
///   elbow_frame R_2,i  short side of the parallelogram at the elbow, relative to the arm
///   elbow_width c_c,i  its length
///   plate     a_i      plate joint A_i in the plate frame {O'}
///   plate_frame R_3,i  short side at the plate, relative to {O'}
///   plate_width c_a,i  its length
///   rod       l_1,i, l_2,i; of limbs with one rod its length twice, of a strut at joint coordinate 0
///   slide_sign mu_i    how the slide of an articulated plate moves A_i; 0 for a rigid plate
///   radial             nominal (cos gamma, sin gamma, 0), or u_0: the axis about which alpha0 and alpha3 turn
///   sideways           nominal w_0, along which a carriage's rail stands off by `across`
///   ahead              +1 where a carriage stands ahead of the plate joint along its rail, -1 behind
template <typename Scalar>
struct BasicLimb {
  Actuator actuator = Actuator::revolute;
  Vector3<Scalar> base;
  Matrix3<Scalar> frame;
  Scalar arm;
  Scalar joint_offset;
  Scalar gain = Scalar(1);
  TurnCurve<Scalar> turn = {};
  Matrix3<Scalar> elbow_frame;
  Scalar elbow_width;
  Vector3<Scalar> plate;
  Matrix3<Scalar> plate_frame;
  Scalar plate_width;
  std::array<Scalar, 2> rod;
  double slide_sign;
  Eigen::Vector3d radial;
  Eigen::Vector3d sideways = Eigen::Vector3d::Zero();
  double ahead = 1.0;

  /// Length of the rod that would replace the pair along the centre line C_i A_i.
  Scalar mean_rod() const { return Scalar(0.5) * (rod[0] + rod[1]); }
  bool is_strut() const { return actuator.drive == Drive::strut; }
  bool has_one_rod() const { return on_single_rods(actuator); }
};
using Limb = BasicLimb<double>;

/// Position of the arm: the direction u_1 of the arm, its normal v_1, and both seen from the base frame.
template <typename Scalar>
struct ArmDirections {
  Vector3<Scalar> u1;
  Vector3<Scalar> v1;
};

/// u_1 = cos(th) u_0 + sin(th) v_0,  v_1 = -sin(th) u_0 + cos(th) v_0,  th = commanded joint + offset. A
/// carriage does not rotate and a strut has no arm: u_1 = u_0, v_1 = v_0.
template <typename Scalar>
ArmDirections<Scalar> arm_directions(const BasicLimb<Scalar>& limb, Scalar joint) {
  using std::cos, std::sin;
  if (!swings_arm(limb.actuator)) return {limb.frame.col(0), limb.frame.col(1)};
  const Scalar angle = limb.turn.actual(joint) + limb.joint_offset;
  const Scalar c = cos(angle);
  const Scalar s = sin(angle);
  return {c * limb.frame.col(0) + s * limb.frame.col(1), c * limb.frame.col(1) - s * limb.frame.col(0)};
}

/// C_i - b_i: from the base joint to the elbow, in {O}, mm.
template <typename Scalar>
Vector3<Scalar> elbow_lever(const BasicLimb<Scalar>& limb, Scalar joint, const ArmDirections<Scalar>& direction) {
  if (limb.is_strut()) return Vector3<Scalar>::Zero();
  if (runs_on_rail(limb.actuator)) {
    return (limb.gain * limb.turn.actual(joint) + limb.joint_offset) * direction.v1 - limb.arm * direction.u1;
  }
  return limb.arm * direction.u1;
}

/// How far turn_sine and turn_cosine, as far as 1, move the drive: as its joint zero would by so much.
inline std::array<double, 2> by_harmonics(const Limb& limb, double joint) {
  const double angle = limb.turn.turning * joint;
  return {limb.gain * std::sin(angle), limb.gain * std::cos(angle)};
}

/// mm that the elbow moves, or the strut grows, per rad or mm of the joint: L, or 1 where it is a length itself.
inline double joint_ratio(const Limb& limb) { return swings_arm(limb.actuator) ? limb.arm : 1.0; }

/// Length of each rod at a joint coordinate, mm.
template <typename Scalar>
std::array<Scalar, 2> rods_at(const BasicLimb<Scalar>& limb, const Scalar& joint) {
  if (!limb.is_strut()) return limb.rod;
  const Scalar length = limb.rod[0] + limb.gain * limb.turn.actual(joint) + limb.joint_offset;
  return {length, length};
}

/// The arm that puts the elbow one (mean) rod away from a point, elbow outward.
///
/// @param joint_at_plate  A_i in the base frame, mm.
/// @returns its direction, of any length; NaN when out of reach.
/// Real-time: yes (no allocation, no exception, no loop).
inline ArmDirection<double> close_triangle(const Limb& limb, const Eigen::Vector3d& joint_at_plate) noexcept {
  const Eigen::Vector3d d = joint_at_plate - limb.base;
  return close_triangle(ArmReach<double>{.radial = d.dot(limb.frame.col(0)),
                                         .normal = d.dot(limb.frame.col(1)),
                                         .square = d.squaredNorm(),
                                         .arm = limb.arm,
                                         .rod = limb.mean_rod()});
}

/// The carriage that is one (mean) rod away from a point, above the plate; or ahead of it, or behind, which is ahead on
/// the rail that leads the other way.
///
/// @returns its place with its offset, mm; NaN when out of reach. Real-time: yes.
inline double close_on_rail(const Limb& limb, const Eigen::Vector3d& joint_at_plate) noexcept {
  const Eigen::Vector3d d = limb.frame.transpose() * (joint_at_plate - limb.base);
  return limb.ahead * close_on_rail(RailReach<double>{d.x(), limb.ahead * d.y(), d.z(), limb.arm, limb.mean_rod()});
}

/// Joint coordinate of a limb.
struct JointSolution {
  double joint;  ///< rad or mm; as commanded (offset removed); NaN when out of reach
  bool reached;
};

inline JointSolution solution(double joint) noexcept { return {joint, std::isfinite(joint)}; }

inline JointSolution arm_along(const Limb& limb, const ArmDirection<double>& direction) noexcept {
  return solution(limb.turn.commanded(std::atan2(direction.sine, direction.cosine) - limb.joint_offset));
}

/// The joint coordinate of a drive with a gain that stands at a place, offset included.
inline JointSolution driven_to(const Limb& limb, double place) noexcept {
  return solution(limb.turn.commanded((place - limb.joint_offset) / limb.gain));
}

/// Joint coordinate that puts the elbow one (mean) rod away from a point; a strut reaches any.
inline JointSolution solve_joint(const Limb& limb, const Eigen::Vector3d& joint_at_plate) noexcept {
  switch (limb.actuator.drive) {
    case Drive::strut:
      return driven_to(limb, (joint_at_plate - limb.base).norm() - limb.rod[0]);
    case Drive::rail:
      return driven_to(limb, close_on_rail(limb, joint_at_plate));
    default:
      return arm_along(limb, close_triangle(limb, joint_at_plate));
  }
}

}  // namespace paracal
