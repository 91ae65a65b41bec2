#pragma once

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// A delta printer as a robot: the firmware's frame moved so that {O} lies at the height of the homed carriages, or of
/// the shoulders.
///
///   z of the robot = z of the firmware + bed        q_i = homed_i - drop_i
struct PrinterMachine {
  /// Without errors what the firmware has. Its geometry: towers at their design angles, one radius, rods and arms of
  /// mean lengths; its limbs are intended to differ by what the firmware has otherwise. The controller's origin is on
  /// the bed.
  Robot robot;
  SourceErrors design;  ///< the errors that would make it that geometry with limbs alike: where parts are drawn
  double bed = 0.0;     ///< height of the firmware's z = 0, mm
  Joints homed;         ///< at the endstops: 0 of carriages, the angles of arms, rad

  Joints joints_at(const JointDrops& drops) const;
};

/// @param firmware  what the firmware has.
/// @param like      whose means the drawing has: a geometry that is nearer to the machine.
/// @param print_radius  of the bed, mm; 0: most of what the printer reaches. Readings say where a printer is known.
/// What a firmware does not know (radius of the effector, width of its rods' pairs) is taken as in linear_delta; it
/// matters only for tilt. Tolerances are those of printers: see printer_tolerances().
/// @throws InvalidArgument for a geometry that makes no sense.
PrinterMachine printer_machine(const DeltaGeometry& firmware, const DeltaGeometry& like, double print_radius = 0.0);
inline PrinterMachine printer_machine(const DeltaGeometry& geometry, double print_radius = 0.0) {
  return printer_machine(geometry, geometry, print_radius);
}

/// Half-widths (3 sigma) of a printer's parts against each other. Linear: rails within 1.5 mm of where they belong
/// (towers of 14 published printers are 0.15 deg off in the median, 0.4 mm on their radius) and upright to 0.08 deg,
/// rods alike to 0.5 mm. Rotary, of which nobody has published any: shoulders within 0.3 mm, motor axes within 0.3 deg,
/// rods and arms cut in one jig alike to 0.1 mm. Endstops anywhere within 10 mm or 5 deg, ball joints as people
/// assemble them.
Tolerances printer_tolerances(const Geometry& geometry);

/// What the limbs of a printer share: the delta radius and the lengths of rods and arms. Nobody has measured the radius
/// (5 mm, standard deviation). Distances tell the lengths; heights alone hardly do, and then they are taken to be as
/// they are typed, to 0.5 mm.
std::vector<CommonError> printer_common_errors(const Robot& robot, bool has_distances);

/// The readings as stations (named by kind and number, from 0 as in printer.cfg), heights above one bed, and distances.
/// @throws InvalidArgument where the firmware's geometry does not close.
Measurements printer_measurements(const PrinterMachine& printer, const DeltaGeometry& geometry,
                                  const DeltaReadings& readings);

/// By how much all distances of an object may be read too long (walls too thick or too thin, a calliper's zero), mm,
/// standard deviation.
inline constexpr double kDistanceBias = 0.2;

/// By how much the edge of a bed lies above its centre (glass that bends, a plate that heats unevenly), mm, standard
/// deviation.
inline constexpr double kBedBow = 0.12;

/// How printers are measured: probes repeat to 0.02 mm, callipers on printed pillars to 0.05 mm; beds are square to the
/// rails within 0.5 mrad. These, the tolerances and the common errors are alike for all printers.
/// @param seeks_bias  a bias of all distances is one of the unknowns.
CalibrationOptions printer_options(const PrinterMachine& printer, const DeltaReadings& readings, bool seeks_bias);

}  // namespace paracal
