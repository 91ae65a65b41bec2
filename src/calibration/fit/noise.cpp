#include "paracal/calibration/noise.hpp"

namespace paracal {

Eigen::Matrix3d whitening(const TrackerModel& tracker, const Eigen::Vector3d& point) {
  const double metres = 1e-3 * point.norm();
  const Eigen::Vector3d beam = point.normalized();
  const Eigen::Matrix3d along = beam * beam.transpose();
  return along / (tracker.radial + tracker.radial_per_m * metres) +
         (Eigen::Matrix3d::Identity() - along) / (tracker.transverse + tracker.transverse_per_m * metres);
}

}  // namespace paracal
