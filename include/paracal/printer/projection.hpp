#pragma once

#include <cstdint>
#include <optional>

#include "paracal/numerics/least_squares.hpp"
#include "paracal/printer/known_printer.hpp"

namespace paracal {

/// Error of the nozzle position computed by the firmware, over the workspace; root mean square and largest,
/// mm.
struct DeltaAccuracy {
  double absolute_rms = 0.0, absolute_max = 0.0;
  /// Without the best-fitting shift along the bed and rotation about z: the error of a print. Heights and distances do
  /// not determine these three; there the absolute error depends on the assumed positions of the towers.
  double shape_rms = 0.0, shape_max = 0.0;
};

/// Lengths of rods (and arms) that a controller takes.
enum class ControllerRods : std::uint8_t {
  each,   ///< one for each tower
  alike,  ///< one for all
  kept,   ///< those that it has
};

/// The parameters of a controller that come closest to a printer, and the error that remains.
struct DeltaProjection {
  LeastSquaresStatus status = LeastSquaresStatus::not_evaluable;
  DeltaGeometry geometry;
  DeltaAccuracy accuracy;

  bool ok() const { return status == LeastSquaresStatus::converged; }
};

/// Zero of z for a bed that may be bowed.
enum class CountedFrom : std::uint8_t { plane, bed };

/// Error of the nozzle position computed by a firmware with this geometry, above the bed, mm. Empty if one of the
/// machines does not close.
std::optional<Eigen::Vector3d> deviation(const KnownPrinter& known, const DeltaGeometry& geometry,
                                         const JointDrops& drops);

/// Largest depth of the nozzle below the bed while a firmware with this geometry computes z = 0, over the bed, mm.
double depth_at_zero(const KnownPrinter& known, const DeltaGeometry& geometry);

/// Of a firmware with this geometry, on a grid of the workspace. Positions out of reach are ignored.
DeltaAccuracy accuracy_of(const KnownPrinter& known, const DeltaGeometry& geometry);

/// The motion along the bed that brings the machine closest to the positions computed by a firmware with this geometry,
/// over the workspace. Readings do not determine it, so the firmware defines it.
MotionOnBed unseen_motion(const KnownPrinter& known, const DeltaGeometry& geometry);

/// Probability that the shape error (root mean square over the workspace) is smaller with one geometry than with
/// another. t: true positions on the grid, above the bed; a, b: positions computed with each geometry. Q removes a
/// shift along the bed and a rotation about z:
///
///   \f[ D = |Q(t - a)|^2 - |Q(t - b)|^2 = (b - a)^T Q (2 t - a - b)
///       var(D) = 4 v^T cov(t) v,    v = Q(b - a) \f]
///
/// D is linear in t, so mean and covariance of t suffice. 1/2 if both geometries give the same positions.
/// @param above  zero of z.
double chance_better(const KnownPrinter& known, const DeltaGeometry& geometry, const DeltaGeometry& than,
                     CountedFrom above = CountedFrom::plane);

/// Expected shape error over the workspace, root mean square, mm: that of the identified machine and its uncertainty,
///
///
///   \f[ \sqrt{(|Q(t - b)|^2 + trace(Q cov(t) Q)) / places} \f]
double expected_shape(const KnownPrinter& known, const DeltaGeometry& geometry);

/// The best fit of the controller's parameters over the workspace:
///
///   \f[ min_{geometry,shift,turn} sum |turn nozzle(geometry, drops) + shift - p|^2 \f]
///
/// over the grid, p: where the machine stands with these drops, above the bed. Shift and turn in the bed's plane are
/// free, so tower C keeps its angle.
/// @param start  the controller's present geometry.
DeltaProjection project(const KnownPrinter& known, const DeltaGeometry& start, ControllerRods rods);

}  // namespace paracal
