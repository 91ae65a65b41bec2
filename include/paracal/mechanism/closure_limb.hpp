#pragma once

#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/machine_closure.hpp"

namespace paracal {

template <typename Scalar>
ClosureVector<Scalar> closure_vector(const Vector3<Scalar>& v) {
  return {v.x(), v.y(), v.z()};
}

/// A limb of a machine as its closure needs it. Real-time: yes.
template <typename Scalar>
ClosureLimb<Scalar> closure_limb(const BasicMachine<Scalar>& machine, std::size_t number) {
  const BasicLimb<Scalar>& limb = machine.limbs[number];
  const Eigen::Vector3d slide = limb.slide_sign * machine.pinion_radius * machine.slide_axis;
  ClosureLimb<Scalar> closure;
  closure.base = closure_vector<Scalar>(limb.base);
  closure.radial = closure_vector<Scalar>(limb.frame.col(0));
  closure.normal = closure_vector<Scalar>(limb.frame.col(1));
  closure.axis = closure_vector<Scalar>(limb.frame.col(2));
  closure.plate = closure_vector<Scalar>(limb.plate);
  closure.slide = {Scalar(slide.x()), Scalar(slide.y()), Scalar(slide.z())};
  closure.rod = limb.rod;
  closure.arm = limb.arm;
  closure.joint_offset = limb.joint_offset;
  if (limb.is_strut()) closure.joint_offset += limb.rod[0];
  closure.joint_per_mm = Scalar(1.0) / limb.gain;
  closure.drive = Scalar(static_cast<int>(limb.actuator.drive));
  closure.ahead = Scalar(limb.ahead);
  closure.rods = Scalar(limb.actuator.rods);
  if (!limb.has_one_rod()) {
    closure.elbow_half = closure_vector<Scalar>(Scalar(0.5) * limb.elbow_width * limb.elbow_frame.col(2));
    closure.plate_half = closure_vector<Scalar>(Scalar(0.5) * limb.plate_width * limb.plate_frame.col(2));
  }
  return closure;
}

/// What can be commanded besides x, y and z on limbs with two rods: one angle of the plate, or its slide.
inline std::size_t fourth_coordinate(const Machine& machine) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (machine.freedoms.free[3 + k]) return k;
  }
  return closure::kSlide;
}

/// The balance of its rods can be found by closure::settle: as many limbs as coordinates, which are x, y, z and at most
/// a fourth.
inline bool can_settle(const Machine& machine) {
  const auto& free = machine.freedoms.free;
  const bool has_room = machine.limb_count == 3 || machine.limb_count == 4;
  return has_room && machine.spare_limbs() == 0 && free[0] && free[1] && free[2];
}

template <std::size_t N, typename Scalar = double>
ClosureLimbs<Scalar, N> closure_limbs(const Machine& machine) {
  ClosureLimbs<Scalar, N> limbs;
  for (std::size_t i = 0; i < N; ++i) limbs[i] = limb_of<Scalar>(numbers_of(closure_limb(machine, i)));
  return limbs;
}

template <typename Scalar = double>
ClosurePose<Scalar> closure_pose(const Pose& pose) {
  return {static_cast<Scalar>(pose.position.x()), static_cast<Scalar>(pose.position.y()),
          static_cast<Scalar>(pose.position.z()), static_cast<Scalar>(pose.rotation),
          static_cast<Scalar>(pose.tilt.x()),     static_cast<Scalar>(pose.tilt.y()),
          static_cast<Scalar>(pose.tilt.z())};
}

}  // namespace paracal
