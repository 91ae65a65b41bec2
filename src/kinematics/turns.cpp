#include "turns.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace paracal::detail {

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

Eigen::Matrix3d turn_by(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  return angle == 0.0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                      : Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

Eigen::Vector3d turn_of(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& turn) {
  constexpr double kSmall = 1e-3;  // rad: below, the next terms of the series are rounding
  const double angle = turn.norm(), square = angle * angle;
  const double first = angle < kSmall ? 0.5 - square / 24.0 : (1.0 - std::cos(angle)) / square;
  const double second = angle < kSmall ? 1.0 / 6.0 - square / 120.0 : (angle - std::sin(angle)) / (square * angle);
  return Eigen::Matrix3d::Identity() + first * cross(turn) + second * cross(turn) * cross(turn);
}

Eigen::Matrix3d inverse_left_jacobian(const Eigen::Vector3d& turn) {
  constexpr double kSmall = 1e-3;
  const double angle = turn.norm(), square = angle * angle;
  const double second =
      angle < kSmall ? 1.0 / 12.0 + square / 720.0 : 1.0 / square - 0.5 / (angle * std::tan(0.5 * angle));
  return Eigen::Matrix3d::Identity() - 0.5 * cross(turn) + second * cross(turn) * cross(turn);
}

}  // namespace paracal::detail
