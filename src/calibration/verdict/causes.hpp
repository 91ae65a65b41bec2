#pragma once

// Private to calibration: what explains the readings beside noise, tolerances and the exact geometry, in words.

#include <string>
#include <vector>

#include "calibration/variances/order_effects.hpp"
#include "calibration/variances/trials.hpp"

namespace paracal::detail {

Cause cause_of(const Fact& fact);

/// How far one of the facts is off, and what to do.
/// @param noise  of the readings, mm.
std::string text_of(const Trials& trials, std::size_t fact, double noise);

Cause cause_of(const FoundOrder& found);

/// What goes with the order of the readings, how far, and what to do.
std::string text_of(const FoundOrder& found, const Observation& observation);

/// The same where it may not be so.
std::string text_of_open(const FoundOrder& found);

/// Errors of a group, positions or tilts, that are so many times their tolerances.
std::string text_of_group(Spreads what, double factor);

/// Adds the causes that are more probable than not: facts of which one is so, then what is large beside the noise and
/// far larger than expected.
void add_causes(const StageFit& fit, const CalibrationOptions& options, const Trials& trials,
                const VariancePosterior& posterior, std::vector<Component>& causes);

}  // namespace paracal::detail
