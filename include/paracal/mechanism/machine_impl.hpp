#pragma once

// Definition of build() for scalars other than double, e.g. automatic derivatives.

#include <cmath>

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

template <typename Scalar, typename ErrorOf>
Vector3<Scalar> shift_of_base(Actuator kind, const Eigen::Matrix3d& frame, const ErrorOf& error) {
  if (kind != Actuator::carriage) return {error("base_x"), error("base_y"), error("base_z")};
  return frame.col(0).cast<Scalar>() * error("normal") + frame.col(2).cast<Scalar>() * error("across");
}

template <typename Scalar, typename ErrorOf>
Matrix3<Scalar> leaning(Actuator kind, const Eigen::Matrix3d& frame, const ErrorOf& error) {
  if (kind == Actuator::strut) return frame.cast<Scalar>();
  const Scalar beta = error("beta0");
  const Matrix3<Scalar> by_beta = kind == Actuator::crank ? rotation_y(beta) : rotation_z(beta);
  return frame.cast<Scalar>() * (rotation_x(Scalar(error("alpha0"))) * by_beta);
}

/// mm that a drive moves a mm of its joint coordinate.
template <typename Scalar, typename ErrorOf>
Scalar gain_with(const ErrorOf& error) {
  return Scalar(1) + error("gain") / Scalar(kGainLength);
}

/// @param error  of this limb, by its source.
template <typename Scalar, typename ErrorOf>
BasicLimb<Scalar> single_rod(const Geometry& nominal, std::size_t limb, const ErrorOf& error) {
  const SingleRod& rod = nominal.single_rods[limb];
  const Actuator kind = nominal.actuator;
  const Eigen::Matrix3d frame = frame_of(kind, rod);
  const bool swings = kind == Actuator::crank, is_strut = kind == Actuator::strut;
  const Scalar length = rod.length + (is_strut ? Scalar(0) : error("rod_length"));
  BasicLimb<Scalar> built;
  built.actuator = kind;
  built.radial = frame.col(0);
  built.sideways = frame.col(2);
  built.ahead = rod.behind ? -1.0 : 1.0;
  built.base = rod.base.cast<Scalar>() + shift_of_base<Scalar>(kind, frame, error);
  built.frame = leaning<Scalar>(kind, frame, error);
  built.arm = swings ? Scalar(rod.arm + error("arm_length")) : Scalar(0);
  built.joint_offset = error("zero");
  built.gain = swings ? Scalar(1) : gain_with<Scalar>(error);
  built.elbow_frame = built.plate_frame = Matrix3<Scalar>::Identity();
  built.elbow_width = built.plate_width = Scalar(nominal.parallelogram_width);
  built.plate = rod.plate.cast<Scalar>() + Vector3<Scalar>(error("plate_x"), error("plate_y"), error("plate_z"));
  built.rod = {length, length};
  built.slide_sign = 0.0;
  return built;
}

}  // namespace detail

template <typename Scalar>
BasicMachine<Scalar> build(const RobotDescription& robot, const BasicSourceErrors<Scalar>& errors) {
  using detail::rotation_x, detail::rotation_y, detail::rotation_z;
  const Geometry& nominal = robot.geometry;
  BasicMachine<Scalar> machine;
  machine.limb_count = nominal.limb_azimuth.size();
  machine.side = robot.workspace.top_z > 0.0 ? 1.0 : -1.0;
  machine.freedoms = nominal.freedoms;
  machine.guided_z = robot.workspace.top_z;
  if (robot.slide) {
    machine.slide_axis = robot.slide->axis;
    machine.pinion_radius = robot.slide->pinion_radius;
  }
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    machine.first_parameter[i + 1] =
        static_cast<std::uint16_t>(machine.first_parameter[i] + sources_of(nominal.actuator).size());
    const auto error = [&](Source source) -> Scalar { return errors(i, source) + robot.intended(i, source); };
    if (on_single_rods(nominal.actuator)) {
      machine.limbs[i] = detail::single_rod<Scalar>(nominal, i, error);
      continue;
    }
    const Eigen::Matrix3d frame = detail::nominal_frame(nominal.limb_azimuth[i]);
    // Rot(x, pi/2 + alpha) = Rot(x, pi/2) Rot(x, alpha), which keeps the zero entries of the nominal frame exact.
    const auto tilted = [&](const Scalar& alpha, const Matrix3<Scalar>& by_beta) -> Matrix3<Scalar> {
      return frame.cast<Scalar>() * (rotation_x(alpha) * by_beta);
    };
    BasicLimb<Scalar>& limb = machine.limbs[i];
    limb.actuator = nominal.actuator;
    const bool on_rail = nominal.actuator == Actuator::linear;
    const Scalar beta0 = error("beta0"), beta3 = (on_rail ? Scalar(0) : beta0) - error("beta03");
    limb.radial = frame.col(0);
    limb.base = (nominal.base_radius * limb.radial).template cast<Scalar>() +
                Vector3<Scalar>(error("e_x"), error("e_y"), error("e_z"));
    limb.frame = tilted(error("alpha0"), on_rail ? rotation_z(beta0) : rotation_y(beta0));
    limb.arm = nominal.arm + (on_rail ? Scalar(0) : error("arm_length"));
    limb.gain = on_rail ? detail::gain_with<Scalar>(error) : Scalar(1);
    limb.joint_offset = error("theta_offset");
    limb.elbow_frame = rotation_x(error("alpha2")) * rotation_y(error("beta2"));
    limb.elbow_width = nominal.parallelogram_width + error("width_difference");
    limb.plate = (nominal.plate_radius * limb.radial).template cast<Scalar>();
    limb.plate_frame = tilted(error("alpha0") - error("alpha03"), rotation_y(beta3));
    limb.plate_width = Scalar(nominal.parallelogram_width);
    const Scalar mean = nominal.rod + error("rod_mean");
    const Scalar half_difference = Scalar(0.5) * error("rod_difference");
    limb.rod = {mean + half_difference, mean - half_difference};
    limb.slide_sign = robot.slide ? robot.slide->sign[i] : 0.0;
    for (const Source source : all_sources()) {
      if (paracal::tilts_plate(source) && error(source) != Scalar(0)) machine.tilts_plate = true;
    }
  }
  return machine;
}

}  // namespace paracal
