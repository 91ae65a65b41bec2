#pragma once

// Private to calibration: what the readings show that noise, tolerances and the exact model do not explain.

#include <vector>

#include "calibration/fit/stage_fit.hpp"

namespace paracal::detail {

/// How repeated visits scatter about their mean, and how poses scatter about the fit beyond that: weighted squares and
/// their degrees of freedom.
struct FitScatter {
  Scatter visits;  ///< pure error
  Scatter poses;   ///< lack of fit
};
FitScatter fit_scatter(const StageFit& fit);

/// Adds components of variance to a settled fit, the most telling first, while the marginal likelihood rises by more
/// than chance explains:
///
/// - joints that stand elsewhere at each pose, the same at every visit (backlash, friction, load): only where visits
///   repeat or the noise is stated, for else nobody can tell them from noise;
/// - stated noise that is not what was stated;
/// - priors of all errors, of the position or the tilt group, of one kind of error on all limbs, of the coordinates of
///   one joint centre, or of one error: parts
///   worse than their tolerances (empirical Bayes).
///
/// @returns those found, in words. The fit is settled with them.
std::vector<Component> find_components(StageFit& fit, const CalibrationOptions& options);

}  // namespace paracal::detail
