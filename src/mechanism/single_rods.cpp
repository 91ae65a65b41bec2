#include "single_rods.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>

#include "paracal/error.hpp"
#include "paracal/mechanism/machine_impl.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

/// So that a point on an axis reads 0, and not 5e-15 or -0.
std::string numbers(const Eigen::Vector3d& vector) {
  const Eigen::Vector3d tidy = (vector * 1e6).array().round() / 1e6 + 0.0;
  return fmt::format("({:g}, {:g}, {:g})", tidy.x(), tidy.y(), tidy.z());
}

std::string place(const Eigen::Vector3d& point) { return numbers(point) + " mm"; }

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

void check_freedoms(const PlateFreedoms& freedoms, std::size_t limbs) {
  if (const std::string why = coupled_motions(freedoms); !why.empty()) throw InvalidArgument("plate.freedoms: " + why);
  if (limbs == freedoms.count()) return;
  const std::string of =
      freedoms.count() == kMaxLimbs ? "six degrees of freedom" : "degrees of freedom " + in_words(freedoms);
  throw InvalidArgument(
      fmt::format("limb: expected {} limbs with one rod for a plate with {}, got {}", freedoms.count(), of, limbs));
}

}  // namespace

namespace detail {

void require_positive_mm(std::string_view quantity, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InvalidArgument(fmt::format("{}: expected a length above 0 mm, got {} mm", quantity, value));
  }
}

std::vector<std::pair<std::string, double>> dimensions_of(const Geometry& geometry) {
  std::vector<std::pair<std::string, double>> all;
  for (std::size_t i = 0; i < geometry.single_rods.size(); ++i) {
    const SingleRod& limb = geometry.single_rods[i];
    const auto add = [&](std::string_view key, double length) {
      if (length != 0.0) all.emplace_back(fmt::format("limb: {} of limb {}", key, i + 1), length);
    };
    add("base_joint_mm", limb.base.norm());
    add("plate_joint_mm", limb.plate.norm());
    add(geometry.actuator == Actuator::strut ? "length_at_zero_mm" : "rod_mm", limb.length);
    add("arm_mm", limb.arm);
  }
  return all;
}

void check_single_rods(const Geometry& geometry) {
  const std::vector<SingleRod>& limbs = geometry.single_rods;
  check_freedoms(geometry.freedoms, limbs.size());
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const SingleRod& limb = limbs[i];
    if (!limb.base.allFinite() || !limb.plate.allFinite()) {
      throw InvalidArgument(fmt::format("limb: expected numbers for the joints of limb {}", i + 1));
    }
    check_drive(geometry.actuator, limb, i + 1);
    for (std::size_t j = 0; j < i; ++j) {
      if (!is_alike(limb, limbs[j])) continue;
      throw InvalidArgument(fmt::format("limb: expected different limbs, got limbs {} and {} both from {} to {}", j + 1,
                                        i + 1, place(limb.base), place(limb.plate)));
    }
  }
}

void check_side(const Workspace& workspace, const PlateFreedoms& freedoms) {
  const double bottom = workspace.top_z - workspace.height;
  if (freedoms.holds_z() ? workspace.height != 0.0 : !(workspace.height > 0.0)) {
    throw InvalidArgument(
        fmt::format("workspace.{}: expected {}, got {:g} mm", workspace.keys().height,
                    freedoms.holds_z() ? "nothing or 0 for a plate that stays in its plane" : "a length above 0 mm",
                    workspace.height));
  }
  if (!std::isfinite(workspace.top_z) || !std::isfinite(bottom)) {
    throw InvalidArgument(
        fmt::format("workspace.{}: expected a number, got {} mm", workspace.keys().top, workspace.top_z));
  }
  if (!freedoms.holds_z() && !(workspace.top_z < 0.0 || bottom > 0.0)) {
    throw InvalidArgument(
        fmt::format("workspace.{}: expected a workspace above or below the base, got z from {} to {} mm",
                    workspace.keys().top, bottom, workspace.top_z));
  }
  if (!(workspace.max_tilt >= 0.0) || !(workspace.max_tilt < 0.5 * std::numbers::pi)) {
    throw InvalidArgument(fmt::format("workspace.tilt_deg: expected at least 0 and less than 90 deg, got {:g}",
                                      to_degrees(workspace.max_tilt)));
  }
  if (workspace.max_tilt > 0.0 && !freedoms.tilt()) {
    throw InvalidArgument("workspace.tilt_deg: expected nothing for a plate with the degrees of freedom " +
                          in_words(freedoms));
  }
}

