#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "paracal/mechanism/limb_closure.hpp"
#include "paracal/mechanism/machine.hpp"

namespace paracal {

/// Where the plate really is: the seven unknowns of the loop closure (six without a slide, which stays 0).
///
///   position  r, mm, of O' in the base frame {O}
///   tilt      (tilt_x, tilt_y, tilt_z), rad: R = Rot(x, tilt_x) Rot(y, tilt_y) Rot(z, tilt_z)   [huang2016, Eq. (1)]
///   slide     s, mm
template <typename Scalar>
struct BasicPlateState {
  Vector3<Scalar> position = Vector3<Scalar>::Zero();
  Vector3<Scalar> tilt = Vector3<Scalar>::Zero();
  Scalar slide = Scalar(0);
};
using PlateState = BasicPlateState<double>;

/// What of it a controller commands.
inline Pose pose_of(const Machine& machine, const PlateState& plate) {
  Pose pose{plate.position, machine.rotation_of(plate.slide)};
  if (!machine.is_level) pose.tilt = plate.tilt;
  return pose;
}

/// Where the plate of a machine without errors stands at a pose.
inline PlateState plate_at(const Machine& machine, const Pose& pose) {
  return {pose.position, pose.tilt, machine.slide_of(pose.rotation)};
}

/// R of the plate, and the axes about which its three angles turn, as columns, both in {O}:
/// dR p = (axes.col(k) x R p) d(tilt_k).
template <typename Scalar>
struct PlateRotation {
  Matrix3<Scalar> matrix;
  Matrix3<Scalar> axes;
};

template <typename Scalar>
PlateRotation<Scalar> plate_rotation(const Vector3<Scalar>& tilt) {
  using std::cos, std::sin;
  const ArmDirection<Scalar> a{cos(tilt.x()), sin(tilt.x())}, b{cos(tilt.y()), sin(tilt.y())};
  const PlateColumns<Scalar> columns = plate_columns(a, b, {cos(tilt.z()), sin(tilt.z())});
  const auto& [x, y, z] = columns;
  PlateRotation<Scalar> rotation;
  rotation.matrix << x[0], y[0], z[0],  //
      x[1], y[1], z[1],                 //
      x[2], y[2], z[2];
  rotation.axes << Scalar(1), Scalar(0), z[0],  //
      Scalar(0), a.cosine, z[1],                //
      Scalar(0), a.sine, z[2];
  return rotation;
}

/// The elbow of one limb at a joint coordinate, in {O}, mm.
///
///   arm, arm_normal  u_1, v_1
///   lever            C - b, from the base joint to the elbow
///   half             half the short side of the parallelogram there, (c_c / 2) R_0 R_1 R_2 e_3
///   joint[j]         where rod j is hinged: C + sgn(j) half, from O
///   rod[j]           how long it is
template <typename Scalar>
struct Elbow {
  Vector3<Scalar> arm;
  Vector3<Scalar> arm_normal;
  Vector3<Scalar> lever;
  Vector3<Scalar> half;
  std::array<Vector3<Scalar>, 2> joint;
  std::array<Scalar, 2> rod;
};

template <typename Scalar>
constexpr std::size_t rod_count(const BasicLimb<Scalar>& limb) {
  return limb.actuator.rods;
}

template <typename Scalar>
Elbow<Scalar> elbow_of(const BasicLimb<Scalar>& limb, const Scalar& joint) {
  const ArmDirections<Scalar> direction = arm_directions(limb, joint);
  if (limb.has_one_rod()) {
    const Vector3<Scalar> none = Vector3<Scalar>::Zero(), lever = elbow_lever(limb, joint, direction);
    const Vector3<Scalar> hinge = limb.base + lever;
    return {direction.u1, direction.v1, lever, none, {hinge, hinge}, rods_at(limb, joint)};
  }
  const Vector3<Scalar> half = (Scalar(0.5) * limb.elbow_width) * limb.elbow_frame.col(2);
  Elbow<Scalar> elbow;
  elbow.arm = direction.u1;
  elbow.arm_normal = direction.v1;
  elbow.half = half.x() * direction.u1 + half.y() * direction.v1 + half.z() * limb.frame.col(2);
  elbow.lever = elbow_lever(limb, joint, direction);
  const Vector3<Scalar> centre = limb.base + elbow.lever;
  elbow.joint = {centre + elbow.half, centre - elbow.half};
  elbow.rod = limb.rod;
  return elbow;
}

/// Motion of the hinge of rod j at the elbow per rad or mm of the joint: w_0 x (its place - b), or gain v_1 along a
/// rail.
inline Eigen::Vector3d hinge_motion(const Limb& limb, const Elbow<double>& elbow, std::size_t j) {
  if (runs_on_rail(limb.actuator)) return limb.gain * elbow.arm_normal;
  return limb.frame.col(2).cross(elbow.joint[j] - limb.base);
}

/// Where the rods of one limb are hinged on the plate, from O', in the plate frame, mm:
/// a_i + mu_i s shat + sgn(j) (c_a / 2) R_3 e_3; a_i of a limb with one rod.
template <typename Scalar>
std::array<Vector3<Scalar>, 2> plate_joints(const BasicMachine<Scalar>& machine, const BasicLimb<Scalar>& limb,
                                            const Scalar& slide) {
  if (limb.has_one_rod()) return {limb.plate, limb.plate};
  const Vector3<Scalar> centre = limb.plate + (limb.slide_sign * slide) * machine.slide_axis.template cast<Scalar>();
  const Vector3<Scalar> half = (Scalar(0.5) * limb.plate_width) * limb.plate_frame.col(2);
  return {centre + half, centre - half};
}

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
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const BasicLimb<Scalar>& limb = machine.limbs[i];
    const Elbow<Scalar> elbow = elbow_of(limb, joints[i]);
    const std::array<Vector3<Scalar>, 2> hinges = plate_joints(machine, limb, plate.slide);
    for (std::size_t j = 0; j < rod_count(limb); ++j, ++row) {
      const Vector3<Scalar> rod = plate.position + rotation * hinges[j] - elbow.joint[j];
      residuals(row) = rod.norm() - elbow.rod[j];
    }
  }
  return residuals;
}

}  // namespace paracal
