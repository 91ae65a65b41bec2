#pragma once

// Private to calibration: commands as they would have been without a mistake.

#include <Eigen/Core>

#include "paracal/calibration/measurement.hpp"

namespace paracal::detail {

/// The commanded poses decide which joints the controller believed, of some station at least.
bool commands_count(const Measurements& measurements);
/// A table says which joints the controller believed, of some station at least.
bool states_joints(const Measurements& measurements);
bool commands_turn(const Measurements& measurements);

/// Positions times a factor.
void scale_commands(Measurements& measurements, double factor);
/// Joints that a table states times a factor.
void scale_joints(Measurements& measurements, double factor);
/// phi times a factor.
void turn_commands(Measurements& measurements, double factor);
/// Positions times a matrix.
void turn_frame_of_commands(Measurements& measurements, const Eigen::Matrix3d& turn);

}  // namespace paracal::detail
