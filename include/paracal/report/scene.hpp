#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/validation.hpp"
#include "paracal/io/json.hpp"

namespace paracal::report {

/// How far the plate centre is off at a commanded pose, in the robot's frame, mm.
struct ErrorArrow {
  std::string pose;
  Pose commanded;
  Eigen::Vector3d before;                     ///< against the nominal robot
  std::optional<Eigen::Vector3d> after = {};  ///< against the calibrated one; empty where nothing was measured
};

/// What the points of a calibration show, repeats averaged, left out readings left out. Empty where distances alone
/// were measured: they have no direction.
std::vector<ErrorArrow> measured_arrows(const Calibration& calibration, const Measurements& measurements);
std::vector<ErrorArrow> measured_arrows(const Validation& validation);

/// Where a machine with these errors goes when its controller believes the nominal robot; poses that do not close are
/// left out.
std::vector<ErrorArrow> predicted_arrows(const Robot& robot, const SourceErrors& errors,
                                         const std::vector<Station>& stations);

/// The nominal robot at these poses for a drawing, with the arrows and the tilt that these errors cause:
///   {measured, poses: [{pose, position_mm, rotation_deg, before_mm, after_mm (null: nothing measured), tilt_rad: [x,
///   y],
///    limbs: [{base_mm, elbow_mm, rods_mm: [[from, to], [from, to]]}]}]}
/// Base joint and elbow are the ends of an arm; of a rail, of the carriage. A strut has a base joint and one rod, and a
/// pose of a plate on struts tilt_deg, as commanded, and its normal; tilt_rad is how far it is turned away from there.
/// Home comes first. Beyond 250 poses the limbs are left out, poses beyond 2000 altogether.
io::Json scene(const Robot& robot, const std::vector<ErrorArrow>& arrows, const SourceErrors& errors);

}  // namespace paracal::report
