#pragma once

// Private to printer: both ways of knowing a printer from the same readings.

#include <optional>

#include "paracal/printer/projection.hpp"

namespace paracal::detail {

struct PrinterFit {
  DeltaFit firmware;
  DeltaGeometry nominal;   ///< the firmware's optimum, where it can be a printer; else where it started
  PrinterMachine printer;  ///< drawn like that; its controller holds what it started from, where that can be
  Measurements measurements;
  Calibration calibration;

  /// What the firmware is to be told after this calibration.
  DeltaProjection written() const;
};

struct PrinterFitOptions {
  bool seeks_bias = false;    ///< see printer_options()
  double print_radius = 0.0;  ///< of the bed, mm; 0: as far out as the printer goes
  bool states_use = false;    ///< U in use, of which trials have no need
};

/// @param start  a geometry near the firmware's optimum.
/// @returns empty where the machine does not close at every reading.
std::optional<PrinterFit> fit_printer(const DeltaGeometry& start, const DeltaReadings& readings,
                                      const PrinterFitOptions& options);

/// Whether the readings tell a bias of all distances from the size of the machine, and what they say.
struct BiasTrial {
  /// The bias is known to half of what nobody knows it by: that takes distances of different lengths.
  bool can_be_told = false;
  /// And it is there: sought, it is 2.5 of its standard deviations away from zero. One unbiased printer in 80 is taken
  /// for a biased one.
  bool is_there = false;
  double value = 0.0, std = kDistanceBias;  ///< mm
};
BiasTrial try_bias(const DeltaGeometry& start, const DeltaReadings& readings);

/// The machine as a fit knows it; a bias that was not sought counts with its standard deviation in the covariance.
KnownPrinter known_printer(const PrinterFit& fit, const DeltaReadings& readings, double bias_std);

}  // namespace paracal::detail
