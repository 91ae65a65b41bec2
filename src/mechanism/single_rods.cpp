#include "single_rods.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <utility>

#include "paracal/error.hpp"
#include "paracal/mechanism/machine_impl.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

constexpr int kRimPoints = 12;
constexpr std::size_t kLimbs = 6;
/// Singular values of how rods hold a plate, turns counted at its radius: below this share of the largest they do not.
constexpr double kHeld = 1e-3;

/// So that a point on an axis reads 0, and not 5e-15 or -0.
std::string numbers(const Eigen::Vector3d& vector) {
  const Eigen::Vector3d tidy = (vector * 1e6).array().round() / 1e6 + 0.0;
  return fmt::format("({:g}, {:g}, {:g})", tidy.x(), tidy.y(), tidy.z());
}

std::string place(const Eigen::Vector3d& point) { return numbers(point) + " mm"; }

using Hold = Eigen::Matrix<double, kLimbs, 6>;

/// Rows (n, R a x n / radius of the plate) of all rods: how they hold it.
Hold hold(const Machine& machine, const Pose& pose, double radius) {
  const Eigen::Matrix3d rotation = detail::rotation_of(pose.tilt);
  Hold rows;
  for (std::size_t i = 0; i < kLimbs; ++i) {
    const Limb& limb = machine.limbs[i];
    const Eigen::Vector3d lever = rotation * limb.plate, at_plate = pose.position + lever;
    const double joint = solve_joint(limb, at_plate).joint;
    const Eigen::Vector3d upper_end = limb.base + elbow_lever(limb, joint, arm_directions(limb, joint));
    const Eigen::Vector3d n = (at_plate - upper_end).normalized();
    rows.row(static_cast<Eigen::Index>(i)) << n.transpose(), lever.cross(n).transpose() / radius;
  }
  return rows;
}

/// Refuses a plate that could move, or nearly, with all rods as they are.
void require_hold(const Hold& rows, const Pose& pose) {
  if (std::abs(rows.determinant()) > kHeld) return;  // the least singular value is larger, by the other five's product
  const Eigen::Matrix<double, 6, 1> values = rows.jacobiSvd().singularValues();
  if (values(5) > kHeld * values(0)) return;
  throw InvalidArgument(
      fmt::format("workspace: the rods do not hold the plate at {} tilted by {} deg: it could move with all of them as "
                  "they are (singular; {:.1g} of how the stiffest motion is held)",
                  place(pose.position), numbers(pose.tilt.unaryExpr(&to_degrees)), values(5) / values(0)));
}

/// Where it is seen whether rods hold a plate: the axis and two circles on top, in the middle and at the bottom of the
/// workspace, at all extremes of tilt.
std::vector<Pose> poses_to_hold(const Workspace& workspace) {
  std::vector<Pose> poses;
  for (const double down : {0.5, 0.0, 1.0}) {
    const double z = workspace.top_z - down * workspace.height;
    for (const Eigen::Vector3d& tilt : workspace.tilts()) {
      poses.push_back({Eigen::Vector3d(0.0, 0.0, z), 0.0, tilt});
      for (int k = 0; k < 2 * kRimPoints; ++k) {
        const double azimuth = std::numbers::pi * k / kRimPoints;
        for (const double share : {0.5, 1.0}) {
          poses.push_back({Workspace::on_circle(share * workspace.radius, azimuth, z), 0.0, tilt});
        }
      }
    }
  }
  return poses;
}

/// Root of the mean square.
double mean_radius(const std::vector<SingleRod>& limbs, Eigen::Vector3d SingleRod::*joint) {
  double squares = 0.0;
  for (const SingleRod& limb : limbs) squares += (limb.*joint).head<2>().squaredNorm();
  return std::sqrt(squares / static_cast<double>(limbs.size()));
}

void require_direction(std::string_view quantity, const Eigen::Vector3d& vector) {
  if (vector.allFinite() && vector.norm() > 1e-9) return;
  throw InvalidArgument(fmt::format("{}: expected a direction, got {}", quantity, numbers(vector)));
}

/// An arm that turns about itself goes nowhere: this much of a right angle at least.
constexpr double kSquare = 0.1;

void check_drive(Actuator kind, const SingleRod& limb, std::size_t number) {
  const auto key = [&](std::string_view name) { return fmt::format("limb: {} of limb {}", name, number); };
  detail::require_positive_mm(key(kind == Actuator::strut ? "length_at_zero_mm" : "rod_mm"), limb.length);
  if (kind == Actuator::strut) return;
  require_direction(key(kind == Actuator::crank ? "axis" : "direction"), limb.axis);
  if (kind == Actuator::carriage) return;
  detail::require_positive_mm(key("arm_mm"), limb.arm);
  require_direction(key("arm_at_zero"), limb.at_zero);
  if (limb.axis.normalized().cross(limb.at_zero.normalized()).norm() > kSquare) return;
  throw InvalidArgument(fmt::format("{}: expected an arm that points away from its axis {}, got {}", key("arm_at_zero"),
                                    numbers(limb.axis), numbers(limb.at_zero)));
}

bool is_alike(const SingleRod& one, const SingleRod& other) {
  return one.base == other.base && one.plate == other.plate && one.axis == other.axis && one.at_zero == other.at_zero &&
         one.behind == other.behind;
}

/// Two unit vectors and what is square to both, as columns.
Eigen::Matrix3d columns(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  Eigen::Matrix3d frame;
  frame << first, second, first.cross(second);
  return frame;
}

