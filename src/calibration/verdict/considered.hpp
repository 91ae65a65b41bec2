#pragma once

// Private to calibration: errors that a fit holds at nominal although their tolerances allow them.

#include "calibration/fit/stage_fit.hpp"

namespace paracal::detail {

/// Carries what a fit without priors did not seek into its uncertainty (consider covariance  [schmidt1966]). With
/// readings y = J p + B q + n, p sought by p^ = K y and q held at zero with covariance S, and with p~ = p^ - p:
///
///   p~ = K B q + K n - (1 - K J) p,   q~ = -q,
///   cov = | C + K B S (K B)^T + (1 - K J) S_p (1 - K J)^T    -K B S |
///         | -(K B S)^T                                           S |,   C: of the noise.
///
/// The scale of the instrument is one more q. Appends rows and columns of the held errors to calibration.covariance and
/// noise_covariance; changes nothing where no covariance is stated or the fit has priors for everything.
/// @returns the held errors, with their tolerances, in the order of these rows.
std::vector<SoughtSource> consider_held(const Measurements& measurements, const StageFit& fit,
                                        Calibration& calibration);

}  // namespace paracal::detail
