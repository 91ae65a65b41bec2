#pragma once

// Private to calibration: from a finished fit to numbers that can be signed.

#include "calibration/fit/as_given.hpp"
#include "calibration/fit/observation.hpp"
#include "calibration/fit/outliers.hpp"
#include "calibration/fit/stage_fit.hpp"
#include "explanation.hpp"

namespace paracal::detail {

/// Probability that noise alone makes the weighted sum of squares, priors included, shrink by `gain` with `found`
/// parameters: F(gain / found : scatter), or chi-square of the gain where the sigmas are known. Nothing without degrees
/// of freedom, or of a fit that diverged so far that numbers overflow.
std::optional<double> chance_of(double gain, double found, const Scatter& scatter, bool sigmas_known);

/// A stage without priors, by its own root.
void add_stage(const char* name, const Observation& observation, const LeastSquaresResult& fit, int iterations,
               Calibration& calibration);

/// Fills parameters with their values alone.
void state_errors(const StageFit& fit, Calibration& calibration);

/// Fills parameters, uncertainty, rank, residuals, suspects, notes and verdict.
/// @param told  Told::verdict: of the same verdict, parameters and uncertainty alone.
/// @param explanation  empty: the machine is taken to be its geometry.
/// @return  is_better_known().
bool state_evidence(const Measurements& measurements, const StageFit& fit,
                    const std::optional<Explanation>& explanation, const std::vector<Contradiction>& suspects,
                    Told told, Calibration& calibration);

}  // namespace paracal::detail
