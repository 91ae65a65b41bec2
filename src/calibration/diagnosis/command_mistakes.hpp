#pragma once

// Private to calibration: commands as they would have been without a mistake.

#include <Eigen/Core>
#include <array>

#include "paracal/calibration/measurement.hpp"

namespace paracal::detail {

/// The commanded poses decide which joints the controller believed, of some station at least.
bool commands_count(const Measurements& measurements);
/// A table says which joints the controller believed, of some station at least.
bool states_joints(const Measurements& measurements);
bool commands_turn(const Measurements& measurements);
/// Of plates with six freedoms.
bool commands_tilt(const Measurements& measurements);

/// Positions times a factor.
void scale_commands(Measurements& measurements, double factor);
/// Joints that a table states times a factor.
void scale_joints(Measurements& measurements, double factor);
/// phi times a factor.
void turn_commands(Measurements& measurements, double factor);
/// The position times a matrix S; S R S^T of the tilt R where it is a rotation, as both are in the frame that it turns.
Pose turned_pose(Pose pose, const Eigen::Matrix3d& turn);
/// The same of all commands.
void turn_frame_of_commands(Measurements& measurements, const Eigen::Matrix3d& turn);

/// (tilt_x, tilt_y, tilt_z) times a matrix: signs, axes, unit.
void change_tilts(Measurements& measurements, const Eigen::Matrix3d& change);
/// Order of three rotations, the left factor first: {2, 1, 0} is Rot(z, tilt_z) Rot(y, tilt_y) Rot(x, tilt_x).
using RotationOrder = std::array<int, 3>;
/// Tilts that are angles of rotations in another order than that of paracal::Pose.
void reorder_tilts(Measurements& measurements, const RotationOrder& order);

}  // namespace paracal::detail
