#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>

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
  const auto turn = [&](int axis) { return closure::turn_by_any<Scalar>(tilt(axis)); };
  const closure::TurnedPlate<Scalar> plate = closure::turned_plate(turn(0), turn(1), turn(2));
  PlateRotation<Scalar> rotation;
  rotation.matrix << as_eigen(plate.x), as_eigen(plate.y), as_eigen(plate.z);
  rotation.axes << as_eigen(plate.axes[0]), as_eigen(plate.axes[1]), as_eigen(plate.axes[2]);
  return rotation;
}

}  // namespace paracal
