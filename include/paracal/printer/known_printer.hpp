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

/// Of the first series of heights of a calibration.
FoundPlane found_bed(const Calibration& calibration);

/// A real printer, as far as it is known: its machine, and the bed that z is counted from.
struct KnownPrinter {
  PrinterMachine printer;
  SourceErrors errors;
  FoundPlane bed;
  std::vector<SoughtSource> parameters = {};
  /// Of height and slopes of the bed, then of the parameters, mm and rad, U = 2 std; empty: known exactly.
  Eigen::MatrixXd covariance = {};
};

/// As a calibration of heights found it.
KnownPrinter known_printer(const PrinterMachine& printer, const Calibration& calibration);

/// Motion along the bed: shift, then turn about z; mm, rad.
struct MotionOnBed {
  double x = 0.0, y = 0.0, turn = 0.0;
};

/// A calibration as the controller's coordinates see it: the machine moved so that its bed is where they are zero, and
/// along it. Neither heights nor distances see such motions. What is not known of the bed joins the covariance of the
/// errors.
Calibration above_bed(Calibration calibration, const KnownPrinter& known, const MotionOnBed& along = {});

}  // namespace paracal
