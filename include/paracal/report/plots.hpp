#pragma once

#include "paracal/io/json.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/tolerance/characteristic.hpp"
#include "paracal/tolerance/statistics.hpp"

namespace paracal::report {

/// O2 against the number of points per circle, for the rough and the fine stage  [huang2016, Figs. 7, 8]:
///   {rough: {n, curve: [{n, O2, change}]}, fine: likewise}
io::Json observability(const Robot& robot);

/// 3 sigma of a characteristic over three layers of the workspace, at phi = 0  [huang2016, Fig. 6]:
///   {radii_mm, azimuths_deg, layers_mm, points: [{x_mm, y_mm, z_mm, value}]}, ordered as error_map().
/// @param factor  from mm or rad to the unit of the drawing.
io::Json three_sigma_map(const Robot& robot, Characteristic characteristic, const Tolerances& tolerances,
                         double factor);

/// A histogram in at most 40 equal bins from zero: {bin_width, counts, total}; larger values are in the last bin.
/// @param factor  as above.
io::Json histogram(const Histogram& histogram, double factor);

}  // namespace paracal::report
