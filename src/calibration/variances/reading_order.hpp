#pragma once

// Private to calibration: when each reading was taken, and from which side each joint came.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "calibration/fit/observation.hpp"

namespace paracal::detail {

/// One order in which the readings of each series may have been taken. A row for each reading, by its place among the
/// groups.
struct ReadingOrder {
  static constexpr int kDegrees = 3;  ///< a step half way is followed for six sevenths of its squares

  /// Legendre's polynomials of degree 1 to 3 of the time from -1 to 1 over the series, less their means over its
  /// readings in use.
  Eigen::MatrixXd drift;
  /// Poses are visited again after others. Else errors that go with the place, as those of uneven drives, go with the
  /// time where poses follow a path.
  bool tells_drift = false;
  /// 1 where a joint came from below, -1 from above, 0 where nothing tells.
  Eigen::MatrixXd sides;
};

/// As the rows of each series stand. Where these list the visits of each pose together, the poses may have been visited
/// in passes instead: the second order has the first visit of every pose, then the second.
std::vector<std::shared_ptr<const ReadingOrder>> reading_orders(const Observation& observation);

/// Whether some series lists a pose again after others: what drifts then differs from what a pose always does.
bool returns_to_poses(const Observation& observation);

}  // namespace paracal::detail
