#pragma once

// Private to calibration: the verdict of a validation.

#include "paracal/calibration/validation.hpp"

namespace paracal::detail {

/// Holds the largest errors against their limits; without limits says whether they have shrunk by more than can be
/// measured. Reasons against the calibration, and notes, come to those that are there; accepted is what none is
/// against.
void check_limits(const Measurements& measurements, const ValidationOptions& options, Validation& validation);

}  // namespace paracal::detail
