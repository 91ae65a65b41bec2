#pragma once

#include <optional>
#include <vector>

#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// Prediction errors of one reading from the others with values of a controller, by the firmware's own formula;
/// predicted - measured, mm. If a bias of the distances is estimated, all three are corrected for it.
struct HeldOutReading {
  bool distance = false;  ///< else a height
  /// With the saved values; if these are the firmware's fit of the same readings, with its fit of the others.
  double saved = 0.0;
  double firmware = 0.0;  ///< with the firmware's fit of the others
  double written = 0.0;   ///< with the new values after a calibration with the others
};

/// Root mean squares by kind, mm; 0 without readings.
struct PredictionErrors {
  double height = 0.0, distance = 0.0;
};

/// Relative reduction of the mean square error of held-out readings against the saved values. Each error is divided by
/// the noise of its kind of reading. 90 % interval from the pairs (Student's t): without any real gain `low` is above
/// zero in one case of 20.
struct PairedGain {
  double value = 0.0, low = 0.0, high = 0.0;
};

struct HeldOut {
  std::vector<HeldOutReading> readings;  ///< heights, then distances
  std::size_t groups = 0;                ///< of held-out readings

  PredictionErrors errors(double HeldOutReading::*by) const;
  PairedGain gain(double HeldOutReading::*by) const;
  /// Whether readings of one kind are predicted significantly worse than with the saved values (as `gain`).
  bool some_kind_worse(double HeldOutReading::*by) const;
};

/// Predicts readings from the others. A prediction never uses the reading itself; the nominal machine is also the
/// firmware's fit of the rest. One reading at a time; heights alone by sixths of the bed, because neighbours share the
/// unevenness of the bed.
/// @param start  a geometry near the optimum.
/// @param bow_radius  see PrinterFitOptions; predictions are those of the firmware, above a plane.
/// @param saved_is_fit  the saved values are the firmware's fit of these readings.
/// @returns nothing if a fit fails, or if the rest are fewer than the firmware's parameters: such a fit stays at its
/// start, which may depend on the reading.
std::optional<HeldOut> hold_out(const DeltaGeometry& start, const DeltaReadings& readings, bool seeks_bias,
                                double bow_radius, bool saved_is_fit);

}  // namespace paracal
