#pragma once

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// A delta printer as a robot: the firmware's frame is moved so that {O} is at the height of the homed carriages, or of
/// the shoulders.
///
///   z of the robot = z of the firmware + bed        q_i = homed_i - drop_i
struct PrinterMachine {
  /// Without errors it is the geometry of the firmware: towers at their design angles, one radius, rods and arms of
  /// mean lengths. Other values of the firmware are differences of the limbs. The controller's origin is on
  /// the bed.
  Robot robot;
  SourceErrors design;  ///< errors that turn equal limbs into that geometry: the design positions
  double bed = 0.0;     ///< height of the firmware's z = 0, mm
  Joints homed;         ///< at the endstops: 0 of carriages, the angles of arms, rad

  Joints joints_at(const JointDrops& drops) const;
};

/// @param firmware  geometry of the firmware.
/// @param like      a geometry nearer to the machine, whose means are the nominal values.
/// @param print_radius  of the bed, mm; 0: most of the reach. A printer is known only where readings were taken.
/// Dimensions that are not in a firmware (radius of the effector, width of the pairs of rods) are those of
/// linear_delta; they affect only tilt. Tolerances are those of printers: see printer_tolerances().
/// @throws InvalidArgument for an implausible geometry.
PrinterMachine printer_machine(const DeltaGeometry& firmware, const DeltaGeometry& like, double print_radius = 0.0);
inline PrinterMachine printer_machine(const DeltaGeometry& geometry, double print_radius = 0.0) {
  return printer_machine(geometry, geometry, print_radius);
}

/// Half-widths (3 sigma) of the parts of a printer. Linear: rails within 1.5 mm of their design positions and upright
/// to 0.08 deg, equal rods to 0.5 mm. (Towers of 14 published printers are 0.15 deg off in the median: 0.4 mm on their
/// radius.) Rotary (no published data): shoulders within 0.3 mm, motor axes within 0.3 deg, equal rods and arms to
/// 0.1 mm (cut in one jig). Endstops within 10 mm or 5 deg; ball joints as usually assembled.
///
Tolerances printer_tolerances(const Limbs& limbs);

/// Common errors of the limbs of a printer: the delta radius and the lengths of rods and arms. The radius is not
/// measured (standard deviation 5 mm). Distances determine the lengths. Heights alone hardly do; then the stated
/// lengths are assumed to 0.5 mm.
std::vector<CommonError> printer_common_errors(const Robot& robot, bool has_distances);

/// The readings as stations (named by kind and number, from 0 as in printer.cfg), heights above one bed, and distances.
/// @throws InvalidArgument where the firmware's geometry does not close.
Measurements printer_measurements(const PrinterMachine& printer, const DeltaGeometry& geometry,
                                  const DeltaReadings& readings);

/// Common error of all distances of an object (walls too thick or too thin, zero of the calliper), mm, standard
/// deviation.
inline constexpr double kDistanceBias = 0.2;

/// Measurements of printers: probes repeat to 0.02 mm, callipers on printed pillars to 0.05 mm; beds are perpendicular
/// to the rails within 0.5 mrad. These, the tolerances and the common errors are the same for all printers.
/// @param seeks_bias  a bias of all distances is one of the unknowns.
CalibrationOptions printer_options(const PrinterMachine& printer, const DeltaReadings& readings, bool seeks_bias);

}  // namespace paracal
