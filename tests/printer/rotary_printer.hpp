#pragma once

#include <string>

#include "paracal/printer/delta_geometry.hpp"
#include "paracal/printer/printer_machine.hpp"

namespace paracal::test {

/// A rotary delta nobody has built: nobody publishes measurements of one. Its firmware believes `saved`.
struct RotaryPrinter {
  DeltaGeometry saved, actual;
  PrinterMachine machine;  ///< of `actual`
  SourceErrors errors;     ///< of this machine: what its geometry assumes, and what no firmware knows
  DeltaReadings readings;  ///< of the machine, with noise, in whole micro-steps
  std::string config;      ///< printer.cfg with `saved` and the readings
};

/// Heights at 13 places of the bed (the probe repeats to 0.02 mm), 12 distances (calliper 0.05 mm, walls 0.1 mm too
/// thick).
RotaryPrinter rotary_printer(unsigned seed = 1);

}  // namespace paracal::test
