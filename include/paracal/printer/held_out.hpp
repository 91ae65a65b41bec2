#pragma once

#include <optional>
#include <vector>

#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// One reading as it is predicted from the others by values that a controller holds, by the firmware's own formula;
/// predicted - measured, mm. A distance's bias, where one is sought, is taken off all three alike.
struct HeldOutReading {
  bool distance = false;  ///< else a height
  /// By the saved values as they are; where these are the firmware's fit of the very readings, by its fit of the
  /// others.
  double saved = 0.0;
  double firmware = 0.0;  ///< by the firmware's fit of the others
  double written = 0.0;   ///< by what would be written after a calibration with the others
};

/// Root mean squares by kind, mm; 0 where there are none.
struct PredictionErrors {
  double height = 0.0, distance = 0.0;
};

/// Against the saved values: by how much the mean square error of held-out readings, each over what readings of its
/// kind are worth, is less; of that of the saved values. An interval of 90 % from the pairs (Student's t), so that
/// `low` is above zero by chance in one case of 20.
struct PairedGain {
  double value = 0.0, low = 0.0, high = 0.0;
};

struct HeldOut {
  std::vector<HeldOutReading> readings;  ///< heights, then distances
  std::size_t groups = 0;                ///< in which they were held out

  PredictionErrors errors(double HeldOutReading::*by) const;
  PairedGain gain(double HeldOutReading::*by) const;
  /// Whether readings of one kind are predicted worse than by the saved values, by more than chance (as `gain`).
  bool some_kind_worse(double HeldOutReading::*by) const;
};

/// Holds readings out and predicts them from the others. Nothing of a prediction has seen what it predicts: the nominal
/// machine, too, is that which the firmware's fit finds in the rest. One at a time; heights alone by sixths of the bed,
/// for neighbours share what the bed is uneven by.
/// @param start  a geometry near the optimum.
/// @param bow_radius  see PrinterFitOptions: predictions are the firmware's, above a plane.
/// @param saved_is_fit  the saved values are the firmware's fit of these readings.
/// @returns nothing where some fit fails, and where the rest are fewer than the firmware's parameters: such a fit stays
/// where it starts, and may know the reading from there.
std::optional<HeldOut> hold_out(const DeltaGeometry& start, const DeltaReadings& readings, bool seeks_bias,
                                double bow_radius, bool saved_is_fit);

}  // namespace paracal
