#include "series.hpp"

#include <algorithm>
#include <cmath>

#include "distances.hpp"
#include "heights.hpp"
#include "points.hpp"

namespace paracal::detail {

void ErrorTally::widen_rotation(const std::optional<double>& residual) {
  if (residual) {
    summary.max_abs_rotation = std::max(summary.max_abs_rotation.value_or(0.0), std::abs(*residual));
  }
}

PoseErrorSummary ErrorTally::finished() const {
  const auto root_mean_square = [](double sum, std::size_t count) {
    return std::sqrt(sum / static_cast<double>(count));
  };
  PoseErrorSummary all = summary;
  all.reads_distances = distance_count > 0 || height_count == 0;
  if (distance_count > 0) all.rms_distance = root_mean_square(distances, distance_count);
  if (height_count > 0) all.rms_height = root_mean_square(heights, height_count);
  return all;
}

std::vector<std::unique_ptr<ReadingSeries>> all_series(const Measurements& measurements,
                                                       const CalibrationOptions& options) {
  std::vector<std::unique_ptr<ReadingSeries>> all;
  for (const PointSeries& series : measurements.series) all.push_back(std::make_unique<Points>(series, options));
  if (!measurements.distances.empty()) all.push_back(std::make_unique<Distances>(measurements.distances, options));
  for (const HeightSeries& plane : measurements.planes) all.push_back(std::make_unique<Heights>(plane, options));
  return all;
}

}  // namespace paracal::detail
