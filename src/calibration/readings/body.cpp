#include "body.hpp"

#include <Eigen/Geometry>

#include "median.hpp"

namespace paracal::detail {
namespace {

/// The rotation B with which A_k B comes closest to R_k, by the axes that it turns.
Eigen::Matrix3d common_turn(const std::vector<Eigen::Matrix3d>& turns) {
  constexpr double kLength = 1000.0;  // mm, of axes: their errors are then far above where a robust fit stops to weigh
  std::vector<Eigen::Vector3d> axes, turned;
  for (const Eigen::Matrix3d& turn : turns) {
    for (const double length : {-kLength, kLength}) {  // so that their centre is the origin
      for (Eigen::Index k = 0; k < 3; ++k) {
        axes.emplace_back(length * Eigen::Vector3d::Unit(k));
        turned.emplace_back(length * turn.col(k));
      }
    }
  }
  return robust_rigid_fit(axes, turned).rotation;
}

}  // namespace

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

BodySetUp place_body(const std::vector<RigidMotion>& carriers, const std::vector<RigidMotion>& read, bool seeks_frame) {
  constexpr int kRounds = 30;
  constexpr double kSettled = 1e-3;  // mm
  BodySetUp found;
  Eigen::Vector3d from_origin = Eigen::Vector3d::Zero();  // of the carrier to that of the body, in the body's frame
  std::vector<Eigen::Vector3d> origins, seen(read.size()), levers(read.size());
  for (const RigidMotion& carrier : carriers) origins.push_back(carrier.translation);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < read.size(); ++k) seen[k] = read[k].translation - read[k].rotation * from_origin;
    if (seeks_frame) found.frame = robust_rigid_fit(origins, seen);
    for (std::size_t k = 0; k < read.size(); ++k) {
      levers[k] = read[k].rotation.transpose() * (read[k].translation - found.frame(origins[k]));
    }
    const Eigen::Vector3d before = std::exchange(from_origin, median(levers));
    if ((from_origin - before).norm() < kSettled) break;
  }
  std::vector<Eigen::Matrix3d> turns;
  for (std::size_t k = 0; k < read.size(); ++k) {
    turns.emplace_back(carriers[k].rotation.transpose() * found.frame.rotation.transpose() * read[k].rotation);
  }
  found.body.rotation = common_turn(turns);
  found.body.translation = found.body.rotation * from_origin;
  return found;
}

}  // namespace paracal::detail
