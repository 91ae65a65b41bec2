#pragma once

// Private: what a fit makes of small errors and of noise, to first order.

#include <Eigen/Core>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::detail {

/// Errors found by the fit of all errors under their priors (Method::best, fine stage) near the nominal machine:
///
///   found = C J_s^T (J e + n),   C = (J^T J + P)^-1,
///
/// with readings divided by their standard deviations, J of the set-up and the sought errors, J_s its columns of the
/// sought errors, P what is known beforehand and n the noise.
struct LinearEstimate {
  std::vector<SoughtSource> sought;
  Eigen::MatrixXd by_error;    ///< found by each of the errors that were asked about, mm and rad
  Eigen::MatrixXd by_reading;  ///< C J_s^T: found by each row of the readings
};

/// @param at_nominal  readings of the nominal machine, without noise.
/// @param errors      which a machine may have, sought or not.
/// @throws Unreachable when the nominal machine does not close at a station.
LinearEstimate linear_estimate(const Robot& robot, const Measurements& at_nominal, const CalibrationOptions& options,
                               const std::vector<SoughtSource>& errors);

/// Measured minus predicted at the nominal machine, of all readings above the set-up that fits them best, divided by
/// their standard deviations: what `by_reading` multiplies.
/// @throws Unreachable as linear_estimate().
Eigen::VectorXd weighed_readings(const Robot& robot, const Measurements& readings, const CalibrationOptions& options);

}  // namespace paracal::detail
