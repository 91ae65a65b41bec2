#pragma once

// Private to calibration.

#include <optional>

#include "paracal/calibration/measurement.hpp"

namespace paracal::detail {

/// Distances between all pairs of N points are as a rule computed from the points, and so correlated: N points carry
/// 3 N numbers. If the table is complete, and points exist whose distances it holds to within rounding, the same
/// measurements with these points (in a frame of their own) instead of the distances: their noise is independent, and
/// nothing is lost. Points from the squared distances by double centring, -1/2 J D J = X X^T  [torgerson1952].
/// @returns empty when the distances are something else (incomplete, with stated sigmas, or not of points).
std::optional<Measurements> as_points(const Measurements& measurements);

}  // namespace paracal::detail
