#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/printer/common_shift.hpp"
#include "paracal/printer/ladder.hpp"
#include "paracal/printer/program_calibration.hpp"

namespace paracal {

/// Advice to the owner.
enum class PrinterAdvice : std::uint8_t {
  accept_new,    ///< the values of a rung of the ladder should replace the saved ones
  keep_saved,    ///< no rung is allowed
  accept_shift,  ///< likewise, except for the common shift of all heights, which the owner accepts
  check_input,   ///< the file or the readings are wrong: nothing is advised
};

/// "accept_new", ...
std::string_view name(PrinterAdvice advice);

/// A printer calibrated from its owner's measurements.
struct PrinterCalibration {
  /// The saved geometry, judged by the firmware's cost; includes a common shift that is accepted, as all values do.
  DeltaFit saved;
  DeltaFit firmware;                       ///< the optimum of that cost
  Ladder ladder;                           ///< of readings without a shift that is stated and not accepted
  ProgramCalibration programs;             ///< for the correction of programs
  CommonShift shift;                       ///< of all heights
  TriggerError trigger;                    ///< heights of the probe are corrected for it if it is stated
  double print_radius = 0.0;               ///< of the disk of the ladder, mm
  std::vector<std::string> findings = {};  ///< what to do, with both figures; then at most five notes
  std::vector<std::string> details = {};   ///< the rest
  PrinterAdvice advice = PrinterAdvice::keep_saved;

  /// Whether other values than the saved ones are advised.
  bool is_advised() const { return advice == PrinterAdvice::accept_new || advice == PrinterAdvice::accept_shift; }

  /// The geometry that the advice is for.
  const DeltaGeometry& advised() const {
    return advice == PrinterAdvice::accept_new ? ladder.best().geometry : saved.geometry;
  }
};

struct PrinterCalibrationOptions {
  double print_radius = 0.0;   ///< of the bed, mm; 0: that of the readings
  bool accepts_shift = false;  ///< a common shift of all heights is that of the bed
  LadderPriors priors = {};
  LadderRules rules = {};
};

/// Judges the rungs of the ladder, and calibrates with all errors of the machine for the correction of programs.
///
/// Heights of the probe are corrected by a sheet of paper at the same places. Then the heights are corrected for their
/// common shift, unless the owner accepts it: then the bed has been moved, and all values include the shift.
/// @throws InvalidArgument without heights, for heights at one place only, or for readings that a machine with this
/// geometry cannot take.
PrinterCalibration calibrate_printer(const DeltaGeometry& saved, const DeltaReadings& readings,
                                     const PrinterCalibrationOptions& options = {});

}  // namespace paracal
