#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"

namespace paracal {

/// "e_x2" or "e_x.2": e_x of limb 2; "e_x": of all limbs. The dot tells alpha0 of limb 3, "alpha0.3", from "alpha03".
/// The names are those of that kind of limb.
/// @throws InvalidArgument for anything else.
std::vector<SourceSelector> source_selectors(const std::vector<std::string>& names, const JointSpace& limbs);

/// What is fixed must leave something to estimate, and nothing that is free.
/// @throws InvalidArgument naming the error.
void check_selection(const CalibrationOptions& options, const JointSpace& limbs);

}  // namespace paracal
