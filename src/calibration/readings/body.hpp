#pragma once

// Private to calibration: a rigid body on the plate whose pose an instrument reads, as motion capture does.

#include <Eigen/Core>
#include <vector>

#include "paracal/calibration/rigid_fit.hpp"

namespace paracal::detail {

/// [v] with [v] x = v x x.
Eigen::Matrix3d cross(const Eigen::Vector3d& v);

/// exp([turn])
Eigen::Matrix3d turn_by(const Eigen::Vector3d& turn);

/// The turn of exp([turn]), no longer than pi, rad.
Eigen::Vector3d turn_of(const Eigen::Matrix3d& rotation);

/// J with exp([w + dw]) = exp([J dw]) exp([w]):
///
///   J = I + (1 - cos a) / a^2 [w] + (a - sin a) / a^3 [w]^2,   a = |w|
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& turn);

/// Its inverse, for turns shorter than 2 pi: I - [w] / 2 + (1 / a^2 - cot(a / 2) / (2 a)) [w]^2.
Eigen::Matrix3d inverse_left_jacobian(const Eigen::Vector3d& turn);

/// Frame of an instrument and a body on a carrier: instrument = frame(robot), carrier = body(body).
struct BodySetUp {
  RigidMotion frame = {}, body = {};
};

/// The set-up with which poses were read as read_k = frame(carrier_k(body)), from nothing: frame and place of the body
/// in turn. Where carriers hardly turn, the place stays near their origin, for the frame takes it up. Gross errors in a
/// minority of poses hardly move it.
/// @param carriers     in the robot's frame.
/// @param seeks_frame  false: it is the robot's.
BodySetUp place_body(const std::vector<RigidMotion>& carriers, const std::vector<RigidMotion>& read, bool seeks_frame);

}  // namespace paracal::detail
