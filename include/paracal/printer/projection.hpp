#pragma once

#include <cstdint>
#include <optional>

#include "paracal/calibration/least_squares.hpp"
#include "paracal/printer/known_printer.hpp"

namespace paracal {

/// How far a printer's nozzle is from where its firmware believes it, over the workspace; root mean square and largest,
/// mm.
struct DeltaAccuracy {
  double absolute_rms = 0.0, absolute_max = 0.0;
  /// After the shift along the bed and the turn about z that fit best: what a print shows. No height and no distance
  /// sees these three, so in them the absolute error is as good as the towers' places are.
  double shape_rms = 0.0, shape_max = 0.0;
};

/// Which lengths of rods (and arms) a controller is told.
enum class ControllerRods : std::uint8_t {
  each,   ///< one for each tower
  alike,  ///< one for all
  kept,   ///< those that it has
};

/// The parameters of a controller that come closest to a printer, and what they leave.
struct DeltaProjection {
  LeastSquaresStatus status = LeastSquaresStatus::not_evaluable;
  DeltaGeometry geometry;
  DeltaAccuracy accuracy;

  bool ok() const { return status == LeastSquaresStatus::converged; }
};

/// What of a bed that may be bowed z is counted from.
enum class CountedFrom : std::uint8_t { plane, bed };

/// How far the nozzle is from where a firmware with this geometry believes it, above the bed, mm. Empty where either
/// machine does not close.
std::optional<Eigen::Vector3d> deviation(const KnownPrinter& known, const DeltaGeometry& geometry,
                                         const JointDrops& drops);

/// Of a firmware with this geometry, on a grid of the workspace. Places that it does not reach are passed over.
DeltaAccuracy accuracy_of(const KnownPrinter& known, const DeltaGeometry& geometry);

/// The motion along the bed that brings the machine closest to where a firmware with this geometry believes it, over
/// the workspace: no reading sees it, so it is the firmware's own business.
MotionOnBed unseen_motion(const KnownPrinter& known, const DeltaGeometry& geometry);

/// Probability that with one geometry the nozzle is less off in shape (root mean square over the workspace) than with
/// another. t: where the machine stands on the grid, above the bed; a, b: where either believes it; Q: takes a shift
/// along the bed and a turn about z away,
///
///   \f[ D = |Q(t - a)|^2 - |Q(t - b)|^2 = (b - a)^T Q (2 t - a - b)
///       var(D) = 4 v^T cov(t) v,    v = Q(b - a) \f]
///
/// linear in t, so that what is known of t is all it takes. 1/2 where both believe the same.
/// @param above  what z is counted from.
double chance_better(const KnownPrinter& known, const DeltaGeometry& geometry, const DeltaGeometry& than,
                     CountedFrom above = CountedFrom::plane);

/// Error of shape to be expected over the workspace, root mean square, mm: that of the machine as it was found, and
/// what is not known of it,
///
///   \f[ \sqrt{(|Q(t - b)|^2 + trace(Q cov(t) Q)) / places} \f]
double expected_shape(const KnownPrinter& known, const DeltaGeometry& geometry);

/// The best fit of what a controller holds over the workspace:
///
///   \f[ min_{geometry,shift,turn} sum |turn nozzle(geometry, drops) + shift - p|^2 \f]
///
/// over the grid, p: where the machine stands with these drops, above the bed. Shift and turn in the bed's plane are
/// free, so tower C keeps its angle.
/// @param start  the controller's present geometry.
DeltaProjection project(const KnownPrinter& known, const DeltaGeometry& start, ControllerRods rods);

}  // namespace paracal
