#include "command_mistakes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "paracal/kinematics/closure.hpp"

namespace paracal::detail {
namespace {

template <typename Change>
void change_commands(Measurements& measurements, Change&& change) {
  for (Station& station : measurements.stations) change(station.commanded);
}

/// The angles of R = Rot(x, tilt_x) Rot(y, tilt_y) Rot(z, tilt_z), tilt_y within a right angle.
Eigen::Vector3d tilts_of(const Eigen::Matrix3d& rotation) {
  return {std::atan2(-rotation(1, 2), rotation(2, 2)), std::asin(std::clamp(rotation(0, 2), -1.0, 1.0)),
          std::atan2(-rotation(0, 1), rotation(0, 0))};
}

}  // namespace

bool commands_count(const Measurements& measurements) {
  return std::ranges::any_of(measurements.stations, [](const Station& one) { return !one.believed; });
}

bool states_joints(const Measurements& measurements) {
  return std::ranges::any_of(measurements.stations, [](const Station& one) { return one.believed.has_value(); });
}

bool commands_turn(const Measurements& measurements) {
  return std::ranges::any_of(measurements.stations, [](const Station& one) { return one.commanded.rotation != 0.0; });
}

bool commands_tilt(const Measurements& measurements) {
  return std::ranges::any_of(measurements.stations, [](const Station& one) { return !one.commanded.tilt.isZero(0.0); });
}

void scale_commands(Measurements& measurements, double factor) {
  change_commands(measurements, [&](Pose& pose) { pose.position *= factor; });
}

void scale_joints(Measurements& measurements, double factor) {
  for (Station& station : measurements.stations) {
    if (station.believed) *station.believed *= factor;
  }
}

void turn_commands(Measurements& measurements, double factor) {
  change_commands(measurements, [&](Pose& pose) { pose.rotation *= factor; });
}

Pose turned_pose(Pose pose, const Eigen::Matrix3d& turn) {
  pose.position = turn * pose.position;
  if (turn.determinant() > 0.0 && !pose.tilt.isZero(0.0)) {
    pose.tilt = tilts_of(turn * plate_rotation(pose.tilt).matrix * turn.transpose());
  }
  return pose;
}

void turn_frame_of_commands(Measurements& measurements, const Eigen::Matrix3d& turn) {
  change_commands(measurements, [&](Pose& pose) { pose = turned_pose(std::move(pose), turn); });
}

void change_tilts(Measurements& measurements, const Eigen::Matrix3d& change) {
  change_commands(measurements, [&](Pose& pose) { pose.tilt = change * pose.tilt; });
}

void reorder_tilts(Measurements& measurements, const RotationOrder& order) {
  change_commands(measurements, [&](Pose& pose) {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    for (const int axis : order) {
      rotation *= Eigen::AngleAxisd(pose.tilt(axis), Eigen::Vector3d::Unit(axis)).toRotationMatrix();
    }
    pose.tilt = tilts_of(rotation);
  });
}

}  // namespace paracal::detail
