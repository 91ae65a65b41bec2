#pragma once

// Definition of build() for scalars other than double, e.g. automatic derivatives.

#include <cmath>
#include <numbers>

#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {
namespace detail {

template <typename Scalar>
Matrix3<Scalar> rotation_x(const Scalar& angle) {
  using std::cos, std::sin;
  const Scalar c = cos(angle), s = sin(angle), one(1), zero(0);
  Matrix3<Scalar> rotation;
  rotation << one, zero, zero, zero, c, -s, zero, s, c;
  return rotation;
}

template <typename Scalar>
Matrix3<Scalar> rotation_y(const Scalar& angle) {
  using std::cos, std::sin;
  const Scalar c = cos(angle), s = sin(angle), one(1), zero(0);
  Matrix3<Scalar> rotation;
  rotation << c, zero, s, zero, one, zero, -s, zero, c;
  return rotation;
}

template <typename Scalar>
Matrix3<Scalar> rotation_z(const Scalar& angle) {
  using std::cos, std::sin;
  const Scalar c = cos(angle), s = sin(angle), one(1), zero(0);
  Matrix3<Scalar> rotation;
  rotation << c, -s, zero, s, c, zero, zero, zero, one;
  return rotation;
}

/// Rot(z, gamma) Rot(x, pi/2): columns radial, vertical, radial x vertical.
inline Eigen::Matrix3d nominal_frame(double azimuth) {
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  Eigen::Matrix3d frame;
  frame << c, 0.0, s, s, 0.0, -c, 0.0, 1.0, 0.0;
  return frame;
}

/// A limb without errors, from which build() starts.
struct NominalLimb {
  const LimbDescription& of;
  Eigen::Matrix3d frame;
};

template <typename Scalar, typename ErrorOf>
Vector3<Scalar> shift_of_base(const NominalLimb& limb, const ErrorOf& error) {
  if (has(limb.of.kind, "e_x")) return {error("e_x"), error("e_y"), error("e_z")};
  if (has(limb.of.kind, "base_x")) return {error("base_x"), error("base_y"), error("base_z")};
  return limb.frame.col(0).cast<Scalar>() * error("normal") + limb.frame.col(2).cast<Scalar>() * error("across");
}

/// Whether the bars of a parallelogram are no longer parallel to the axis about which its plate can be commanded: they
/// then turn as the plate does, and its rods cannot keep their lengths.
template <typename Scalar, typename ErrorOf>
bool turns_bars(const LimbDescription& limb, const ErrorOf& error) {
  return limb.alpha0 + error("alpha0") != Scalar(0) ||
         (swings_arm(limb.kind) && limb.beta0 + error("beta0") != Scalar(0));
}

/// Where the drive takes the upper end of the rods.
template <typename Scalar, typename ErrorOf>
void place_drive(const NominalLimb& nominal, const ErrorOf& error, BasicLimb<Scalar>& limb) {
  const Matrix3<Scalar> frame = nominal.frame.cast<Scalar>();
  const LimbDescription& of = nominal.of;
  limb.actuator = nominal.of.kind;
  limb.radial = nominal.frame.col(0);
  limb.sideways = nominal.frame.col(2);
  limb.ahead = of.behind ? -1.0 : 1.0;
  limb.base = of.base.cast<Scalar>() + shift_of_base<Scalar>(nominal, error);
  limb.joint_offset = of.zero + error(joint_zero(nominal.of.kind));
  limb.arm = Scalar(of.arm);
  limb.frame = frame;
  if (of.kind.has_harmonics) {
    limb.turn = {Scalar(2.0 * std::numbers::pi / of.pitch), of.turn_sine + error("turn_sine"),
                 of.turn_cosine + error("turn_cosine")};
  }
  const auto alpha = [&] { return Scalar(of.alpha0 + error("alpha0")); };
  const auto beta = [&] { return Scalar(of.beta0 + error("beta0")); };
  if (swings_arm(nominal.of.kind)) {
    limb.arm += error("arm_length");
    limb.frame = frame * (rotation_x(alpha()) * rotation_y(beta()));
    return;
  }
  limb.gain = Scalar(1) + (of.gain + error("gain")) / Scalar(kGainLength);
  if (runs_on_rail(nominal.of.kind)) limb.frame = frame * (rotation_x(alpha()) * rotation_z(beta()));
}

template <typename Scalar, typename ErrorOf>
void hang_one_rod(const NominalLimb& nominal, double width, const ErrorOf& error, BasicLimb<Scalar>& limb) {
  const Scalar length =
      nominal.of.length + (has(nominal.of.kind, "rod_length") ? Scalar(error("rod_length")) : Scalar(0));
  limb.rod = {length, length};
  limb.plate = nominal.of.plate.cast<Scalar>() + Vector3<Scalar>(error("plate_x"), error("plate_y"), error("plate_z"));
  limb.elbow_frame = limb.plate_frame = Matrix3<Scalar>::Identity();
  limb.elbow_width = limb.plate_width = Scalar(width);
}

template <typename Scalar, typename ErrorOf>
void hang_parallelogram(const NominalLimb& nominal, const ErrorOf& error, BasicLimb<Scalar>& limb) {
  const LimbDescription& of = nominal.of;
  const Scalar leaning = runs_on_rail(nominal.of.kind) ? Scalar(0) : Scalar(of.beta0 + error("beta0"));
  const Scalar half_difference = Scalar(0.5) * error("rod_difference"), mean = of.length + error("rod_mean");
  limb.rod = {mean + half_difference, mean - half_difference};
  limb.plate = of.plate.cast<Scalar>();
  limb.elbow_frame = rotation_x(Scalar(error("alpha2"))) * rotation_y(Scalar(error("beta2")));
  limb.elbow_width = of.width + error("width_difference");
  limb.plate_frame =
      nominal.frame.cast<Scalar>() * (rotation_x(Scalar(of.alpha0 + error("alpha0") - error("alpha03"))) *
                                      rotation_y(Scalar(leaning - error("beta03"))));
  limb.plate_width = Scalar(of.width);
}

inline WorkingRange working_range(const Workspace& workspace) {
  return {.centre = workspace.centre(),
          .half = 0.5 * workspace.bounds().sizes(),
          .tilt = {workspace.tilt_about(0), workspace.tilt_about(1), workspace.tilt_about(2)}};
}

}  // namespace detail

