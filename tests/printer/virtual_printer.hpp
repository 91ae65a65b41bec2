#pragma once

#include <iosfwd>

#include "paracal/printer/projection.hpp"

namespace paracal::test {

/// What is true of printers, their readings and their saved values.
struct PrinterWorld {
  double bias = 0.0;         ///< of every distance, mm
  double leaning = 1.0;      ///< rails lean so many times their tolerance
  double unlike_rods = 0.1;  ///< standard deviation of each, mm
  int heights = 13;          ///< 7, 13 or more
  int distances = 0;
  bool two_lengths = false;
  /// The saved values are the firmware's fit of seven heights and twelve distances read before; else as they were
  /// drawn.
  bool calibrated_before = false;
  bool saved_is_fit = false;  ///< the saved values are the firmware's fit of the very readings
  double bow = 0.0;           ///< of the bed's edge above its centre, mm

  bool operator==(const PrinterWorld&) const = default;
};
/// As tests of a world are named.
void PrintTo(const PrinterWorld& world, std::ostream* out);

/// A linear delta nobody has built.
struct VirtualPrinter {
  DeltaGeometry saved;
  PrinterMachine machine;
  SourceErrors errors;
  FoundPlane bed;
  BedBow bow;
  DeltaReadings readings;  ///< of the machine, with noise, in whole micro-steps
  double radius = 0.0;     ///< of the bed, mm

  KnownPrinter truth() const { return {machine, errors, bed, {}, {}, bow}; }
  /// Error of shape over the bed with values in the firmware, root mean square, mm.
  double shape_error(const DeltaGeometry& values) const { return accuracy_of(truth(), values).shape_rms; }
  /// Whether values are better in shape than others above what z is counted from.
  bool is_better(const DeltaGeometry& values, const DeltaGeometry& than, CountedFrom above) const {
    return chance_better(truth(), values, than, above) > 0.5;
  }
  /// Mean share by which prints are too large with values in the firmware.
  double size_error(const DeltaGeometry& values) const;
};

/// Parts differ from what the firmware was told as printer_tolerances() says (half-widths are 3 sigma); radius and rods
/// by 0.5 mm, endstops by 0.4 mm. Probes repeat to 0.02 mm, callipers to 0.05 mm.
VirtualPrinter virtual_printer(const PrinterWorld& world, unsigned seed);

}  // namespace paracal::test
