#pragma once

#include <Eigen/Core>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/printer/printer_machine.hpp"

namespace paracal {

/// Where a bed lies, in the robot's frame: z = height + slope_x x + slope_y y.
struct FoundPlane {
  double height = 0.0;  ///< mm
  double slope_x = 0.0, slope_y = 0.0;
};

/// Deviation of a bed from a plane: edge (r^2 / radius^2 - 1/2), r from the robot's axis. Its mean over the disc of
/// this radius is zero.
struct BedBow {
  double edge = 0.0;    ///< above the centre, mm
  double radius = 0.0;  ///< mm; 0: the bed is assumed to be flat

  bool is_sought() const { return radius > 0.0; }
  /// Relative to `edge`, at a position in the robot's frame.
  double share_at(const Eigen::Vector3d& p) const;
};

/// Of the first series of heights of a calibration.
/// @param bow_radius  if a curvature was estimated: the disc over which the plane is the mean of the bed.
FoundPlane found_bed(const Calibration& calibration, double bow_radius = 0.0);

/// A real printer as far as it is known: its machine, and the bed from which z is counted.
struct KnownPrinter {
  PrinterMachine printer;
  SourceErrors errors;
  FoundPlane bed;
  std::vector<SoughtSource> parameters = {};
  /// Of height and slopes of the bed, its bow if estimated, then of the parameters, mm and rad; empty: known exactly.
  /// U = 2 std.
  Eigen::MatrixXd covariance = {};
  BedBow bow = {};

  /// Number of rows of the covariance for the bed.
  Eigen::Index of_bed() const { return bow.is_sought() ? 4 : 3; }
};

/// From a calibration of heights.
/// @param bow_radius  see found_bed(); > 0 if a curvature was estimated.
KnownPrinter known_printer(const PrinterMachine& printer, const Calibration& calibration, double bow_radius = 0.0);

/// The same with the plane alone: the uncertainty of the bow is part of all others.
KnownPrinter above_plane(KnownPrinter known);

/// Motion along the bed: shift, then turn about z; mm, rad.
struct MotionOnBed {
  double x = 0.0, y = 0.0, turn = 0.0;
};

/// A calibration in the controller's coordinates: the machine moved so that its bed is at zero, and along the bed.
/// Heights and distances do not determine such motions. The uncertainty of the bed is added to the covariance of the
/// errors.
Calibration above_bed(Calibration calibration, const KnownPrinter& known, const MotionOnBed& along = {});

}  // namespace paracal
