#include "series.hpp"

#include <algorithm>
#include <cmath>

#include "distances.hpp"
#include "lengths.hpp"
#include "points.hpp"

namespace paracal::detail {

void ErrorTally::widen_rotation(const std::optional<double>& residual) {
  if (residual) {
    summary.max_abs_rotation = std::max(summary.max_abs_rotation.value_or(0.0), std::abs(*residual));
  }
}

void ErrorTally::widen_orientation(const std::optional<Eigen::Vector3d>& residual) {
  if (residual) summary.max_orientation = std::max(summary.max_orientation.value_or(0.0), residual->norm());
}

PoseErrorSummary ErrorTally::finished() const {
  PoseErrorSummary all = summary;
  for (const auto& [kind, sum] : lengths) {
    if (sum.count > 0) all.rms_lengths[kind] = sum.root_mean_square();
  }
  if (joints.count > 0) all.rms_joints = joints.root_mean_square();
  all.reads_distances = distances.count > 0 || all.rms_lengths.empty();
  if (distances.count > 0) all.rms_distance = distances.root_mean_square();
  return all;
}

std::vector<std::unique_ptr<ReadingSeries>> all_series(const Measurements& measurements,
                                                       const CalibrationOptions& options) {
  std::vector<std::unique_ptr<ReadingSeries>> all;
  for (const PointSeries& series : measurements.series) all.push_back(std::make_unique<Points>(series, options));
  if (!measurements.distances.empty()) all.push_back(std::make_unique<Distances>(measurements.distances, options));
  for (const LengthSeries& series : measurements.lengths) all.push_back(std::make_unique<Lengths>(series, options));
  return all;
}

}  // namespace paracal::detail
