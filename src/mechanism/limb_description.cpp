#include "paracal/mechanism/limb_description.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "paracal/error.hpp"
#include "paracal/mechanism/machine_impl.hpp"

namespace paracal {
namespace {

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
Eigen::Matrix3d rail_frame(const LimbDescription& rail) {
  constexpr double kUpright = 0.99, kOnAxis = 1e-6;  // mm
  const Eigen::Vector3d along = rail.axis.normalized();
  if (!rail.at_zero.isZero(0.0)) return columns(square_to(along, rail.at_zero), along);
  if (std::abs(along.z()) < kUpright) return columns(square_to(along, Eigen::Vector3d::UnitZ()), along);
  Eigen::Vector3d outward(rail.base.x(), rail.base.y(), 0.0);
  if (outward.norm() < kOnAxis) outward = Eigen::Vector3d::UnitX();
  return columns(square_to(along, outward), along);
}

/// Root of the mean square.
double mean_radius(const Limbs& limbs, Eigen::Vector3d LimbDescription::*joint) {
  double squares = 0.0;
  for (const LimbDescription& limb : limbs) squares += (limb.*joint).head<2>().squaredNorm();
  return std::sqrt(squares / static_cast<double>(limbs.size()));
}

/// @param errors  of limb number `number`, which change what the plate does in its position only.
void check_nominal(const LimbDescription& limb, const SourceErrors& errors, std::size_t number) {
  for (const Source source : sources_of(limb.kind)) {
    if (!std::isfinite(errors(number, source))) {
      throw InvalidArgument(fmt::format("limb: expected a number for {} of limb {}", name(source), number + 1));
    }
    if (!tilts_plate(source) || errors(number, source) == 0.0) continue;
    throw InvalidArgument(
        fmt::format("limb: expected no {} of limb {} (it would tilt the plate by design); state it in [[error]]",
                    name(source), number + 1));
  }
}

constexpr LimbLength kRod{"rod_mm", "the rod", &LimbDescription::length, "rod_length"},
    kRods{"rod_mm", "the rods", &LimbDescription::length, "rod_mean"},
    kBar{"parallelogram_width_mm", "the bar at the plate", &LimbDescription::width, "width_difference"},
    kArm{"arm_mm", "the arm", &LimbDescription::arm, "arm_length"},
    kStrut{"length_at_zero_mm", "the strut at zero", &LimbDescription::length, "zero"};

constexpr std::array kOfArm{kRods, kBar, kArm};
constexpr std::array kOfRail{kRods, kBar}, kOfCrank{kRod, kArm};
constexpr std::array kOfCarriage{kRod}, kOfStrut{kStrut};

constexpr std::array kOfMotor{LimbDirection{"axis", &LimbDescription::axis},
                              LimbDirection{"arm_at_zero", &LimbDescription::at_zero}};
constexpr std::array kAlongRail{LimbDirection{"direction", &LimbDescription::axis}};

}  // namespace

std::span<const LimbLength> lengths_of(Actuator kind) {
  using Lengths = std::span<const LimbLength>;
  static constexpr std::array<std::array<Lengths, 2>, 3> kLengths{
      {{kOfCrank, kOfArm}, {kOfCarriage, kOfRail}, {kOfStrut, {}}}};
  return kLengths[static_cast<std::size_t>(kind.drive)][kind.rods - 1U];
}

std::string_view pitch_key(Actuator kind) { return joint_unit(kind) == Unit::rad ? "pitch_deg" : "pitch_mm"; }

std::span<const LimbDirection> directions_of(Actuator kind) {
  static constexpr std::array<std::span<const LimbDirection>, 3> kDirections{{kOfMotor, kAlongRail, {}}};
  return kDirections[static_cast<std::size_t>(kind.drive)];
}

Eigen::Matrix3d frame_of(const LimbDescription& limb) {
  // Rot(z, gamma) Rot(x, pi/2)
  if (limb.kind.drive == Drive::strut || limb.azimuth) return detail::nominal_frame(azimuth_of(limb));
  if (runs_on_rail(limb.kind)) return rail_frame(limb);
  const Eigen::Vector3d axis = limb.axis.normalized(), at_zero = square_to(axis, limb.at_zero);
  return columns(at_zero, axis.cross(at_zero));
}

LimbDescription with_pitch(LimbDescription limb, double pitch) {
  limb.pitch = pitch;
  limb.kind.has_harmonics = pitch != 0.0;
  return limb;
}

double azimuth_of(const LimbDescription& limb) {
  return limb.azimuth.value_or(std::atan2(limb.base.y(), limb.base.x()));
}

Limbs with_errors(Limbs limbs, const SourceErrors& errors) {
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    LimbDescription& limb = limbs[i];
    check_nominal(limb, errors, i);
    const auto error = [&](Source source) { return has(limb.kind, source) ? errors(i, source) : 0.0; };
    const detail::NominalLimb nominal{limb, frame_of(limb)};
    if (runs_on_rail(limb.kind)) limb.at_zero = nominal.frame.col(0);  // which is not to turn with its foot
    limb.base += as_eigen(detail::shift_of_base<double>(nominal, error));
    limb.plate += Eigen::Vector3d(error("plate_x"), error("plate_y"), error("plate_z"));
    limb.length += error("rod_mean") + error("rod_length");
    limb.arm += error("arm_length");
    limb.zero += error(joint_zero(limb.kind));
    limb.gain += error("gain");
    limb.alpha0 += error("alpha0");
    limb.beta0 += error("beta0");
    limb.turn_sine += error("turn_sine");
    limb.turn_cosine += error("turn_cosine");
  }
  return limbs;
}

LimbSizes sizes_of(const Limbs& limbs) {
  constexpr double kPoint = 0.1;  // of a rod: the width of a plate that is a point
  LimbSizes sizes{.base_radius = mean_radius(limbs, &LimbDescription::base),
                  .plate_radius = mean_radius(limbs, &LimbDescription::plate)};
  for (const LimbDescription& limb : limbs) {
    sizes.rod += limb.length / static_cast<double>(limbs.size());
    sizes.arm += limb.arm / static_cast<double>(limbs.size());
    if (sizes.parallelogram_width == 0.0) sizes.parallelogram_width = limb.width;
  }
  if (sizes.parallelogram_width == 0.0) {
    sizes.parallelogram_width = sizes.plate_radius > 0.0 ? 2.0 * sizes.plate_radius : kPoint * sizes.rod;
  }
  return sizes;
}

std::vector<Actuator> kinds_of(const Limbs& limbs) {
  std::vector<Actuator> kinds(limbs.size());
  std::ranges::transform(limbs, kinds.begin(), &LimbDescription::kind);
  return kinds;
}

std::vector<Source> sources_of(const Limbs& limbs) {
  std::vector<Source> sources;
  for (const LimbDescription& limb : limbs) {
    for (const Source source : sources_of(limb.kind)) {
      if (std::ranges::find(sources, source) == sources.end()) sources.push_back(source);
    }
  }
  return sources;
}

std::optional<Source> source_named(std::string_view name, const Limbs& limbs) {
  for (const Source source : sources_of(limbs)) {
    if (source.name() == name) return source;
  }
  return std::nullopt;
}

std::vector<Source> sharing(Source leading, const Limbs& limbs) {
  std::vector<Source> sources = sources_of(limbs);
  std::erase_if(sources, [&](Source other) { return shared_name(other) != shared_name(leading); });
  return sources;
}

}  // namespace paracal
