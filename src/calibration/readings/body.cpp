#include "body.hpp"

#include <Eigen/Geometry>
#include <array>

#include "numerics/dense.hpp"
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

BodySetUp place_reflector(const std::vector<RigidMotion>& carriers, const std::vector<Eigen::Vector3d>& read,
                          bool seeks_frame) {
  constexpr int kRounds = 20;
  constexpr double kSettled = 1e-3, kLever = 100.0, kHardly = 1e-3;  // mm; mm: turns and shifts of one size; of rows
  const auto count = static_cast<Eigen::Index>(read.size());
  const Eigen::Index motions = seeks_frame ? 6 : 0;
  BodySetUp found;
  std::vector<Eigen::Vector3d> places(read.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < read.size(); ++k) places[k] = carriers[k](found.body.translation);
    if (seeks_frame) found.frame = robust_rigid_fit(places, read);
    // How far each point is off by the place and by what the frame takes up of it.
    Eigen::MatrixXd rows(3 * count, 3 + motions);
    Eigen::VectorXd off(3 * count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const Eigen::Vector3d x = places[at] / kLever;
      rows.block<3, 3>(3 * k, 0) = carriers[at].rotation;
      if (seeks_frame) {
        rows.block<3, 3>(3 * k, 3).setIdentity();
        rows.block<3, 3>(3 * k, 6) << 0, x.z(), -x.y(), -x.z(), 0, x.x(), x.y(), -x.x(), 0;
      }
      off.segment<3>(3 * k) = found.frame.inverse()(read[at]) - places[at];
    }
    const Eigen::Vector3d step = shortest_solution(rows, off, kHardly).topRows(3);
    found.body.translation += step;
    if (step.norm() < kSettled) break;
  }
  return found;
}

std::string_view centre_of(ReflectorMount mount) {
  constexpr std::array kCentres{"the plate's centre", "the axis of phi and turns with it",
                                "the axis of phi and turns by -phi"};
  return kCentres.at(static_cast<std::size_t>(mount));
}

}  // namespace paracal::detail
