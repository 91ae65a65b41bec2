#pragma once

#include <cstddef>
#include <vector>

#include "paracal/mechanism/machine.hpp"

namespace paracal {

/// Among x, y, z, tilt_x, tilt_y, tilt_z and phi, where k says tilt_z or, of a machine with a slide, phi.
inline std::size_t among_seven(const Machine& machine, std::size_t k) { return k == 5 && machine.has_slide() ? 6 : k; }

/// Coordinates that can be commanded: 0 to 5 of x, y, z, tilt_x, tilt_y and tilt_z or, of a machine with a slide, phi.
inline std::vector<std::size_t> commanded_coordinates(const Machine& machine) {
  std::vector<std::size_t> commanded;
  for (std::size_t k = 0; k < machine.freedoms.free.size(); ++k) {
    if (among_seven(machine, k) == 6 || machine.freedoms.free.at(k)) commanded.push_back(k);
  }
  return commanded;
}

/// One of them, mm or rad.
inline double& coordinate(Pose& pose, const Machine& machine, std::size_t k) {
  if (among_seven(machine, k) == 6) return pose.rotation;
  const auto axis = static_cast<Eigen::Index>(k);
  return k < 3 ? pose.position(axis) : pose.tilt(axis - 3);
}

}  // namespace paracal
