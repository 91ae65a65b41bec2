#pragma once

// Private to calibration: what is said of a fit once its numbers are known.

#include "acceptance.hpp"

namespace paracal::detail {

/// What no reading showed and nobody stated.
std::vector<std::string> assumptions(const Finished& of, const Posterior& posterior);

/// U over the workspace against its limits; none of a fit that did not settle, whose covariance belongs to no answer.
struct StatedUse {
  WorkspaceUse use = {};
  std::optional<Use> uncalibrated = {};  ///< of the same machine, by its tolerances
  std::optional<std::string> note = {};  ///< why there is none, or what the fine stage would be worth
};
StatedUse use_of(const Finished& of, const FitSummary& fit, const Posterior& posterior);

/// Components of variance that are certain enough are notes; the others are said among what was assumed. Readings that
/// scatter less than stated make U wider than it need be, which nobody is harmed by, but ought to know.
void add_causes(const Posterior& posterior, const FitSummary& fit, const CalibrationOptions& options, Remarks& remarks);

/// The verdict, and why it is no.
/// @param determined  the readings determine what was asked.
Outcome outcome_of(const Finished& of, const FitSummary& fit, bool determined, const std::optional<double>& chance,
                   const Compared& found);

}  // namespace paracal::detail
