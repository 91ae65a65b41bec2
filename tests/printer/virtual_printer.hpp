#pragma once

#include <iosfwd>
#include <vector>

#include "paracal/printer/printer_machine.hpp"

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

/// A bed in the robot's frame: z = height + slope_x x + slope_y y, and its edge above its centre.
struct VirtualBed {
  double height = 0.0, slope_x = 0.0, slope_y = 0.0;
  double edge = 0.0, radius = 1.0;

  /// Of its surface above the plane.
  double bow_at(const Eigen::Vector3d& p) const { return edge * (p.head<2>().squaredNorm() / (radius * radius) - 0.5); }
};

/// A linear delta nobody has built.
struct VirtualPrinter {
  DeltaGeometry saved;
  PrinterMachine machine;
  SourceErrors errors;
  VirtualBed bed;
  DeltaReadings readings;  ///< of the machine, with noise, in whole micro-steps
  double radius = 0.0;     ///< of the bed, mm

  /// Where the nozzle is with these drops: x and y along the bed, z above its plane.
  Eigen::Vector3d place(const JointDrops& drops) const;
  /// Height of the nozzle above the bed at z = 0 with values in the firmware: root mean square over the bed, mm.
  double first_layer(const DeltaGeometry& values) const;
  /// Largest depth of the nozzle below the bed, mm.
  double depth(const DeltaGeometry& values) const;
  /// Mean share by which prints are too large with values in the firmware.
  double size_error(const DeltaGeometry& values) const;

 private:
  std::vector<double> heights(const DeltaGeometry& values) const;
};

/// Parts differ from what the firmware was told as printer_tolerances() says (half-widths are 3 sigma); radius and rods
/// by 0.5 mm, endstops by 0.4 mm. Probes repeat to 0.02 mm, callipers to 0.05 mm.
VirtualPrinter virtual_printer(const PrinterWorld& world, unsigned seed);

}  // namespace paracal::test
