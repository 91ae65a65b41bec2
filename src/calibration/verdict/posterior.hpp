#pragma once

// Private to calibration: what a finished fit knows of the machine.

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "calibration/fit/scatter.hpp"
#include "explanation.hpp"

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

/// What is known of errors when those are considered that a fit held at nominal.
struct Considered {
  std::vector<SoughtSource> held = {};  ///< with their tolerances
  Eigen::MatrixXd covariance, noise;    ///< of the sought errors, then of these
};

/// Carries what a fit without priors did not seek into its uncertainty (consider covariance  [schmidt1966]). With
/// readings y = J p + B q + n, p sought by p^ = K y and q held at zero with covariance S, and with p~ = p^ - p:
///
///   p~ = K B q + K n - (1 - K J) p,   q~ = -q,
///   cov = | C + K B S (K B)^T + (1 - K J) S_p (1 - K J)^T    -K B S |
///         | -(K B S)^T                                           S |,   C: of the noise.
///
/// The scale of the instrument is one more q. Nothing is held, and nothing changes, where no covariance is stated or
/// the fit has priors for everything.
/// @param covariance  of the sought errors; @param noise  the part of it that comes from the noise.
Considered consider_held(const Finished& of, Eigen::MatrixXd covariance, Eigen::MatrixXd noise);

/// Nothing but the values of a fit.
Posterior errors_alone(const Finished& of, std::vector<Component> components);

}  // namespace paracal::detail
