#pragma once

#include "paracal/mechanism/pose.hpp"

namespace paracal {

/// How far a pose is off, relative to home, as in [huang2016, Tables 3 and 5]; what a tracker sees without knowing the
/// robot's frame.
struct PoseError {
  double distance = 0.0;    ///< d_rho: change of the distance to home, mm
  double volumetric = 0.0;  ///< d_v = |dr - dr_home|, mm
  double rotation = 0.0;    ///< d_phi = dphi - dphi_home, rad
};

/// A pose as meant and as it came out, both in the robot's frame.
struct PosePair {
  Pose meant;
  Pose actual;
};

PoseError error_relative_to(const PosePair& home, const PosePair& pose);

}  // namespace paracal
