#include "paracal/mechanism/base_motion.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace paracal {

void shift_limb(const Robot& robot, std::size_t limb, const Eigen::Vector3d& shift, SourceErrors& errors) {
  const Limb& nominal = robot.nominal().limbs[limb];
  if (robot.actuator() == Actuator::carriage) {
    errors(limb, "zero") += shift.dot(nominal.frame.col(1));
    errors(limb, "normal") += shift.dot(nominal.radial);
    errors(limb, "across") += shift.dot(nominal.sideways);
    return;
  }
  Eigen::Vector3d e = shift;
  if (robot.actuator() == Actuator::linear) {
    const Eigen::Vector3d rail = nominal.frame.col(1);
    const double along = shift.z() / rail.z();
    errors(limb, "theta_offset") += along;
    e -= along * rail;
  }
  if (nominal.has_one_rod()) {
    errors(limb, "base_x") += e.x();
    errors(limb, "base_y") += e.y();
    errors(limb, "base_z") += e.z();
    return;
  }
  errors(limb, "e_x") += e.x();
  errors(limb, "e_y") += e.y();
  if (robot.actuator() != Actuator::linear) errors(limb, "e_z") += e.z();
}

double felt_std(const Robot& robot, const Tolerances& tolerances, Source source) {
  const double own = tolerances.std(source);
  const bool takes_e_z = robot.actuator() == Actuator::linear && source == "theta_offset";
  return takes_e_z ? std::hypot(own, tolerances.std("e_z")) : own;
}

namespace {

/// @param along  the turn in the limb's frame.
void turn_single_rod(Actuator kind, const Eigen::Vector3d& along, std::size_t limb, SourceErrors& errors) {
  if (kind == Actuator::strut) return;
  errors(limb, "alpha0") = along.x();
  errors(limb, "beta0") = kind == Actuator::crank ? along.y() : along.z();
  if (kind == Actuator::crank) errors(limb, "zero") = along.z();
}

}  // namespace

SourceErrors turned_base(const Robot& robot, const Eigen::Vector3d& turn) {
  SourceErrors errors;
  const Machine& machine = robot.nominal();
  for (std::size_t i = 0; i < machine.limb_count; ++i) {
    const Limb& limb = machine.limbs[i];
    const Eigen::Vector3d along = limb.frame.transpose() * turn;
    if (limb.has_one_rod()) {
      turn_single_rod(limb.actuator, along, i, errors);
      shift_limb(robot, i, turn.cross(limb.base), errors);
      continue;
    }
    Eigen::Vector3d shift = turn.cross(limb.base - limb.plate);
    if (limb.actuator == Actuator::linear) {
      const Eigen::Vector3d radial = limb.frame.transpose() * limb.radial;
      const double alpha = along.x() / radial.x();
      errors(i, "alpha0") = alpha;
      errors(i, "beta0") = along.z();
      shift += limb.arm * (along.y() - alpha * radial.y()) * limb.frame.col(2);
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
    const Eigen::Vector3d moved = shift + turn.cross(robot.nominal().limbs[i].plate);
    errors(i, "plate_x") = moved.x();
    errors(i, "plate_y") = moved.y();
    errors(i, "plate_z") = moved.z();
  }
  return errors;
}

}  // namespace paracal
