#pragma once

#include <optional>

#include "paracal/calibration/calibration.hpp"
#include "paracal/printer/printer_machine.hpp"

namespace paracal {

/// A printer with all errors of its machine, also those that its firmware has no number for: for the correction of
/// programs.
struct ProgramCalibration {
  PrinterMachine printer;     ///< nominal: the firmware with its saved values
  Measurements measurements;  ///< the readings as used
  /// In the controller's coordinates: the machine moved so that its bed is at zero, and along the bed and about z so
  /// that programs stay where they were. Heights and distances do not determine such motions. The uncertainty of the
  /// bed is part of the covariance.
  Calibration calibration;
};

/// A bias of all distances is estimated where it is significant.
/// @param nominal  a geometry nearer to the machine, such as the firmware's fit.
/// @param print_radius  of the bed, mm.
/// @returns empty where the machine does not close at every reading.
std::optional<ProgramCalibration> calibrate_for_programs(const DeltaGeometry& saved, const DeltaGeometry& nominal,
                                                         const DeltaReadings& readings, double print_radius);

}  // namespace paracal
