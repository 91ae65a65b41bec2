#include "paracal/mechanism/workspace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "described_limbs.hpp"
#include "paracal/error.hpp"

namespace paracal {

namespace {

constexpr double kQuarter = 0.5 * std::numbers::pi;

/// On the square of half width 1, at an azimuth that runs evenly along its sides.
Eigen::Vector2d on_square(double azimuth) {
  const double side = std::round(azimuth / kQuarter);
  const double along = std::clamp((azimuth - side * kQuarter) / (0.5 * kQuarter), -1.0, 1.0);
  switch (static_cast<int>(std::remainder(side, 4.0))) {
    case 0:
      return {1.0, along};
    case 1:
      return {-along, 1.0};
    case -1:
      return {along, -1.0};
    default:
      return {-1.0, -along};
  }
}

/// That azimuth of a place.
double square_azimuth(const Eigen::Vector2d& place) {
  const double side = std::round(std::atan2(place.y(), place.x()) / kQuarter);
  const Eigen::Vector2d turned = Eigen::Rotation2Dd(-side * kQuarter) * place;
  return kQuarter * (side + (turned.x() > 0.0 ? 0.5 * turned.y() / turned.x() : 0.0));
}

/// A point of [low, high] by its place on [-1, 1], exact at the ends.
double between(const std::array<double, 2>& range, double place) {
  return std::lerp(range[0], range[1], 0.5 * (1.0 + place));
}

double middle(const std::array<double, 2>& range) { return between(range, 0.0); }

void require_range(const char* key, const std::array<double, 2>& range, bool may_be_flat) {
  const auto [low, high] = range;
  if (std::isfinite(low) && std::isfinite(high) && (low < high || (may_be_flat && low == high))) return;
  throw InvalidArgument(fmt::format("workspace.{}: expected [smallest, largest], got [{:g}, {:g}] mm", key, low, high));
}

}  // namespace

Workspace Workspace::of_box(const Box& box) {
  Workspace workspace{.radius = 0.5 * std::hypot(box.x[1] - box.x[0], box.y[1] - box.y[0]),
                      .height = box.z[1] - box.z[0],
                      .top_z = box.z[1]};
  workspace.axis = {middle(box.x), middle(box.y)};
  workspace.box = box;
  return workspace;
}

Workspace Workspace::of_levels(std::vector<Level> levels) {
  Workspace workspace;
  if (levels.empty()) return workspace;
  workspace.radius = std::ranges::max_element(levels, {}, &Level::radius)->radius;
  workspace.height = levels.front().z - levels.back().z;
  workspace.top_z = levels.front().z;
  workspace.levels = std::move(levels);
  return workspace;
}

Workspace Workspace::about_centre(double size) const {
  Workspace small = *this;
  small.radius = size;
  small.height = std::min(height, size);
  small.top_z = centre().z();
  small.box.reset();
  small.levels.clear();
  return small;
}

Workspace::Keys Workspace::keys() const {
  if (box) return {"x_mm", "z_mm", "z_mm"};
  if (!levels.empty()) return {"radii_mm", "heights_mm", "heights_mm"};
  return {"radius_mm", "height_mm", "top_z_mm"};
}

void Workspace::check_shape() const {
  if (box) {
    require_range("x_mm", box->x, false);
    require_range("y_mm", box->y, false);
    require_range("z_mm", box->z, true);
  }
  for (std::size_t k = 0; k < levels.size(); ++k) {
    detail::require_positive_mm("workspace.radii_mm", levels[k].radius);
    if (k == 0 || levels[k].z < levels[k - 1].z) continue;
    throw InvalidArgument(fmt::format("workspace.heights_mm: expected heights from the top down, got {:g} after {:g}",
                                      levels[k].z, levels[k - 1].z));
  }
  detail::require_positive_mm(fmt::format("workspace.{}", keys().radius), radius);
}

Eigen::Vector3d Workspace::at(double share, double azimuth, double depth) const {
  const double z = top_z - height * depth;
  if (box) {
    const Eigen::Vector2d place = share * on_square(azimuth);
    return {between(box->x, place.x()), between(box->y, place.y()), z};
  }
  Eigen::Vector3d place = on_circle(radius_at(z) * share, azimuth, z);
  place.head<2>() += axis;
  return place;
}

Eigen::Vector3d Workspace::shares_of(const Eigen::Vector3d& place) const {
  const Eigen::Vector2d from_axis = place.head<2>() - axis;
  const double depth = is_flat() ? 0.0 : (top_z - place.z()) / height;
  if (box) {
    const Eigen::Vector2d on_it =
        from_axis.cwiseQuotient(0.5 * Eigen::Vector2d(box->x[1] - box->x[0], box->y[1] - box->y[0]));
    return {on_it.cwiseAbs().maxCoeff(), square_azimuth(on_it), depth};
  }
  return {std::hypot(from_axis.x(), from_axis.y()) / radius_at(place.z()), std::atan2(from_axis.y(), from_axis.x()),
          depth};
}

bool Workspace::contains(const Eigen::Vector3d& place, double slack) const {
  if (place.z() > top_z + slack || place.z() < top_z - height - slack) return false;
  if (!box) return (place.head<2>() - axis).norm() <= radius_at(place.z()) + slack;
  return place.x() >= box->x[0] - slack && place.x() <= box->x[1] + slack && place.y() >= box->y[0] - slack &&
         place.y() <= box->y[1] + slack;
}

Eigen::AlignedBox3d Workspace::bounds() const {
  const double bottom = top_z - height;
  if (box) return {Eigen::Vector3d(box->x[0], box->y[0], bottom), Eigen::Vector3d(box->x[1], box->y[1], top_z)};
  return {Eigen::Vector3d(axis.x() - radius, axis.y() - radius, bottom),
          Eigen::Vector3d(axis.x() + radius, axis.y() + radius, top_z)};
}

double Workspace::half_width(int along) const { return (at(1.0, along * kQuarter, 0.5) - centre())[along]; }

double Workspace::farthest() const {
  return std::hypot(axis.norm() + radius, std::max(std::abs(top_z), std::abs(top_z - height)));
}

std::vector<double> Workspace::edge_depths() const {
  if (is_flat()) return {0.0};
  if (levels.empty()) return {0.0, 1.0};
  std::vector<double> depths;
  for (const Level& level : levels) depths.push_back((top_z - level.z) / height);
  return depths;
}

std::vector<double> Workspace::edge_azimuths() const {
  if (!box) return {};
  return {0.5 * kQuarter, 1.5 * kQuarter, 2.5 * kQuarter, 3.5 * kQuarter};
}

double Workspace::layer_area(double depth) const { return std::pow(radius_at(top_z - height * depth) / radius, 2); }

/// From the axis to a round wall.
double Workspace::radius_at(double z) const {
  const auto below = std::ranges::find_if(levels, [&](const Level& level) { return level.z <= z; });
  if (levels.empty()) return radius;
  if (below == levels.begin()) return below->radius;
  const Level& above = *std::prev(below);
  if (below == levels.end()) return above.radius;
  return std::lerp(below->radius, above.radius, (z - below->z) / (above.z - below->z));
}

Eigen::Vector3d Workspace::on_circle(double circle_radius, double azimuth, double z) {
  return {circle_radius * std::cos(azimuth), circle_radius * std::sin(azimuth), z};
}

std::vector<Eigen::Vector3d> Workspace::tilts() const {
  std::vector<Eigen::Vector3d> all{Eigen::Vector3d::Zero()};
  if (max_tilt == 0.0) return all;
  const unsigned held = (tilts_about[0] ? 0U : 1U) | (tilts_about[1] ? 0U : 2U) | (tilts_about[2] ? 0U : 4U);
  for (int turning = 0; turning < 3; ++turning) {
    if (!tilts_about[static_cast<std::size_t>(turning)]) continue;
    all.emplace_back(max_tilt * Eigen::Vector3d::Unit(turning));
    all.emplace_back(-max_tilt * Eigen::Vector3d::Unit(turning));
  }
  for (unsigned corner = 0; corner < 8 && all.size() > 3; ++corner) {  // about one axis both corners are there already
    if ((corner & held) != 0) continue;
    const auto angle = [&](int turning) { return (corner >> turning & 1U) != 0 ? -max_tilt : tilt_about(turning); };
    all.emplace_back(angle(0), angle(1), angle(2));
  }
  return all;
}

std::vector<Pose> Workspace::rim(int points_per_circle, double share) const {
  std::vector<Pose> poses;
  for (const double depth : edge_depths()) {
    for (const double rotation : {min_rotation, 0.5 * (min_rotation + max_rotation), max_rotation}) {
      for (int k = 0; k < points_per_circle; ++k) {
        const double azimuth = 2.0 * std::numbers::pi * k / points_per_circle;
        for (const Eigen::Vector3d& tilt : tilts()) poses.push_back({at(share, azimuth, depth), rotation, tilt});
      }
    }
  }
  return poses;
}

}  // namespace paracal
