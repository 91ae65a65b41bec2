#pragma once

#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/machine_closure.hpp"

namespace paracal {

template <typename Scalar>
ClosureVector<Scalar> closure_vector(const Eigen::Vector3d& v) {
  return {static_cast<Scalar>(v.x()), static_cast<Scalar>(v.y()), static_cast<Scalar>(v.z())};
}

/// A limb of a machine as its closure needs it, rounded to Scalar last. Real-time: yes.
template <typename Scalar = double>
ClosureLimb<Scalar> closure_limb(const Machine& machine, std::size_t number) {
  const Limb& limb = machine.limbs[number];
  const auto rounded = [](const Eigen::Vector3d& v) { return closure_vector<Scalar>(v); };
  ClosureLimb<Scalar> closure;
  closure.base = rounded(limb.base);
  closure.radial = rounded(limb.frame.col(0));
  closure.normal = rounded(limb.frame.col(1));
  closure.axis = rounded(limb.frame.col(2));
  closure.plate = rounded(limb.plate);
  closure.slide = rounded(limb.slide_sign * machine.pinion_radius * machine.slide_axis);
  closure.rod = {static_cast<Scalar>(limb.rod[0]), static_cast<Scalar>(limb.rod[1])};
  closure.arm = static_cast<Scalar>(limb.arm);
  closure.joint_offset = static_cast<Scalar>(limb.joint_offset + (limb.is_strut() ? limb.rod[0] : 0.0));
  closure.joint_per_mm = static_cast<Scalar>(1.0 / limb.gain);
  closure.drive = static_cast<Scalar>(static_cast<int>(limb.actuator.drive));
  closure.ahead = static_cast<Scalar>(limb.ahead);
  closure.rods = static_cast<Scalar>(limb.actuator.rods);
  if (!limb.has_one_rod()) {
    closure.elbow_half = rounded(0.5 * limb.elbow_width * limb.elbow_frame.col(2));
    closure.plate_half = rounded(0.5 * limb.plate_width * limb.plate_frame.col(2));
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
  for (std::size_t i = 0; i < N; ++i) limbs[i] = closure_limb<Scalar>(machine, i);
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
