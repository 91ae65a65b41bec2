#pragma once

// Private: rotations and the vectors along whose direction, and by whose length, they turn.

#include <Eigen/Core>

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

}  // namespace paracal::detail
