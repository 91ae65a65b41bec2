#pragma once

#include <Eigen/Core>
#include <cmath>

#include "paracal/mechanism/drive_curve.hpp"
#include "paracal/mechanism/machine_closure.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

template <typename Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
template <typename Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

/// A vector of a closure as Eigen has it. @pre it lives on.
template <typename Scalar>
Eigen::Map<const Vector3<Scalar>> as_eigen(const ClosureVector<Scalar>& v) {
  return Eigen::Map<const Vector3<Scalar>>(v.data());
}

template <typename Scalar>
ClosureVector<Scalar> closure_vector(const Vector3<Scalar>& v) {
  return {v.x(), v.y(), v.z()};
}

/// One limb as built: the numbers of its closure, errors included, and what stands before it.
///
///   turn         the joint is at q + turn.off(q) for q commanded, which the closure means by q
///   slide_sign   mu_i: how the slide of an articulated plate moves the joint at the plate; 0 for a rigid plate
template <typename Scalar>
struct BasicLimb : ClosureLimb<Scalar> {
  Actuator actuator = Actuator::revolute;
  TurnCurve<Scalar> turn = {};
  double slide_sign = 0.0;

  void set_kind(Actuator kind) {
    actuator = kind;
    this->drive = Scalar(static_cast<int>(kind.drive));
    this->rods = Scalar(static_cast<int>(kind.rods));
  }
  /// Length of the rod that would replace the pair along the centre line C_i A_i.
  Scalar mean_rod() const { return Scalar(0.5) * (this->rod[0] + this->rod[1]); }
  /// mm of extension of a strut, or travel of a carriage, per mm of its joint coordinate; 1 of an arm.
  Scalar gain() const { return Scalar(1) / this->joint_per_mm; }
  /// R_0: columns u_0, v_0, w_0 in {O}.
  Matrix3<Scalar> frame() const {
    Matrix3<Scalar> frame;
    frame << as_eigen(this->radial), as_eigen(this->normal), as_eigen(this->axis);
    return frame;
  }
  bool is_strut() const { return actuator.drive == Drive::strut; }
  bool has_one_rod() const { return on_single_rods(actuator); }
};
using Limb = BasicLimb<double>;

/// The upper ends of its rods at a joint coordinate as commanded.
template <std::size_t Rods = 2, typename Scalar>
closure::UpperEnds<Scalar, Rods> ends_at(const BasicLimb<Scalar>& limb, const Scalar& joint) {
  return closure::upper_ends<Rods, Scalar>(limb, closure::arm_at<Scalar>(limb, limb.turn.actual(joint)));
}

/// How far turn_sine and turn_cosine, as far as 1, move the drive: as its joint zero would by so much.
inline std::array<double, 2> by_harmonics(const Limb& limb, double joint) {
  const double angle = limb.turn.turning * joint;
  return {limb.gain() * std::sin(angle), limb.gain() * std::cos(angle)};
}

/// mm that the elbow moves, or the strut grows, per rad or mm of the joint: L, or 1 where it is a length itself.
inline double joint_ratio(const Limb& limb) { return swings_arm(limb.actuator) ? limb.arm : 1.0; }

/// Joint coordinate, as commanded, that puts the elbow one (mean) rod away from a joint at the plate: elbow outward,
/// carriage above the plate, or ahead of it or behind where its limb says so. A strut reaches any.
///
/// @returns rad or mm; NaN when out of reach. Real-time: yes.
inline double joint_to(const Limb& limb, const Eigen::Vector3d& joint_at_plate) noexcept {
  const auto lever = closure_vector<double>(joint_at_plate - as_eigen(limb.base));
  return limb.turn.commanded(closure::joint_of<double>(limb, closure::close_limb<double>(limb, lever)));
}

}  // namespace paracal
