#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// When a common shift is stated. Users of printers see 0.05 mm in a first layer.
struct ShiftLimits {
  double least = 0.05;            ///< mm
  double noises = 3.0;            ///< standard deviations of a height
  double varying = 0.15;          ///< difference of trigger heights from place to place that no probe repeats, mm
  std::size_t fewest = 3;         ///< places of paper that show it,
  std::size_t fewest_probed = 7;  ///< and of the probe
  double probe = 0.02;            ///< standard deviation of a height, to compare paper and probe, mm
  std::size_t trimmed = 10;  ///< from so many heights on, the least and the largest are put aside: one may be wrong
};

/// The common error of all heights of a bed against the saved values: the part that every height shares. A shape (a
/// wrong radius with a levelled rim) has none. A missing trigger height looks like a bed that was moved. Values that
/// follow a missing trigger height would drive the nozzle into the bed.
struct CommonShift {
  double value = 0.0;               ///< by which the bed is at least higher than by the saved values, or lower, mm
  bool is_stated = false;           ///< it is significant, and a wrong file does not explain it
  bool is_accepted = false;         ///< by the owner: the saved values then include it
  bool is_by_hand = false;          ///< some heights were measured by hand, with the nozzle itself
  bool has_wrong_sign = false;      ///< the probe triggers below the bed, which is impossible: it is never accepted
  std::array<double, 3> endstop{};  ///< of the saved values with it, mm

  /// Most likely first; empty where it is not stated.
  std::vector<std::string> likely_causes() const;
};

/// The smallest height of the bed by the saved values if all have one sign, else 0.
/// @param noise  standard deviation of a height, mm.
CommonShift common_shift(const DeltaGeometry& saved, const DeltaReadings& readings, double noise,
                         const ShiftLimits& limits = {});

/// What a sheet of paper and the probe say of the same places: the paper shows where the nozzle touches.
struct TriggerError {
  double value = 0.0;      ///< bed by the paper above the bed by the probe, mm; median
  double spread = 0.0;     ///< of the paper by values that level the probe's heights, mm; 0: no worse than by the saved
  std::size_t places = 0;  ///< with both
  bool is_stated = false;  ///< one difference explains them
  bool varies = false;     ///< from place to place: no reading of this probe counts
};
TriggerError trigger_error(const DeltaGeometry& saved, const DeltaReadings& readings, const ShiftLimits& limits = {});

/// The readings with heights of the probe that agree with the paper; without them if their trigger height varies.
DeltaReadings by_paper(DeltaReadings readings, const TriggerError& error);

/// The geometry for a bed that is higher by `shift`: endstops, and shoulders of a rotary delta, are lower by it.
DeltaGeometry with_bed_higher(const DeltaGeometry& geometry, double shift);

/// The readings without the shift.
DeltaReadings without_shift(DeltaReadings readings, double shift);

}  // namespace paracal
