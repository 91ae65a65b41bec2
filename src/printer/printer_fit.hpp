#pragma once

// Private to printer: both ways of knowing a printer from the same readings.

#include <optional>

#include "paracal/printer/printer_calibration.hpp"

namespace paracal::detail {

struct PrinterFit {
  DeltaFit firmware;
  DeltaGeometry nominal;   ///< the firmware's optimum, where it can be a printer; else where it started
  PrinterMachine printer;  ///< drawn like that; its controller holds what it started from, where that can be
  Measurements measurements;
  Calibration calibration;
  double bow_radius = 0.0;  ///< as in PrinterFitOptions

  /// What the firmware is to be told after this calibration.
  DeltaProjection written() const;
};

struct PrinterFitOptions {
  bool seeks_bias = false;    ///< see printer_options()
  double bow_radius = 0.0;    ///< of the disc over which a bow of the bed is sought, mm; 0: the bed is a plane
  double print_radius = 0.0;  ///< of the bed, mm; 0: as far out as the printer goes
  bool states_use = false;    ///< U in use, of which trials have no need
};

/// @param start  a geometry near the firmware's optimum.
/// @returns empty where the machine does not close at every reading.
std::optional<PrinterFit> fit_printer(const DeltaGeometry& start, const DeltaReadings& readings,
                                      const PrinterFitOptions& options);

/// What the machine is not, and readings show all the same: a bias of all distances, a bow of the bed. Heights of a
/// bowed bed look like another delta radius, which distances contradict, and a bias explains the contradiction as well:
/// so each is taken for what it is only where the other does not explain the readings.
struct ReadingTrial {
  /// The bias is known, whatever the bed is, to half of what nobody knows it by: that takes distances of different
  /// lengths.
  bool bias_can_be_told = false;
  /// And it is there: sought with the bow, it is 2.5 of its standard deviations away from zero. One unbiased printer in
  /// 80 is taken for a biased one.
  bool bias_is_there = false;
  double bias = 0.0, bias_std = kDistanceBias;  ///< mm; sought with the bow
  BedFlatness bed;
  /// The machine as it is known with both sought: whichever of them explains the readings.
  std::optional<KnownPrinter> known = {};

  /// With which the bed is sought when values are made.
  double bow_radius() const { return bed.is_bowed ? bed.radius : 0.0; }
};

/// @param radius  of the place of the readings, mm.
ReadingTrial try_readings(const DeltaGeometry& start, const DeltaReadings& readings, double radius);

}  // namespace paracal::detail
