#pragma once

// Definition of build() for scalars other than double, e.g. automatic derivatives.

#include <cmath>
#include <numbers>

#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {
namespace detail {

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

/// F v: sums of numbers times constants, which cost little on numbers with derivatives.
template <typename Scalar>
ClosureVector<Scalar> in_frame(const Eigen::Matrix3d& F, const ClosureVector<Scalar>& v) {
  const auto row = [&](Eigen::Index k) { return Scalar(F(k, 0) * v[0] + F(k, 1) * v[1] + F(k, 2) * v[2]); };
  return {row(0), row(1), row(2)};
}

/// Numbers that carry derivatives do not start at zero.
template <typename Scalar>
ClosureVector<Scalar> zero_vector() {
  return {Scalar(0), Scalar(0), Scalar(0)};
}

template <typename Scalar>
ClosureVector<Scalar> shifted(const Eigen::Vector3d& point, const ClosureVector<Scalar>& shift) {
  return {point.x() + shift[0], point.y() + shift[1], point.z() + shift[2]};
}

template <typename Scalar, typename ErrorOf>
ClosureVector<Scalar> shift_of_base(const NominalLimb& limb, const ErrorOf& error) {
  if (has(limb.of.kind, "e_x")) return {error("e_x"), error("e_y"), error("e_z")};
  if (has(limb.of.kind, "base_x")) return {error("base_x"), error("base_y"), error("base_z")};
  return in_frame<Scalar>(limb.frame, {error("normal"), Scalar(0), error("across")});
}

/// Columns of Rot(x, alpha) Rot(y, beta) and of Rot(x, alpha) Rot(z, beta).
template <typename Scalar>
PlateColumns<Scalar> lean_about_y(const Scalar& alpha, const Scalar& beta) {
  return plate_columns<Scalar>(closure::turn_by_any(alpha), closure::turn_by_any(beta), {Scalar(1), Scalar(0)});
}
template <typename Scalar>
PlateColumns<Scalar> lean_about_z(const Scalar& alpha, const Scalar& beta) {
  return plate_columns<Scalar>(closure::turn_by_any(alpha), {Scalar(1), Scalar(0)}, closure::turn_by_any(beta));
}

template <typename Scalar>
void lean(const Eigen::Matrix3d& frame, const PlateColumns<Scalar>& by, ClosureLimb<Scalar>& limb) {
  limb.radial = in_frame(frame, by.x);
  limb.normal = in_frame(frame, by.y);
  limb.axis = in_frame(frame, by.z);
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
  const LimbDescription& of = nominal.of;
  limb.set_kind(of.kind);
  limb.ahead = Scalar(of.behind ? -1.0 : 1.0);
  limb.base = shifted<Scalar>(of.base, shift_of_base<Scalar>(nominal, error));
  limb.joint_offset = of.zero + error(joint_zero(of.kind));
  limb.arm = Scalar(of.arm);
  if (of.kind.has_harmonics) {
    limb.turn = {Scalar(2.0 * std::numbers::pi / of.pitch), of.turn_sine + error("turn_sine"),
                 of.turn_cosine + error("turn_cosine")};
  }
  if (!swings_arm(of.kind)) limb.joint_per_mm = Scalar(1) / (Scalar(1) + (of.gain + error("gain")) / kGainLength);
  if (limb.is_strut()) {
    limb.joint_offset += of.length;
    limb.radial = shifted(nominal.frame.col(0), zero_vector<Scalar>());
    limb.normal = shifted(nominal.frame.col(1), zero_vector<Scalar>());
    limb.axis = shifted(nominal.frame.col(2), zero_vector<Scalar>());
    return;
  }
  const Scalar alpha = of.alpha0 + error("alpha0"), beta = of.beta0 + error("beta0");
  if (swings_arm(of.kind)) limb.arm += error("arm_length");
  lean<Scalar>(nominal.frame, swings_arm(of.kind) ? lean_about_y(alpha, beta) : lean_about_z(alpha, beta), limb);
}

template <typename Scalar, typename ErrorOf>
void hang_one_rod(const NominalLimb& nominal, const ErrorOf& error, BasicLimb<Scalar>& limb) {
  limb.rod[0] = Scalar(nominal.of.length);
  if (has(nominal.of.kind, "rod_length")) limb.rod[0] += error("rod_length");
  limb.rod[1] = limb.rod[0];
  limb.elbow_half = limb.plate_half = zero_vector<Scalar>();
  limb.plate = shifted<Scalar>(nominal.of.plate, {error("plate_x"), error("plate_y"), error("plate_z")});
}

template <typename Scalar, typename ErrorOf>
void hang_parallelogram(const NominalLimb& nominal, const ErrorOf& error, BasicLimb<Scalar>& limb) {
  const LimbDescription& of = nominal.of;
  const Scalar half_difference = 0.5 * error("rod_difference"), mean = of.length + error("rod_mean");
  limb.rod = {mean + half_difference, mean - half_difference};
  limb.plate = shifted(of.plate, zero_vector<Scalar>());
  const Scalar elbow_half = 0.5 * (of.width + error("width_difference")), plate_half(0.5 * of.width);
  limb.elbow_half = closure::scaled(lean_about_y(Scalar(error("alpha2")), Scalar(error("beta2"))).z, elbow_half);
  const Scalar leaning = runs_on_rail(of.kind) ? Scalar(0) : Scalar(of.beta0 + error("beta0"));
  const Scalar alpha3 = of.alpha0 + error("alpha0") - error("alpha03"), beta3 = leaning - error("beta03");
  limb.plate_half = closure::scaled(in_frame(nominal.frame, lean_about_y(alpha3, beta3).z), plate_half);
}

/// mu_i r_g shat.
template <typename Scalar>
ClosureVector<Scalar> slide_of(const BasicMachine<Scalar>& machine, double sign) {
  return shifted(Eigen::Vector3d(sign * machine.pinion_radius * machine.slide_axis), zero_vector<Scalar>());
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
  machine.turn_lever = 0.5 * sizes_of(robot.limbs).parallelogram_width;
  std::size_t rods = 0;
  bool turns_bars = false;
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const detail::NominalLimb limb{robot.limbs[i], frame_of(robot.limbs[i])};
    const auto error = [&](Source source) -> Scalar { return errors(i, source); };
    detail::place_drive<Scalar>(limb, error, machine.limbs[i]);
    machine.limbs[i].slide_sign = robot.slide ? robot.slide->sign[i] : 0.0;
    machine.limbs[i].slide = detail::slide_of(machine, machine.limbs[i].slide_sign);
    if (on_single_rods(limb.of.kind)) {
      detail::hang_one_rod<Scalar>(limb, error, machine.limbs[i]);
    } else {
      detail::hang_parallelogram<Scalar>(limb, error, machine.limbs[i]);
      turns_bars |= detail::turns_bars<Scalar>(limb.of, error);
    }
    rods += limb.of.kind.rods;
    machine.has_harmonics |= limb.of.kind.has_harmonics;
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
