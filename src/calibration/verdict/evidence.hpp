#pragma once

// Private to calibration: from a finished fit to numbers that can be signed.

#include <string>
#include <vector>

#include "calibration/fit/as_given.hpp"
#include "explanation.hpp"

namespace paracal::detail {

/// Probability that noise alone makes the weighted sum of squares, priors included, shrink by `gain` with `found`
/// parameters: F(gain / found : scatter), or chi-square of the gain where the sigmas are known. Nothing without degrees
/// of freedom, or of a fit that diverged so far that numbers overflow.
std::optional<double> chance_of(double gain, double found, const Scatter& scatter, bool sigmas_known);

inline constexpr const char *kRoughStage = "rough", *kFineStage = "fine";

/// Of a fit without priors by its own root.
StageReport stage_report(std::string name, const StageFit& of);

struct Evidence {
  Calibration calibration;
  bool is_better_known = true;  ///< U over the workspace is below that of the uncalibrated machine
};

/// @param stages  of this fit and of those before.
/// @param components  causes that were found.
Evidence evidence_of(const Finished& of, std::vector<StageReport> stages, std::vector<Component> components, Told told);

}  // namespace paracal::detail
