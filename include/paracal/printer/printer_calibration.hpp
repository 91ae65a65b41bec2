#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "paracal/printer/projection.hpp"

namespace paracal {

/// Root mean square errors of readings predicted from all the others, mm: what the next reading would show.
struct PredictionErrors {
  double height = 0.0;    ///< 0 without heights
  double distance = 0.0;  ///< 0 without distances
};

/// What an owner is advised to do.
enum class PrinterAdvice : std::uint8_t {
  accept_new,     ///< the projected geometry should replace the saved one
  take_firmware,  ///< the firmware's own fit should: the saved one does not belong to the readings, ours is no better
  keep_saved,
};

/// A printer calibrated from what its owner measured, beside the firmware's own fit.
struct PrinterCalibration {
  DeltaFit saved;             ///< the geometry that the firmware has, judged by its cost
  DeltaFit firmware;          ///< the optimum of that cost
  Measurements measurements;  ///< the readings, as the calibration took them
  Calibration calibration;
  KnownPrinter known;                 ///< what the calibration says
  DeltaProjection projection;         ///< what the controller should be told
  DeltaAccuracy accuracy_before;      ///< of the saved geometry, if the calibration is right
  PredictionErrors predicted;         ///< by this calibration
  PredictionErrors by_firmware;       ///< by the firmware's fit
  std::vector<std::string> findings;  ///< in plain words: what could be told, what could not, what to do
  PrinterAdvice advice = PrinterAdvice::keep_saved;

  /// Whether there were readings enough to leave some out.
  bool tested() const { return by_firmware.height > 0.0; }

  /// The geometry that the advice is for.
  const DeltaGeometry& advised() const;
};

/// Readings left out one at a time and predicted from the rest, by the firmware's fit and by ours. Nothing of the
/// prediction has seen the reading: the nominal machine, too, is that which the firmware's fit finds in the rest.
/// Readings that contradict all others (named by the calibration) are predicted like the rest.
/// @param start  a geometry near the optimum.
/// @returns nothing where some fit fails, and where all but one reading are fewer than the firmware's parameters: such
/// a fit stays where it starts, and may know the reading from there.
std::optional<std::pair<PredictionErrors, PredictionErrors>> leave_one_out(const DeltaGeometry& start,
                                                                           const DeltaReadings& readings);

/// Calibrates with all errors of the machine and projects the answer onto what the controller holds.
///
/// New values are advised where readings that it had not seen are predicted better than by the firmware's fit; else the
/// findings warn.
/// @param print_radius  of the bed, mm; 0: as far out as the readings were taken.
/// @throws InvalidArgument without heights, or for readings that no machine with this geometry takes.
PrinterCalibration calibrate_printer(const DeltaGeometry& saved, const DeltaReadings& readings,
                                     double print_radius = 0.0);

}  // namespace paracal
