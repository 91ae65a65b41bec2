#pragma once

// Private to calibration: how well a fit knows its unknowns.

#include <Eigen/Core>
#include <cmath>

#include "calibration/fit/scatter.hpp"
#include "calibration/fit/stage_fit.hpp"
#include "explanation.hpp"

namespace paracal::detail {

/// What is known of all unknowns; empty where no uncertainty could be stated.
struct Spread {
  Eigen::MatrixXd covariance = {}, noise = {};

  /// Student's k multiplies what comes of the noise, so that U = 2 std.
  Eigen::MatrixXd expanded(double noise_dof) const {
    if (covariance.size() == 0) return {};
    return covariance + (std::pow(coverage_factor(noise_dof) / kCoverageFactor, 2) - 1.0) * noise;
  }
};

/// Everything was determined that readings of this kind can determine: with priors, unless errors without any are open;
/// offsets alone (a rail's are also the robot's height) and the paper's pseudo-inverse may leave motions of the whole
/// robot open; otherwise nothing may be open.
bool is_determined(const StageFit& fit, const Calibration& calibration);

/// How many parameters' worth of readings the fit used up: with priors no whole number.
double found_parameters(const StageFit& fit, Eigen::Index rows, const Scatter& scatter);

/// Scatter and covariance. With priors the covariance is the posterior's.
/// @param tells_noise  the part of the noise is wanted, too.
Spread state_uncertainty(const Measurements& measurements, const StageFit& fit, const Scatter& scatter_of_fit,
                         bool tells_noise, Calibration& calibration);

/// Takes the uncertainties of an explanation for those of the fit.
/// @param stated  every reading states its standard deviation: the table tells by how much that is too small.
void take(const Explanation& explanation, bool stated, Calibration& calibration);

}  // namespace paracal::detail