Eigen::Vector3d square_to(const Eigen::Vector3d& axis, const Eigen::Vector3d& direction) {
  return (direction - direction.dot(axis) * axis).normalized();
}

/// Upward; of a rail that stands nearly upright outward from the z axis, or along x where it stands on it.
Eigen::Matrix3d rail_frame(const SingleRod& rail) {
  constexpr double kUpright = 0.99, kOnAxis = 1e-6;  // mm
  const Eigen::Vector3d along = rail.axis.normalized();
  if (std::abs(along.z()) < kUpright) return columns(square_to(along, Eigen::Vector3d::UnitZ()), along);
  Eigen::Vector3d outward(rail.base.x(), rail.base.y(), 0.0);
  if (outward.norm() < kOnAxis) outward = Eigen::Vector3d::UnitX();
  return columns(square_to(along, outward), along);
}

/// Rot(z, gamma) Rot(x, pi/2) towards the joint at the base.
Eigen::Matrix3d strut_frame(const SingleRod& strut) {
  return detail::nominal_frame(std::atan2(strut.base.y(), strut.base.x()));
}

}  // namespace

namespace detail {

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& tilt) {
  const auto turn = [&](int axis) { return Eigen::AngleAxisd(tilt(axis), Eigen::Vector3d::Unit(axis)); };
  return (turn(0) * turn(1) * turn(2)).toRotationMatrix();
}

void require_positive_mm(std::string_view quantity, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InvalidArgument(fmt::format("{}: expected a length above 0 mm, got {} mm", quantity, value));
  }
}

void check_single_rods(const Geometry& geometry) {
  const std::vector<SingleRod>& limbs = geometry.single_rods;
  if (limbs.size() != kLimbs) {
    throw InvalidArgument(fmt::format("limb: expected {} limbs with one rod for a plate with six freedoms, got {}",
                                      kLimbs, limbs.size()));
  }
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const SingleRod& limb = limbs[i];
    if (!limb.base.allFinite() || !limb.plate.allFinite()) {
      throw InvalidArgument(fmt::format("limb: expected numbers for the joints of limb {}", i + 1));
    }
    check_drive(geometry.actuator, limb, i + 1);
    for (std::size_t j = 0; j < i; ++j) {
      if (!is_alike(limb, limbs[j])) continue;
      throw InvalidArgument(fmt::format("limb: expected limbs of their own, got limbs {} and {} both from {} to {}",
                                        j + 1, i + 1, place(limb.base), place(limb.plate)));
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
  const Pose centre{workspace.centre()};
  const double side = hold(machine, centre, geometry.plate_radius).determinant();
  std::vector<Pose> poses = poses_to_hold(workspace);
  poses.insert(poses.begin(), centre);
  for (const Pose& pose : poses) {
    const Hold rows = hold(machine, pose, geometry.plate_radius);
    require_hold(rows, pose);
    if (rows.determinant() * side > 0.0) continue;
    throw InvalidArgument(fmt::format(
        "workspace: the rods do not hold the plate somewhere between its centre and {} tilted by {} deg (singular: "
        "there it would go through a pose in which it could move with all of them as they are)",
        place(pose.position), numbers(pose.tilt.unaryExpr(&to_degrees))));
  }
}

std::optional<std::string> absurd_single_rod(const Geometry& geometry, const SourceErrors& errors, std::size_t limb) {
  const SingleRod& nominal = geometry.single_rods[limb];
  const bool is_strut = geometry.actuator == Actuator::strut, swings = geometry.actuator == Actuator::crank;
  const double length = nominal.length + errors(limb, is_strut ? Source::theta_offset : Source::rod_length);
  const double arm = swings ? nominal.arm + errors(limb, Source::arm_length) : 1.0;
  const double growth = kGainLength + (swings ? 0.0 : errors(limb, Source::gain));
  if (!(length > 0.0)) {
    return fmt::format("expected limb {} longer than 0 mm{}, got {:g} mm", limb + 1, is_strut ? " at zero" : "",
                       length);
  }
  if (!(arm > 0.0)) return fmt::format("expected the arm of limb {} longer than 0 mm, got {:g} mm", limb + 1, arm);
  if (growth > 0.0) return std::nullopt;
  return fmt::format("expected the drive of limb {} to go forward with its joint, got {:g} mm/m", limb + 1, growth);
}

}  // namespace detail

Eigen::Matrix3d frame_of(Actuator kind, const SingleRod& limb) {
  if (kind == Actuator::strut) return strut_frame(limb);
  if (kind == Actuator::carriage) return rail_frame(limb);
  const Eigen::Vector3d axis = limb.axis.normalized(), at_zero = square_to(axis, limb.at_zero);
  return columns(at_zero, axis.cross(at_zero));
}

Geometry single_rod_geometry(Actuator kind, std::vector<SingleRod> limbs) {
  Geometry geometry;
  geometry.actuator = kind;
  if (limbs.empty()) return geometry;
  geometry.base_radius = mean_radius(limbs, &SingleRod::base);
  geometry.plate_radius = mean_radius(limbs, &SingleRod::plate);
  geometry.parallelogram_width = 2.0 * geometry.plate_radius;
  for (const SingleRod& limb : limbs) {
    geometry.rod += limb.length / static_cast<double>(limbs.size());
    geometry.arm += limb.arm / static_cast<double>(limbs.size());
    geometry.limb_azimuth.push_back(std::atan2(limb.base.y(), limb.base.x()));
  }
  geometry.single_rods = std::move(limbs);
  return geometry;
}

}  // namespace paracal
