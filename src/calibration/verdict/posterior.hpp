#pragma once

// Private to calibration: what a finished fit knows of the machine.

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "calibration/fit/scatter.hpp"
#include "finished.hpp"

namespace paracal::detail {

/// What is known of all unknowns; empty where no uncertainty could be stated.
struct Spread {
  Eigen::MatrixXd covariance = {}, noise = {};        ///< and its part that comes from the noise of the readings
  Eigen::MatrixXd errors = {}, errors_by_noise = {};  ///< the same of the errors alone; also of the paper's method
  double noise_dof = std::numeric_limits<double>::infinity();
};

/// Root of the weighted squares over their redundancy; empty where nothing is left to tell it.
std::optional<double> unit_weight_std(const Scatter& scatter);

/// All readings state their noise, and repeated visits tell it from joints: what readings scatter beyond the noise that
/// the table finds is the joints'.
bool visits_tell_noise(const Finished& of, const Scatter& scatter);

/// Everything was determined that readings of this kind can determine: with priors, unless errors without any are open;
/// offsets alone (a rail's are also the robot's height) and the paper's pseudo-inverse may leave motions of the whole
/// robot open; otherwise nothing may be open.
bool is_determined(const Finished& of, const FitSummary& fit);

/// How many parameters' worth of readings the fit used up: with priors no whole number.
double found_parameters(const StageFit& fit, Eigen::Index rows, const Scatter& scatter);

/// Covariance. With priors it is the posterior's.
/// @param tells_noise  the part of the noise is wanted, too.
Spread spread_of(const Finished& of, const FitSummary& fit, const Scatter& scatter, bool tells_noise);

/// The sought errors, then those held, with the uncertainties of the explanation where there is one.
/// @param components  causes that were found.
Posterior posterior_of(const Finished& of, const FitSummary& fit, const Scatter& scatter, const Spread& spread,
                       std::vector<Component> components);

/// Nothing but the values of a fit.
Posterior errors_alone(const Finished& of, std::vector<Component> components);

}  // namespace paracal::detail
