#include "struts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <utility>

#include "paracal/error.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

constexpr int kRimPoints = 12;
constexpr std::size_t kStruts = 6;
/// Singular values of how struts hold a plate, turns counted at its radius: below this share of the largest they do
/// not.
constexpr double kHeld = 1e-3;

/// So that a point on an axis reads 0, and not 5e-15 or -0.
std::string numbers(const Eigen::Vector3d& vector) {
  const Eigen::Vector3d tidy = (vector * 1e6).array().round() / 1e6 + 0.0;
  return fmt::format("({:g}, {:g}, {:g})", tidy.x(), tidy.y(), tidy.z());
}

std::string place(const Eigen::Vector3d& point) { return numbers(point) + " mm"; }

/// Rows (n, R a x n / radius of the plate) of all struts: how they hold it.
Eigen::Matrix<double, kStruts, 6> hold(const Machine& machine, const Pose& pose, double radius) {
  const auto turn = [&](int axis) { return Eigen::AngleAxisd(pose.tilt(axis), Eigen::Vector3d::Unit(axis)); };
  const Eigen::Matrix3d rotation = (turn(0) * turn(1) * turn(2)).toRotationMatrix();
  Eigen::Matrix<double, kStruts, 6> rows;
  for (std::size_t i = 0; i < kStruts; ++i) {
    const Eigen::Vector3d lever = rotation * machine.limbs[i].plate;
    const Eigen::Vector3d n = (pose.position + lever - machine.limbs[i].base).normalized();
    rows.row(static_cast<Eigen::Index>(i)) << n.transpose(), lever.cross(n).transpose() / radius;
  }
  return rows;
}

/// Root of the mean square.
double mean_radius(const std::vector<Strut>& struts, Eigen::Vector3d Strut::*joint) {
  double squares = 0.0;
  for (const Strut& strut : struts) squares += (strut.*joint).head<2>().squaredNorm();
  return std::sqrt(squares / static_cast<double>(struts.size()));
}

}  // namespace

namespace detail {

void require_positive_mm(std::string_view quantity, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InvalidArgument(fmt::format("{}: expected a length above 0 mm, got {} mm", quantity, value));
  }
}

void check_struts(const std::vector<Strut>& struts) {
  if (struts.size() != kStruts) {
    throw InvalidArgument(
        fmt::format("limb: expected {} struts for a plate with six freedoms, got {}", kStruts, struts.size()));
  }
  for (std::size_t i = 0; i < struts.size(); ++i) {
    const auto& [base, plate, length] = struts[i];
    if (!base.allFinite() || !plate.allFinite()) {
      throw InvalidArgument(fmt::format("limb: expected numbers for the joints of limb {}", i + 1));
    }
    require_positive_mm(fmt::format("limb: length_at_zero_mm of limb {}", i + 1), length);
    for (std::size_t j = 0; j < i; ++j) {
      if (base != struts[j].base || plate != struts[j].plate) continue;
      throw InvalidArgument(fmt::format("limb: expected struts of their own, got limbs {} and {} both from {} to {}",
                                        j + 1, i + 1, place(base), place(plate)));
    }
  }
}

void check_side(const Workspace& workspace) {
  const double bottom = workspace.top_z - workspace.height;
  if (!std::isfinite(workspace.top_z) || !(workspace.top_z < 0.0 || bottom > 0.0)) {
    throw InvalidArgument(
        fmt::format("workspace.top_z_mm: expected a workspace above the base, or one below, got z from {} to {} mm",
                    bottom, workspace.top_z));
  }
  if (!(workspace.max_tilt >= 0.0) || !(workspace.max_tilt < 0.5 * std::numbers::pi)) {
    throw InvalidArgument(fmt::format("workspace.tilt_deg: expected at least 0 and less than 90 deg, got {:g}",
                                      to_degrees(workspace.max_tilt)));
  }
}

void check_hold(const Machine& machine, const Geometry& geometry, const Workspace& workspace) {
  std::vector<Pose> poses = workspace.rim(kRimPoints);
  poses.insert(poses.begin(), Pose{workspace.centre()});
  for (const Pose& pose : poses) {
    const auto rows = hold(machine, pose, geometry.plate_radius);
    const Eigen::Matrix<double, 6, 1> values = rows.jacobiSvd().singularValues();
    if (values(5) > kHeld * values(0)) continue;
    throw InvalidArgument(
        fmt::format("workspace: the struts do not hold the plate at {} tilted by {} deg: it could move with all of "
                    "them as they are "
                    "(singular; {:.1g} of how the stiffest motion is held)",
                    place(pose.position), numbers(pose.tilt.unaryExpr(&to_degrees)), values(5) / values(0)));
  }
}

std::optional<std::string> absurd_strut(const Strut& strut, const SourceErrors& errors, std::size_t limb) {
  const double length = strut.length_at_zero + errors(limb, Source::theta_offset);
  const double growth = kGainLength + errors(limb, Source::gain);
  if (length > 0.0 && growth > 0.0) return std::nullopt;
  return fmt::format("expected limb {} longer than 0 mm at zero and growing with its joint, got {:g} mm and {:g} mm/m",
                     limb + 1, length, growth);
}

}  // namespace detail

Geometry strut_geometry(std::vector<Strut> struts) {
  Geometry geometry;
  geometry.actuator = Actuator::strut;
  if (struts.empty()) return geometry;
  geometry.base_radius = mean_radius(struts, &Strut::base);
  geometry.plate_radius = mean_radius(struts, &Strut::plate);
  geometry.parallelogram_width = 2.0 * geometry.plate_radius;
  for (const Strut& strut : struts) {
    geometry.rod += strut.length_at_zero / static_cast<double>(struts.size());
    geometry.limb_azimuth.push_back(std::atan2(strut.base.y(), strut.base.x()));
  }
  geometry.struts = std::move(struts);
  return geometry;
}

}  // namespace paracal
