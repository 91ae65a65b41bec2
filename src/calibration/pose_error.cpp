#include "paracal/calibration/pose_error.hpp"

namespace paracal {

PoseError error_relative_to(const PosePair& home, const PosePair& pose) {
  const Eigen::Vector3d meant = pose.meant.position - home.meant.position;
  const Eigen::Vector3d actual = pose.actual.position - home.actual.position;
  const double turned = pose.actual.rotation - pose.meant.rotation;
  const double home_turned = home.actual.rotation - home.meant.rotation;
  return {actual.norm() - meant.norm(), (actual - meant).norm(), turned - home_turned};
}

}  // namespace paracal
