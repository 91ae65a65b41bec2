#pragma once

// Private to calibration: errors that a fit holds at nominal although their tolerances allow them.

#include "finished.hpp"

namespace paracal::detail {

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

}  // namespace paracal::detail
