#pragma once

// Private to calibration: how well readings fit a robot, whatever is wrong with some of them.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::detail {

/// What a calibration is given.
struct Input {
  Robot robot;
  Measurements measurements;
  CalibrationOptions options;
};

/// A robust fit and what it is worth.
struct TrialFit {
  std::vector<SoughtSource> sought = {};
  Eigen::VectorXd errors = {};      ///< mm or rad, in the order of `sought`
  Eigen::MatrixXd covariance = {};  ///< of them
  /// Minus the logarithm of the evidence, but for what is alike for the same readings  [mackay1992]:
  ///
  ///   sum d_k log s + sum (nu + d_k)/2 log(1 + rho_k^2 / nu) + 1/2 sum (p_j / sigma_j)^2 + log det(R) + sum log
  ///   sigma_j
  ///
  /// d_k rows of reading k, rho_k the length of its residuals over s times their sigmas, R the root of all information.
  double objective = 0.0;
  double scale = 1.0;  ///< s
  /// Standard deviation of a coordinate, distance or height as the residuals show it, mm; gross errors hardly count.
  double noise = 0.0;
  std::optional<double> rotation_noise = {};  ///< rad, where rotations are read
  double tension = 0.0;                       ///< root mean square of p_j / sigma_j
  /// The s that the repeats of a visit show, whatever the machine is: empty where hardly anything was read twice.
  std::optional<double> repeats = {};
  bool is_stated = false;  ///< all sigmas
};

/// Root of the information and residuals in units of the sigmas at an answer of noise s: minimises the posterior under
/// Student's t (nu = 5) by reweighting, with s such that the weighted residuals equal their redundancy.
/// @returns empty where the robot does not reach a station or does not close there.
std::optional<TrialFit> fit_robustly(const Input& input);

/// Three quarters of the readings lie closer than this to the nominal robot, aligned; in units of their sigmas.
/// Infinite where the robot does not reach a station. A thousand times cheaper than a fit.
double nominal_misfit(const Input& input);

}  // namespace paracal::detail
