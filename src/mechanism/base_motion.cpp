#include "paracal/mechanism/base_motion.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace paracal {

void shift_limb(const Robot& robot, std::size_t limb, const Eigen::Vector3d& shift, SourceErrors& errors) {
  const Limb& nominal = robot.nominal().limbs[limb];
  if (has(nominal.actuator, "normal")) {
    const Eigen::Vector3d along = frame_of(robot.limbs()[limb]).transpose() * shift;
    errors(limb, "zero") += shift.dot(as_eigen(nominal.normal));
    errors(limb, "normal") += along.x();
    errors(limb, "across") += along.z();
    return;
  }
  const Source joint = has(nominal.actuator, "e_x") ? Source("e_x") : Source("base_x");
  const std::span<const Source> point = sharing(joint, nominal.actuator);
  for (std::size_t k = 0; k < point.size(); ++k) {
    const double along = shift(static_cast<Eigen::Index>(k)), same = robot.parameter(limb, point[k]).as_joint_zero;
    errors(limb, same == 0.0 ? point[k] : joint_zero(nominal.actuator)) += same == 0.0 ? along : same * along;
  }
}

double felt_std(const Robot& robot, const Tolerances& tolerances, std::size_t limb, Source source) {
  double variance = std::pow(tolerances.std(source), 2);
  for (const Parameter& one : robot.parameters()) {
    if (one.limb != limb || !is_joint_zero(source)) continue;
    variance += std::pow(one.as_joint_zero * tolerances.std(one.source), 2);
  }
  return std::sqrt(variance);
}

namespace {

/// @param along  the turn in the limb's frame.
void turn_single_rod(Actuator kind, const Eigen::Vector3d& along, std::size_t limb, SourceErrors& errors) {
  if (!has(kind, "alpha0")) return;
  const bool swings = swings_arm(kind);
  errors(limb, "alpha0") = along.x();
  errors(limb, "beta0") = swings ? along.y() : along.z();
  if (swings) errors(limb, "zero") = along.z();
}

}  // namespace

SourceErrors turned_base(const Robot& robot, const Eigen::Vector3d& turn) {
  SourceErrors errors;
  const Machine& machine = robot.nominal();
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    const Eigen::Vector3d along = limb.frame().transpose() * turn;
    if (limb.has_one_rod()) {
      turn_single_rod(limb.actuator, along, i, errors);
      shift_limb(robot, i, turn.cross(as_eigen(limb.base)), errors);
      continue;
    }
    Eigen::Vector3d shift = turn.cross(as_eigen(limb.base) - as_eigen(limb.plate));
    if (runs_on_rail(limb.actuator)) {
      const Eigen::Vector3d radial = limb.frame().transpose() * radial_of(robot.limbs()[i]);
      const double alpha = along.x() / radial.x();
      errors(i, "alpha0") = alpha;
      errors(i, "beta0") = along.z();
      shift += limb.arm * (along.y() - alpha * radial.y()) * as_eigen(limb.axis);
    } else {
      errors(i, "alpha0") = along.x();
      errors(i, "beta0") = along.y();
      errors(i, "theta_offset") = along.z();
    }
    shift_limb(robot, i, shift, errors);
  }
  return errors;
}

SourceErrors moved_plate(const Robot& robot, const Eigen::Vector3d& shift, const Eigen::Vector3d& turn) {
  SourceErrors errors;
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    const Limb& limb = robot.nominal().limbs[i];
    const Eigen::Vector3d moved = shift + turn.cross(as_eigen(limb.plate));
    if (!limb.has_one_rod()) {
      shift_limb(robot, i, -moved, errors);  // its joints count against each other
      continue;
    }
    errors(i, "plate_x") = moved.x();
    errors(i, "plate_y") = moved.y();
    errors(i, "plate_z") = moved.z();
  }
  return errors;
}

}  // namespace paracal
