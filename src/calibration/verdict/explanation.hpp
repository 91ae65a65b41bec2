#pragma once

// Private to calibration: what the readings show that noise, tolerances and the exact geometry do not explain.

#include <optional>
#include <vector>

#include "calibration/fit/stage_fit.hpp"
#include "calibration/variances/variance_posterior.hpp"

namespace paracal::detail {

/// What is known of a machine when its variances have been averaged over.
struct Explanation {
  Posterior known = {};             ///< about the machine of the fit, which has no splines; without its parameters
  Eigen::VectorXd means = {};       ///< of errors of parts, then of the splines of drives
  Eigen::MatrixXd covariance = {};  ///< mean squares of both
  NoiseOfSeries noise = {};         ///< as the table has it
  double stated_noise = 0.0;        ///< over that with which readings entered; 0: none is stated
  double absorbed = 0.0;            ///< what joints, drives and poses do beside the geometry, mm at the plate
  double allowed = 0.0;             ///< what errors within their tolerances do there
  bool repeats = false;             ///< visits tell noise from joints
  /// No pose was visited twice, nobody stated the noise, and nothing else tells it from joints. U then takes what
  /// readings scatter for either.
  bool is_ambiguous = false;
  Eigen::VectorXd noise_as_joints = {};  ///< of each joint that alone scatters the plate as much as the noise does
  Eigen::VectorXd with_drives = {};      ///< errors of parts where drives belong to the machine, from their expectation
  double log_evidence = 0.0;             ///< of every reading; no number where a table holds a part of them alone
  /// The reflector is beside the axis or the centre of this mount: its place is to be sought.
  std::optional<ReflectorMount> mount = {};
};

/// Estimates all variances of a settled fit. A part or a pose that is wrong with a probability above 1 -
/// options.largest_doubt is taken to be so: the part's prior is widened, the readings of the pose are left out, and the
/// fit is settled again. Below it both are averaged over.
/// @returns empty where the fit does not converge, or readings and priors leave something open.
std::optional<Explanation> explained(StageFit& fit, const Measurements& measurements,
                                     const CalibrationOptions& options);

/// A finished fit with what it came from: from this, evidence is drawn.
struct Finished {
  const Robot& robot;  ///< as given; the fit's has errors as they were expected
  const Measurements& measurements;
  const CalibrationOptions& options;
  const StageFit& fit;
  const Explanation* explanation = nullptr;  ///< none: the machine is taken to be its geometry

  const Observation& observation() const { return fit.observation(); }
};

}  // namespace paracal::detail
