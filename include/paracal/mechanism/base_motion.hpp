#pragma once

#include <Eigen/Core>

#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// Motions of the base, and with it of the plate joints' circle, written as source errors of the position group, to
/// first order. An error with the effect of the joint zero is not used (Parameter::as_joint_zero): up its upright rail
/// a limb moves by theta_offset.

/// Adds a shift of one limb's base joint, mm: e = shift.
void shift_limb(const Robot& robot, std::size_t limb, const Eigen::Vector3d& shift, SourceErrors& errors);

/// Standard deviation of an error of a limb; of its joint zero with that of all that has the same effect.
double felt_std(const Robot& robot, const Tolerances& tolerances, std::size_t limb, Source source);

/// The base turned by a small rotation about the origin, rad:
///
///   arm    e = turn x (b - a),                     alpha0 = turn.u0,  beta0 = turn.v0,  theta_offset = turn.w0
///   rail   e = turn x (b - a) + L (turn.v0 - alpha0 r.v0) w0,   alpha0 = turn.u0 / r.u0,  beta0 = turn.w0
///   strut  e = turn x b
///
/// r: the limb's radial direction, which is u0 unless the rail leans.
SourceErrors turned_base(const Robot& robot, const Eigen::Vector3d& turn);

/// The joints on the plate, moved on it: shifted (mm) and turned about its centre (rad), to first order.
SourceErrors moved_plate(const Robot& robot, const Eigen::Vector3d& shift, const Eigen::Vector3d& turn);

}  // namespace paracal
