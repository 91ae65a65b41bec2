#include "paracal/calibration/pose_error.hpp"

#include <algorithm>
#include <cmath>

#include "paracal/numerics/rigid_fit.hpp"

namespace paracal {

PoseError error_relative_to(const PosePair& home, const PosePair& pose) {
  const Eigen::Vector3d meant = pose.meant.position - home.meant.position;
  const Eigen::Vector3d actual = pose.actual.position - home.actual.position;
  const double turned = pose.actual.rotation - pose.meant.rotation;
  const double home_turned = home.actual.rotation - home.meant.rotation;
  return {actual.norm() - meant.norm(), (actual - meant).norm(), turned - home_turned};
}

PoseErrorSummary summarize(const std::vector<PosePair>& pairs, bool rotations) {
  PoseErrorSummary summary;
  if (rotations) summary.max_abs_rotation = 0.0;
  std::vector<Eigen::Vector3d> meant, actual;
  double sum = 0.0;
  for (const PosePair& pair : pairs) {
    const PoseError error = error_relative_to(pairs.front(), pair);
    sum += error.distance * error.distance;
    summary.max_abs_distance = std::max(summary.max_abs_distance, std::abs(error.distance));
    summary.max_volumetric = std::max(summary.max_volumetric, error.volumetric);
    if (rotations) summary.max_abs_rotation = std::max(*summary.max_abs_rotation, std::abs(error.rotation));
    meant.push_back(pair.meant.position);
    actual.push_back(pair.actual.position);
  }
  const RigidMotion motion = rigid_fit(actual, meant);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    summary.max_volumetric_aligned = std::max(summary.max_volumetric_aligned, (motion(actual[k]) - meant[k]).norm());
  }
  if (pairs.size() > 1) summary.rms_distance = std::sqrt(sum / static_cast<double>(pairs.size() - 1));
  return summary;
}

}  // namespace paracal
