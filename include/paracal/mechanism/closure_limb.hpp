#pragma once

#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/machine_closure.hpp"

namespace paracal {

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

/// A limb of a machine, rounded to Scalar last. Real-time: yes.
template <typename Scalar = double>
ClosureLimb<Scalar> closure_limb(const Machine& machine, std::size_t number) {
  return limb_of<Scalar>(numbers_of<double>(machine.limbs[number]));
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
