#pragma once

// Private to calibration: numbers of a robot file, and what errors have in common where one of them is wrong.

#include <functional>
#include <string>
#include <vector>

#include "paracal/mechanism/robot.hpp"

namespace paracal::detail {

/// A number of the robot file, in mm or rad.
struct Dimension {
  std::string key;
  bool angle = false;
  std::function<double(const RobotDescription&)> value;
  std::function<void(RobotDescription&, double)> set;
  SourceErrors direction = {};  ///< what all limbs have in common per mm or rad that it is larger
};

/// base_radius_mm, plate_radius_mm, arm_mm, rod_mm; none of limbs with their own dimensions.
std::vector<Dimension> dimensions_of_all_limbs(const Robot& robot);
/// The numbers of the file that errors show: base_radius_mm, plate_radius_mm, arm_mm, rod_mm and limb_azimuth_deg of
/// each limb; of limbs with their own dimensions the lengths of these.
std::vector<Dimension> dimensions(const Robot& robot);

/// pinion_radius_mm, of a plate with a slide.
Dimension pinion_radius();

/// What errors have in common where all these are larger by their own size, per unit.
SourceErrors larger_robot(const Robot& robot);

/// The robot with another number. A trial needs no workspace: one that does not reach all of the file's is as good.
Robot with(const Robot& robot, const Dimension& dimension, double value);
/// What the file says.
double now(const Robot& robot, const Dimension& dimension);

}  // namespace paracal::detail
