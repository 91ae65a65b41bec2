#pragma once

#include <optional>
#include <string>
#include <vector>

#include "paracal/printer/delta_geometry.hpp"

namespace paracal {

/// Largest differences of the parts of a delta from each other and from the file that are plausible. The limits are
/// wide: the worst of 14 published printers has errors of 2.3 deg (towers) and 5 % (rods).
struct PrinterLimits {
  double tower = 0.087;           ///< from the design angle, rad: 5 deg
  double rods_apart = 0.08;       ///< longest over shortest, less 1
  double endstops_apart = 0.08;   ///< likewise, over the mean length of the rods
  double smallest_radius = 0.25;  ///< of the delta radius over the rods (linear)
  double largest_radius = 0.75;   ///< likewise
  double changed = 0.05;          ///< radius, rods, endstops by the readings against the file
  double worst_height = 1.0;      ///< root mean square residual of the best fit, mm
  double worst_distance = 1.5;    ///< likewise, mm
  double worst_repeat = 0.2;      ///< difference of two heights at one position, mm
  /// Root mean square residual of the file above which other step sizes are tried, mm, and other orders of the towers.
  double worst_saved = 2.0, least_notable = 0.1;
  double lowest_trigger = -1.0;  ///< height of the nozzle when a probe triggers, mm: beds give way by less
  double least_spread = 5.0;     ///< of the places of heights, mm: nearer ones show no slope and no radius
};

/// Implausible properties of the stated geometry, one sentence each; empty if there are none.
std::vector<std::string> implausible(const DeltaGeometry& geometry, const PrinterLimits& limits = {});

/// Implausible properties of the readings with this geometry: large residuals of a fit, and large changes of the
/// printer by it. The likely cause comes first: the stated printer explains the readings with a ratio of gears,
/// micro-steps or motors (of all readings, or of heights or distances alone), or with another order of the towers.
/// @param fit  that of the firmware, without outliers.
std::vector<std::string> implausible(const DeltaGeometry& saved, const DeltaReadings& readings, const DeltaFit& fit,
                                     const PrinterLimits& limits = {});

/// What forbids a calibration before any fit: heights that a probe stated with the wrong sign, with the endstops that
/// the right sign gives.
std::optional<std::string> wrong_sign(const DeltaGeometry& saved, const DeltaReadings& readings,
                                      const PrinterLimits& limits = {});

/// @throws InvalidArgument where all heights were read at one place, which shows no slope and no radius.
void require_places(const DeltaGeometry& saved, const DeltaReadings& readings, const PrinterLimits& limits = {});

/// Whether another step size (of all towers or of one, of all readings or of one kind) fits the file much better than a
/// common shift of all heights.
///
/// @param readings  as measured.
/// @param shifted   the same without the shift.
bool has_wrong_steps(const DeltaGeometry& saved, const DeltaReadings& readings, const DeltaReadings& shifted);

}  // namespace paracal
