#pragma once

// Private to calibration: from a finished fit to numbers that can be signed.

#include "components.hpp"
#include "observation.hpp"
#include "outliers.hpp"
#include "stage_fit.hpp"

namespace paracal::detail {

/// A stage without priors, by its own root.
void add_stage(const char* name, const Observation& observation, const LeastSquaresResult& fit, int iterations,
               Calibration& calibration);

/// Fills parameters, uncertainty, rank, residuals, suspects, notes and verdict.
void state_evidence(const Measurements& measurements, const StageFit& fit, const std::vector<Contradiction>& suspects,
                    Calibration& calibration);

}  // namespace paracal::detail
