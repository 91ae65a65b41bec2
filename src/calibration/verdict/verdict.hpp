#pragma once

// Private to calibration: what is said of a fit once its numbers are known.

#include "acceptance.hpp"

namespace paracal::detail {

/// What no reading showed and nobody stated.
void add_assumptions(const StageFit& fit, const std::optional<Explanation>& explanation, Calibration& calibration);

/// What is known of the controller that commanded the joints, among the options, and what had to be assumed of it.
void add_controller(const Measurements& measurements, Calibration& calibration);

/// U over the workspace against its limits; none of a fit that did not settle, whose covariance belongs to no answer.
/// @returns that of the uncalibrated machine, by its tolerances.
std::optional<Use> state_use(const StageFit& fit, Calibration& calibration);

/// Components of variance that are certain enough are notes; the others are said among what was assumed. Readings that
/// scatter less than stated make U wider than it need be, which nobody is harmed by, but ought to know.
void add_components(Calibration& calibration);

/// What seeking every error under its tolerance would be worth where the offsets alone were sought.
void add_promise_of_fine(const Measurements& measurements, Calibration& calibration);

/// The verdict, and why it is no.
/// @param determined  the readings determine what was asked.
void judge(const LeastSquaresResult& fit, bool determined, const Compared& found, Calibration& calibration);

}  // namespace paracal::detail