template <typename Scalar>
BasicMachine<Scalar> build(const RobotDescription& robot, const BasicSourceErrors<Scalar>& errors) {
  BasicMachine<Scalar> machine;
  machine.limb_count = robot.limbs.size();
  machine.range = detail::working_range(robot.workspace);
  machine.hang = robot.hang;
  machine.freedoms = robot.freedoms;
  machine.guided_z = robot.workspace.top_z;
  if (robot.slide) {
    machine.slide_axis = robot.slide->axis;
    machine.pinion_radius = robot.slide->pinion_radius;
  }
  const double width = sizes_of(robot.limbs).parallelogram_width;
  std::size_t rods = 0;
  bool turns_bars = false;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const detail::NominalLimb limb{robot.limbs[i], frame_of(robot.limbs[i])};
    const auto error = [&](Source source) -> Scalar { return errors(i, source); };
    detail::place_drive<Scalar>(limb, error, machine.limbs[i]);
    machine.limbs[i].slide_sign = robot.slide ? robot.slide->sign[i] : 0.0;
    if (on_single_rods(limb.of.kind)) {
      detail::hang_one_rod<Scalar>(limb, width, error, machine.limbs[i]);
    } else {
      detail::hang_parallelogram<Scalar>(limb, error, machine.limbs[i]);
      turns_bars |= detail::turns_bars<Scalar>(limb.of, error);
    }
    rods += limb.of.kind.rods;
    const std::span<const Source> own = sources_of(limb.of.kind);
    machine.first_parameter[i + 1] = static_cast<std::uint16_t>(machine.first_parameter[i] + own.size());
    for (const Source source : own) {
      if (paracal::tilts_plate(source) && error(source) != Scalar(0)) machine.tilts_plate = true;
    }
  }
  if (machine.commands_tilt() && turns_bars) machine.tilts_plate = true;
  machine.has_guides = rods == machine.limb_count && !machine.freedoms.are_all();
  machine.is_level = rods == 2 * machine.limb_count && machine.freedoms == kLevelPlate &&
                     machine.limb_count == (robot.slide ? 4U : 3U);
  return machine;
}

}  // namespace paracal
