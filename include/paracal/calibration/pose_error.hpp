#pragma once

#include <map>
#include <optional>
#include <vector>

#include "paracal/calibration/length_kind.hpp"
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

/// Largest errors over many poses.
struct PoseErrorSummary {
  double max_abs_distance = 0.0;        ///< of d_rho, mm
  double rms_distance = 0.0;            ///< of d_rho, mm
  double max_volumetric = 0.0;          ///< of d_v, mm: depends on how the frames are aligned
  double max_volumetric_aligned = 0.0;  ///< mm: largest |dr| after the rigid motion that fits best has been removed
  bool reads_distances = true;          ///< the four above stand for readings; false: lengths alone were read
  std::map<LengthKind, double> rms_lengths = {};  ///< of the kinds that were read, mm
  std::optional<double> rms_joints = {};          ///< by which joints of spare limbs disagree, mm; empty: not readings
  std::optional<double> max_abs_rotation = {};    ///< of d_phi, rad; empty where no rotation was read
  std::optional<double> max_orientation = {};     ///< by which a body is turned away, rad; empty where none was read
};

/// @param pairs  home first. @param rotations  whether the actual rotations mean anything.
PoseErrorSummary summarize(const std::vector<PosePair>& pairs, bool rotations);

}  // namespace paracal
