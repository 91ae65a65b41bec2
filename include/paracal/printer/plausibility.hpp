#pragma once

#include <string>
#include <vector>

#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// How far the parts of a delta may be from each other and from the file before somebody has mistyped something. Wide:
/// of 14 published printers the worst has towers 2.3 deg and rods 5 % from what they are meant to be.
struct PrinterLimits {
  double tower = 0.087;           ///< from the design angle, rad: 5 deg
  double rods_apart = 0.08;       ///< longest over shortest, less 1
  double endstops_apart = 0.08;   ///< likewise, over the mean length of the rods
  double smallest_radius = 0.25;  ///< of the delta radius over the rods (linear)
  double largest_radius = 0.75;   ///< likewise
  double changed = 0.05;          ///< radius, rods, endstops by the readings against the file
  double worst_height = 1.0;      ///< root mean square that the best fit leaves, mm
  double worst_distance = 1.5;    ///< likewise, mm
  double worst_repeat = 0.2;      ///< by which two heights of one place may differ, mm
  /// Root mean square by the file above which steps that suit it better are sought, mm; and towers in another order.
  double worst_saved = 2.0, least_notable = 0.1;
};

/// What cannot be: of the geometry as it is stated; one sentence each, empty where all is well.
std::vector<std::string> implausible(const DeltaGeometry& geometry, const PrinterLimits& limits = {});

/// What cannot be of the readings with this geometry: what a fit of them leaves, and by how much it would have to
/// change the printer; the likely cause first, where there is one: readings multiplied by a ratio of gears, micro-steps
/// or motors, or of towers in another order, that the stated printer explains.
/// @param fit  the firmware's, without gross readings.
std::vector<std::string> implausible(const DeltaGeometry& saved, const DeltaReadings& readings, const DeltaFit& fit,
                                     const PrinterLimits& limits = {});

/// Whether steps of another size (of all towers or of one) suit the file much better than a common shift of all heights
/// does.
/// @param readings  as they were read.
/// @param shifted   the same without the shift.
bool has_wrong_steps(const DeltaGeometry& saved, const DeltaReadings& readings, const DeltaReadings& shifted);

}  // namespace paracal
