#pragma once

#include <Eigen/Core>
#include <optional>

#include "paracal/units.hpp"

namespace paracal {

/// Standard deviations of a laser tracker that stands at the origin of its frame, mm at a range of `range` mm:
///
///   across the beam  transverse + transverse_per_m * range / 1000
///   along the beam   radial + radial_per_m * range / 1000
///
/// The defaults are the maximum permissible errors of a Leica AT500 [leica-at500]; typical is half of them.
struct TrackerModel {
  double transverse = 0.015, transverse_per_m = 0.006;
  double radial = 0.010, radial_per_m = 0.0003;
};

/// Standard deviations of readings that state none of their own. Where the reading and the instrument state
/// none, the scatter of the residuals decides, and these values only set the proportion of lengths to angles.
struct NoiseModel {
  double distance = 0.05;             ///< mm, of a ball bar, too: positioning repeatability in [huang2016, section 5.2]
  double height = 0.05;               ///< mm, of a dial, too: a probe that triggers within some hundredths
  double point = 0.017;               ///< mm a coordinate: one third of it, read as 3 sigma
  double body = 0.3;                  ///< mm a coordinate of a body's origin: motion capture scatters by some tenths
  double rotation = to_radians(0.3);  ///< rad: rotational repeatability in the same section; of orientations, too
  std::optional<TrackerModel> tracker = {};
  /// Standard deviation of an error that all distances share, mm (a calliper's zero, a thick printed wall). The same
  /// for all lengths of a ball bar (its own length). 0: none.
  double distance_bias = 0.0;
  /// Standard deviation of the angles by which a dial is set up askew, about either axis across it, rad; empty: half a
  /// degree, which is then assumed.
  std::optional<double> dial_angle = {};
  /// Standard deviation of each joint of a station, rad or mm, where limbs are more than degrees of freedom: by how
  /// much these joints disagree is then a reading, too. Small against what the instrument reads. 0: joints say where
  /// the plate is, and no more.
  double joint = 0.0;
};

/// W with W^T W = inverse covariance of a point read by the tracker: (1/radial) u u^T + (1/transverse) (I - u u^T).
/// @param point  in the tracker's frame, mm; u is its direction.
Eigen::Matrix3d whitening(const TrackerModel& tracker, const Eigen::Vector3d& point);

}  // namespace paracal
