#pragma once

#include "paracal/calibration/prediction.hpp"
#include "paracal/io/json.hpp"

namespace paracal::report {

/// Errors over the workspace, before and after calibration, layer by layer  [huang2016, Fig. 9]:
///
///   before  errors of the machine with the known errors if its controller uses the nominal robot, relative to the
///           commanded pose: distance to home |d_rho|, position after the best rigid motion of all points, rotation
///           |d_phi|
///   after   expanded uncertainty U = k std of the same quantities, from the covariance of the errors;
///           null without covariance. Only estimated errors contribute
///
///   {radii_mm, azimuths_deg, layers_mm (top first), coverage_factor, points: [{x_mm, y_mm, z_mm, distance_before_mm,
///    distance_after_mm, position_before_mm, position_after_mm, rotation_before_deg, rotation_after_deg}]}
/// Points: layer by layer, the axis first, then the circles from inside out. Rotations are absent for a rigid plate.
///
/// @throws Unreachable if the machine cannot reach some point.
io::Json error_map(const Robot& robot, const KnownErrors& known);

}  // namespace paracal::report
