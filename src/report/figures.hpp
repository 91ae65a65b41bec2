#pragma once

// Private to report: what figures share.

#include "paracal/io/json.hpp"
#include "paracal/mechanism/workspace.hpp"
#include "paracal/tolerance/workspace_samples.hpp"

namespace paracal::report::detail {

/// Six digits: more than a drawing shows, a third of the bytes. Numbers that are not finite become null.
io::Json rounded(double value);
io::Json rounded(const Eigen::Vector3d& vector);

/// The points of every map: three layers, six circles of 24 points around the axis.
inline constexpr PolarGrid kMapGrid{.radii = 6, .azimuths = 24, .layers = 3};

/// {radii_mm, azimuths_deg, layers_mm} of that grid, in the cylinder around the workspace.
io::Json map_axes(const Workspace& workspace);

/// {x_mm, y_mm, z_mm}
io::Json place_json(const Eigen::Vector3d& position);

}  // namespace paracal::report::detail
