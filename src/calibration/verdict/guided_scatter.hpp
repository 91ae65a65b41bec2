#pragma once

// Private to calibration: what guides do that hold a plate in a plane.

#include <optional>
#include <string>

#include "calibration/fit/observation.hpp"

namespace paracal::detail {

/// Guides are taken for perfect. Points of a plate that they hold in a plane show whether it is one: a table that is
/// bent, or a carriage that lifts, takes the plate across the plane, where no error of the machine and no joint moves
/// it. The means of each pose's residuals, mm over their sigma, scatter across the plane and within it,
///
///   F = (squares across / (n - 3)) / (squares within / (2 n - found - 3))       3 a series: its plane, and its place
///
/// with as many errors of the machine as were found, those that priors hold in part (found_parameters in
/// posterior.hpp). Where chance alone would show as much less often than `tell_chance`, U holds in the plane alone.
/// What scatters across makes the fit believe all readings less, and find less of errors that priors hold; what is left
/// of them in the plane counts as scatter: 5 % more than the noise in the mean of the template 3-rrr, 1 to 2 % of
/// others.
/// @returns a note of that, else nothing.
std::optional<std::string> scatter_across_guides(const Observation& observation, const Placed& at, double found,
                                                 double tell_chance);

}  // namespace paracal::detail
