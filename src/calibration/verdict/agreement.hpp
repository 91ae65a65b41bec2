#pragma once

// Private to calibration: readings of any kind against what a calibration says of itself.

#include "paracal/calibration/validation.hpp"

namespace paracal::detail {

/// Errors of distances and heights at the nominal and the calibrated machine.
struct ReadingErrors {
  PoseErrorSummary before, after;
};

/// Adds `readings` and `agreement`, and a note where nobody can tell.
/// @throws InvalidArgument where the readings are no more than their set-up has unknowns.
ReadingErrors add_agreement(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                            const ValidationOptions& options, Validation& validation);

}  // namespace paracal::detail
