#include "figures.hpp"

#include <cmath>

namespace paracal::report::detail {

io::Json rounded(double value) {
  constexpr int kDigits = 6;
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, kDigits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  return std::isfinite(unit) ? std::round(value * unit) / unit : value;
}

io::Json rounded(const Eigen::Vector3d& vector) {
  return {rounded(vector.x()), rounded(vector.y()), rounded(vector.z())};
}

io::Json map_axes(const Workspace& workspace) {
  io::Json json;
  for (int k = 1; k <= kMapGrid.radii; ++k) json["radii_mm"].push_back(rounded(workspace.radius * k / kMapGrid.radii));
  for (int k = 0; k < kMapGrid.azimuths; ++k) json["azimuths_deg"].push_back(rounded(360.0 * k / kMapGrid.azimuths));
  const int layers = workspace.layers(kMapGrid.layers);
  for (int k = 0; k < layers; ++k) json["layers_mm"].push_back(rounded(workspace.layer_z(k, layers)));
  return json;
}

io::Json place_json(const Eigen::Vector3d& position) {
  return {{"x_mm", rounded(position.x())}, {"y_mm", rounded(position.y())}, {"z_mm", rounded(position.z())}};
}

}  // namespace paracal::report::detail
