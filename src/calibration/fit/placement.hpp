#pragma once

// Private to calibration: where the readings of a validation lie by one machine.

#include <memory>
#include <vector>

#include "observation.hpp"
#include "paracal/calibration/validation.hpp"

namespace paracal::detail {

CalibrationOptions as_for_a_fit(const ValidationOptions& options);

/// The readings of one machine, whose set-up alone is sought, where it fits best. The scale is none of it: it would
/// take what is wrong with the machine.
struct Placement {
  /// @throws Unreachable where the machine does not close at a station.
  Placement(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
            const SourceErrors& errors);
  /// They must live as long.
  Placement(const Robot& robot, const Measurements& measurements, const CalibrationOptions&& options,
            const SourceErrors& errors) = delete;

  Placed placed() const { return {*stations, setup}; }
  /// Measured minus predicted.
  Residual residual(const Group& group) const { return observation.residual(group, placed()).reversed(); }
  /// Errors of distances, lengths and orientations.
  PoseErrorSummary summary() const;

  Observation observation;
  Eigen::VectorXd setup;
  std::shared_ptr<const std::vector<StationState>> stations;
};

}  // namespace paracal::detail
