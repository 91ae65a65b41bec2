#pragma once

// Private to calibration: what a fit must have explained before its machine is accepted.

#include <optional>
#include <string>
#include <vector>

#include "explanation.hpp"

namespace paracal::detail {

/// How a fit compares with what was expected of instrument and machine.
struct Compared {
  bool identifies_errors = false;  ///< some error by itself
  double combinations = 0.0;       ///< of errors that the readings determine, where these determine none by itself
  double stated_noise = 1.0;       ///< noise found, over that which readings state
  double unstated_noise = 1.0;     ///< over NoiseModel, of readings that state none
  double noise = 0.0;              ///< of either, mm
  double absorbed = 0.0;           ///< what joints, drives and poses do beside the geometry, mm at the plate
  double allowed = 0.0;            ///< what errors within their tolerances do there; 0: not known
  std::optional<Use> use = {}, uncalibrated = {};  ///< U over the workspace, and by the tolerances alone
  bool uses_tolerances = true;                     ///< else U of what no reading shows is not bounded by them
};

/// By all but U, combinations and the noise in mm.
Compared compared_with_expected(const Finished& of, const FitSummary& fit, const Posterior& posterior);

/// Covariance of errors before any reading, by their tolerances and by how far the table expects parts to be beyond
/// them; empty where one of them has no tolerance.
Eigen::MatrixXd covariance_of_tolerances(const Robot& robot, const CalibrationOptions& options,
                                         const Posterior& posterior);

/// U over the workspace is below that of the uncalibrated machine; also where no U is stated.
bool is_better_known(const Compared& found, const CalibrationOptions& options);

/// What is not explained, a sentence each: nothing is identified, the noise is not that of such an instrument, joints,
/// drives and poses absorb what geometry should explain, or the machine is not better known than by its tolerances.
std::vector<std::string> unexplained(const Compared& found, const CalibrationOptions& options);

}  // namespace paracal::detail
