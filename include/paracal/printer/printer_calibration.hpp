#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "paracal/printer/common_shift.hpp"
#include "paracal/printer/held_out.hpp"
#include "paracal/printer/projection.hpp"

namespace paracal {

/// What an owner is advised to do.
enum class PrinterAdvice : std::uint8_t {
  accept_new,     ///< the projected geometry should replace the saved one
  take_firmware,  ///< the firmware's own fit should: it is better than the saved one, and ours no better than it
  keep_saved,     ///< nothing is better than the saved one by more than chance
  accept_shift,   ///< likewise, but for the common shift of all heights, which the owner accepts
  check_input,    ///< the file or the readings are wrong: nothing is advised
};

/// "accept_new", ...
std::string_view name(PrinterAdvice advice);

/// Values that could be written, against the saved ones.
struct PrinterCandidate {
  DeltaGeometry geometry;
  PredictionErrors held_out;      ///< of readings that the values have not seen; 0 where none could be held out
  PairedGain gain;                ///< of them
  bool some_kind_worse = false;   ///< of them, by more than chance
  double chance_better = 0.5;     ///< see chance_better(): by all that is known, above a plane
  double chance_above_bed = 0.5;  ///< the same above the bed as it is known, which may be bowed
  double expected_shape = 0.0;    ///< see expected_shape(), mm

  double least_chance() const { return std::min(chance_better, chance_above_bed); }
};

/// Whether the bed is a plane, as far as heights and distances show it together.
struct BedFlatness {
  double radius = 0.0;        ///< of its edge, mm
  bool is_bowed = false;      ///< a plane contradicts the readings; then the bow was sought with everything else
  bool is_told = false;       ///< and no bias of all distances explains that
  double edge = 0.0;          ///< above the centre, mm, if there is no bias but one that was told
  double edge_std = kBedBow;  ///< mm
  double or_bias = 0.0;       ///< of all distances, mm, if the bed is a plane; where the bow is not told from it
};

/// Whether distances show how large prints become.
struct PrintSize {
  bool bias_can_be_told = false;  ///< of all distances alike: they have lengths that differ enough
  bool bias_is_there = false;     ///< told from zero; then it was sought with everything else
  double bias = 0.0;              ///< mm, where it can be told; taken off where it is there
  double bias_std = 0.0;          ///< mm; where it cannot be told, of what is usual
  double open = 0.0;              ///< half-width of what the size of prints is off by for want of knowing it (95 %)
};

/// A printer calibrated from what its owner measured, beside the firmware's own fit.
struct PrinterCalibration {
  /// The geometry that the firmware has, judged by its cost; with a common shift that is accepted, as all values are.
  DeltaFit saved;
  DeltaFit firmware;          ///< the optimum of that cost
  Measurements measurements;  ///< the readings, as the calibration took them
  Calibration calibration;
  KnownPrinter known;             ///< what the calibration says; bow and bias count in its covariance
  DeltaProjection projection;     ///< what the controller should be told
  PrinterCandidate written;       ///< the same as values to be written
  PrinterCandidate by_firmware;   ///< the firmware's fit, gross readings left out
  PredictionErrors held_out;      ///< of the saved values, as of the candidates
  std::size_t groups = 0;         ///< in which readings were held out; 0: there were too few
  double expected_shape = 0.0;    ///< of the saved values, mm
  bool saved_is_fit = false;      ///< the saved values are the firmware's fit of the readings
  DeltaAccuracy accuracy_before;  ///< of the saved geometry, if the calibration is right
  PrintSize size;
  BedFlatness bed;
  /// Of all heights. Where it is stated and not accepted, all else is that of readings without it.
  CommonShift shift;
  std::vector<std::string> uncheckable;  ///< readings that could be wrong by 1 mm (a distance 0.5) unnoticed
  std::vector<std::string> findings;     ///< in plain words: what could be told, what could not, what to do
  PrinterAdvice advice = PrinterAdvice::keep_saved;

  bool tested() const { return groups > 0; }

  /// Whether other values than the saved ones are.
  bool is_advised() const;

  /// The geometry that the advice is for.
  const DeltaGeometry& advised() const;
};

struct PrinterCalibrationOptions {
  double print_radius = 0.0;   ///< of the bed, mm; 0: as far out as the readings were taken
  bool tries_gross = true;     ///< put every reading off in turn to see whether it would be noticed: most of the time
  bool accepts_shift = false;  ///< a common shift of all heights is the bed's
};

/// Calibrates with all errors of the machine, projects the answer onto what the controller holds, and judges the values
/// that would be written: readings that they have not seen, by the firmware's own formula, against the saved values and
/// the firmware's fit of the same readings; and over the place of the readings by what is known, bow of the bed and
/// bias of the distances sought beside each other: above a plane and above the bed.
///
/// Values are advised where they are better than the saved ones by more than chance, and on no kind of readings worse:
/// see better() in advice.hpp. Gross readings leave every fit. Heights alone of fewer than 13 places never make new
/// values.
///
/// A common shift of all heights above 0.5 mm is taken off them first, and no values are advised that move the nozzle
/// at the bed's centre down by more, unless the owner accepts it: then the bed has been moved, the saved values count
/// with it, and so do all others.
/// @throws InvalidArgument without heights, or for readings that no machine with this geometry takes.
PrinterCalibration calibrate_printer(const DeltaGeometry& saved, const DeltaReadings& readings,
                                     const PrinterCalibrationOptions& options = {});

}  // namespace paracal
