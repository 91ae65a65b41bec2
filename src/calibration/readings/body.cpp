#include "body.hpp"

#include <Eigen/Geometry>

#include "numerics/median.hpp"

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
