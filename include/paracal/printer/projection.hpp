#pragma once

#include "paracal/calibration/calibration.hpp"
#include "paracal/printer/printer_machine.hpp"

namespace paracal {

/// How far a printer's nozzle is from where its firmware believes it, over the workspace; root mean square and largest,
/// mm.
struct DeltaAccuracy {
  double absolute_rms = 0.0, absolute_max = 0.0;
  /// After the shift along the bed and the turn about z that fit best: what a print shows. No height and no distance
  /// sees these three, so in them the absolute error is as good as the towers' places are.
  double shape_rms = 0.0, shape_max = 0.0;
};

/// A real printer, as far as it is known: its machine, and the bed that z is counted from.
struct KnownPrinter {
  PrinterMachine printer;
  SourceErrors errors;
  FoundPlane bed;
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

/// How far the nozzle is from where a firmware with this geometry believes it, above the bed, mm. Empty where either
/// machine does not close.
std::optional<Eigen::Vector3d> deviation(const KnownPrinter& known, const DeltaGeometry& geometry,
                                         const JointDrops& drops);

/// Of a firmware with this geometry, on a grid of the workspace. Places that it does not reach are passed over.
DeltaAccuracy accuracy_of(const KnownPrinter& known, const DeltaGeometry& geometry);

/// The best fit of what a controller holds over the workspace:
///
///   min over geometry, shift, turn  sum over the grid of | turn nozzle(geometry, drops) + shift - p |^2,
///
/// p: where the machine stands with these drops, above the bed. Shift and turn in the bed's plane are free, so tower C
/// keeps its angle.
/// @param start  the controller's present geometry.
DeltaProjection project(const KnownPrinter& known, const DeltaGeometry& start, ControllerRods rods);

}  // namespace paracal
