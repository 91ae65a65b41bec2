#pragma once

// Private to calibration: what explains the readings beside noise, tolerances and the exact geometry, in words.

#include <string>
#include <vector>

#include "calibration/variances/facts.hpp"
#include "calibration/variances/variance_posterior.hpp"

namespace paracal::detail {

/// How far, and what to do.
/// @param noise  of the readings, mm.
std::string text_of(const SuspectedFact& one, double noise);

/// Errors of a group, positions or tilts, that are so many times their tolerances.
std::string text_of_group(Spreads what, double factor);

/// Adds the causes that are more probable than not: facts of which one is so, then what is large beside the noise and
/// far larger than expected.
/// @param tables  that of none of the facts, then theirs, with their probabilities.
void add_causes(const StageFit& fit, const CalibrationOptions& options, const std::vector<SuspectedFact>& facts,
                const std::vector<WeighedTable>& tables, const VariancePosterior& posterior,
                std::vector<Component>& causes);

}  // namespace paracal::detail
