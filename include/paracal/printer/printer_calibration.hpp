#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "paracal/printer/common_shift.hpp"
#include "paracal/printer/held_out.hpp"
#include "paracal/printer/projection.hpp"

namespace paracal {

/// Advice to the owner.
enum class PrinterAdvice : std::uint8_t {
  accept_new,     ///< the projected geometry should replace the saved one
  take_firmware,  ///< the firmware's fit should: it is better than the saved geometry, and ours is not better than it
  keep_saved,     ///< no other geometry is significantly better than the saved one
  accept_shift,   ///< likewise, except for the common shift of all heights, which the owner accepts
  check_input,    ///< the file or the readings are wrong: nothing is advised
};

/// "accept_new", ...
std::string_view name(PrinterAdvice advice);

/// Values that could be written, compared with the saved ones.
struct PrinterCandidate {
  DeltaGeometry geometry;
  PredictionErrors held_out;      ///< for held-out readings; 0 if there are too few
  PairedGain gain;                ///< of them
  bool some_kind_worse = false;   ///< significantly, for one kind of held-out readings
  double chance_better = 0.5;     ///< see chance_better(): above a plane
  double chance_above_bed = 0.5;  ///< the same above the estimated bed, which may be bowed
  double expected_shape = 0.0;    ///< see expected_shape(), mm
  /// Largest depth of the nozzle below the bed at z = 0, where heights were read and by the calibration, mm. Heights
  /// count without a shift that is stated and not accepted.
  double depth = 0.0;

  double least_chance() const { return std::min(chance_better, chance_above_bed); }
};

/// Whether the bed is flat, from heights and distances together.
struct BedFlatness {
  double radius = 0.0;        ///< of its edge, mm
  bool is_bowed = false;      ///< the readings exclude a plane; then the bow is estimated with the machine
  bool is_told = false;       ///< and a bias of all distances cannot explain that
  double edge = 0.0;          ///< above the centre, mm, without a bias unless that is significant
  double edge_std = kBedBow;  ///< mm
  double or_bias = 0.0;       ///< of all distances, mm, if the bed is flat; if bow and bias cannot be distinguished
};

/// Whether distances determine the size of prints.
struct PrintSize {
  bool bias_can_be_told = false;  ///< of all distances: their lengths differ enough
  bool bias_is_there = false;     ///< significant; then it is estimated with the machine
  double bias = 0.0;              ///< mm, if determined; distances are corrected if it is significant
  double bias_std = 0.0;          ///< mm; if not determined, that of typical readings
  double open = 0.0;              ///< half-width of the relative size error from an unknown bias (95 %)
};

/// A printer calibrated from its owner's measurements, beside the firmware's own fit.
struct PrinterCalibration {
  /// The saved geometry, judged by the firmware's cost; includes a common shift that is accepted, as all values do.
  DeltaFit saved;
  DeltaFit firmware;          ///< the optimum of that cost
  Measurements measurements;  ///< the readings as used by the calibration
  Calibration calibration;
  KnownPrinter known;             ///< from the calibration; its covariance includes bow and bias
  DeltaProjection projection;     ///< the new values for the controller
  PrinterCandidate written;       ///< the same as values to be written
  PrinterCandidate by_firmware;   ///< the firmware's fit, without outliers
  PredictionErrors held_out;      ///< of the saved values
  std::size_t groups = 0;         ///< of held-out readings; 0: there were too few
  double expected_shape = 0.0;    ///< of the saved values, mm
  bool saved_is_fit = false;      ///< the saved values are the firmware's fit of the readings
  DeltaAccuracy accuracy_before;  ///< of the saved geometry, if the calibration is right
  PrintSize size;
  BedFlatness bed;
  /// Of all heights. If it is stated and not accepted, all other results refer to readings without it.
  CommonShift shift;
  TriggerError trigger;                  ///< heights of the probe are corrected for it if it is stated
  std::vector<std::string> uncheckable;  ///< an error of 1 mm (of a distance 0.5 mm) would not be detected
  std::vector<std::string> findings;     ///< sentences: the advice, its reasons, what to measure
  PrinterAdvice advice = PrinterAdvice::keep_saved;

  bool tested() const { return groups > 0; }

  /// Whether other values than the saved ones are advised.
  bool is_advised() const;

  /// The geometry that the advice is for.
  const DeltaGeometry& advised() const;
};

struct PrinterCalibrationOptions {
  double print_radius = 0.0;   ///< of the bed, mm; 0: that of the readings
  bool tries_gross = true;     ///< whether an error of each reading would be detected: takes most of the time
  bool accepts_shift = false;  ///< a common shift of all heights is that of the bed
};

/// Calibrates with all errors of the machine, projects the result onto the controller's parameters, and judges these
/// new values in two ways. First by held-out readings, with the firmware's own formula, against the saved values and
/// the firmware's fit of the same readings. Second by the expected shape error where readings were taken, with bow of
/// the bed and bias of the distances estimated together: above a plane and above the bed.
///
/// Values are advised if they are significantly better than the saved ones and not worse on any kind of readings: see
/// better() in advice_rules.hpp. Outliers are excluded from every fit. Heights alone at fewer than 13 positions never
/// give new values.
///
/// Heights of the probe are corrected by a sheet of paper at the same places. Then the heights are corrected for their
/// common shift, unless the owner accepts it: then the bed has been moved, and all values include the shift. No values
/// are advised with which the nozzle at z = 0 is more than 0.2 mm below the bed anywhere.
/// @throws InvalidArgument without heights, for heights at one place only, or for readings that a machine with this
/// geometry cannot take.
PrinterCalibration calibrate_printer(const DeltaGeometry& saved, const DeltaReadings& readings,
                                     const PrinterCalibrationOptions& options = {});

}  // namespace paracal