std::optional<std::string> backward_drive(const SourceErrors& errors, std::size_t limb) {
  const double growth = kGainLength + errors(limb, "gain");
  if (growth > 0.0) return std::nullopt;
  return fmt::format("expected the drive of limb {} to move in the direction of its joint, got {:g} mm/m", limb + 1,
                     growth);
}

std::optional<std::string> absurd_single_rod(const Geometry& geometry, const SourceErrors& errors, std::size_t limb) {
  const SingleRod& nominal = geometry.single_rods[limb];
  const bool is_strut = geometry.actuator == Actuator::strut, swings = geometry.actuator == Actuator::crank;
  const double length = nominal.length + errors(limb, is_strut ? Source("zero") : Source("rod_length"));
  const double arm = swings ? nominal.arm + errors(limb, "arm_length") : 1.0;
  if (!(length > 0.0)) {
    return fmt::format("expected limb {} longer than 0 mm{}, got {:g} mm", limb + 1, is_strut ? " at zero" : "",
                       length);
  }
  if (!(arm > 0.0)) return fmt::format("expected the arm of limb {} longer than 0 mm, got {:g} mm", limb + 1, arm);
  return swings ? std::nullopt : backward_drive(errors, limb);
}

}  // namespace detail

std::string in_words(const PlateFreedoms& freedoms) {
  std::string text;
  for (std::size_t k = 0; k < freedoms.free.size(); ++k) {
    if (freedoms.free[k]) text.append(text.empty() ? "" : ", ").append(kPlateCoordinates[k]);
  }
  return text;
}

std::string coupled_motions(const PlateFreedoms& freedoms) {
  if (freedoms.free[0] && freedoms.free[1]) return "";
  return fmt::format(
      "expected x and y among plate.freedoms, got {}. Plates without them have coupled motions: those of a 3-RPS or an "
      "Agile Eye move sideways or turn when they tilt, but paracal holds other coordinates constant. Such robots have "
      "no "
      "robot file; state a robot in an upright plane with x and y in this plane",
      in_words(freedoms));
}

Eigen::Matrix3d frame_of(Actuator kind, const SingleRod& limb) {
  if (kind == Actuator::strut) return strut_frame(limb);
  if (kind == Actuator::carriage) return rail_frame(limb);
  const Eigen::Vector3d axis = limb.axis.normalized(), at_zero = square_to(axis, limb.at_zero);
  return columns(at_zero, axis.cross(at_zero));
}

Geometry single_rod_geometry(Actuator kind, std::vector<SingleRod> limbs, const PlateFreedoms& freedoms) {
  constexpr double kPoint = 0.1;  // of a rod: the width of a plate that is a point
  Geometry geometry;
  geometry.actuator = kind;
  geometry.freedoms = freedoms;
  if (limbs.empty()) return geometry;
  geometry.base_radius = mean_radius(limbs, &SingleRod::base);
  geometry.plate_radius = mean_radius(limbs, &SingleRod::plate);
  for (const SingleRod& limb : limbs) {
    geometry.rod += limb.length / static_cast<double>(limbs.size());
    geometry.arm += limb.arm / static_cast<double>(limbs.size());
    geometry.limb_azimuth.push_back(std::atan2(limb.base.y(), limb.base.x()));
  }
  geometry.parallelogram_width = geometry.plate_radius > 0.0 ? 2.0 * geometry.plate_radius : kPoint * geometry.rod;
  geometry.single_rods = std::move(limbs);
  return geometry;
}

}  // namespace paracal
