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

/// By what a bed is no plane: it lies edge (r^2 / radius^2 - 1/2) above it, r from the robot's axis; that has no mean
/// over the disc of this radius.
struct BedBow {
  double edge = 0.0;    ///< above the centre, mm
  double radius = 0.0;  ///< mm; 0: the bed is taken to be a plane

  bool is_sought() const { return radius > 0.0; }
  /// Over `edge`, at a place of the robot's frame.
  double share_at(const Eigen::Vector3d& p) const;
};

/// Of the first series of heights of a calibration.
/// @param bow_radius  where a curvature was sought: the disc over which the plane is the mean of the bed.
FoundPlane found_bed(const Calibration& calibration, double bow_radius = 0.0);

/// A real printer, as far as it is known: its machine, and the bed that z is counted from.
struct KnownPrinter {
  PrinterMachine printer;
  SourceErrors errors;
  FoundPlane bed;
  std::vector<SoughtSource> parameters = {};
  /// Of height and slopes of the bed, its bow where that is sought, then of the parameters, mm and rad, U = 2 std;
  /// empty: known exactly.
  Eigen::MatrixXd covariance = {};
  BedBow bow = {};

  /// Rows of the covariance that are the bed's.
  Eigen::Index of_bed() const { return bow.is_sought() ? 4 : 3; }
};

/// As a calibration of heights found it.
/// @param bow_radius  see found_bed(); > 0 where a curvature was sought.
KnownPrinter known_printer(const PrinterMachine& printer, const Calibration& calibration, double bow_radius = 0.0);

/// The same with the plane alone: what is not known of the bow counts in all else.
KnownPrinter above_plane(KnownPrinter known);

/// Motion along the bed: shift, then turn about z; mm, rad.
struct MotionOnBed {
  double x = 0.0, y = 0.0, turn = 0.0;
};

/// A calibration as the controller's coordinates see it: the machine moved so that its bed is where they are zero, and
/// along it. Neither heights nor distances see such motions. What is not known of the bed joins the covariance of the
/// errors.
Calibration above_bed(Calibration calibration, const KnownPrinter& known, const MotionOnBed& along = {});

}  // namespace paracal
