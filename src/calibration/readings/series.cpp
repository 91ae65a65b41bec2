#include "series.hpp"

#include <algorithm>

#include "distances.hpp"
#include "heights.hpp"
#include "points.hpp"

namespace paracal::detail {

void ErrorTally::widen_rotation(const std::optional<double>& residual) {
  if (residual) {
    summary.max_abs_rotation = std::max(summary.max_abs_rotation.value_or(0.0), std::abs(*residual));
  }
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
