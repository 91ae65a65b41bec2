#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "paracal/calibration/validation.hpp"
#include "paracal/io/json.hpp"

namespace paracal::report {

/// Position error of the plate centre at a commanded pose, in the robot's frame, mm.
struct ErrorArrow {
  std::string pose;
  Pose commanded;
  Eigen::Vector3d before;                     ///< relative to the nominal robot
  std::optional<Eigen::Vector3d> after = {};  ///< relative to the calibrated machine; empty if not measured
};

/// Errors of the points of a calibration: repeats averaged, excluded readings omitted. Empty if only distances
/// were measured: they have no direction.
std::vector<ErrorArrow> measured_arrows(const Calibration& calibration, const Measurements& measurements);
std::vector<ErrorArrow> measured_arrows(const Validation& validation);

/// Errors of a machine with these errors if its controller uses the nominal robot; poses without a solution are
/// omitted.
std::vector<ErrorArrow> predicted_arrows(const Robot& robot, const SourceErrors& errors,
                                         const std::vector<Station>& stations);

/// The nominal robot at these poses for a drawing, with the arrows and the tilt that these errors cause:
///   {measured, poses: [{pose, position_mm, rotation_deg, before_mm, after_mm (null: nothing measured), tilt_rad: [x,
///   y],
///    limbs: [{base_mm, elbow_mm, rods_mm: [[from, to], [from, to]]}]}]}
/// Base joint and elbow are the ends of an arm; of a rail, of the carriage. A strut has a base joint and one rod, and a
/// pose of a plate on struts tilt_deg, as commanded, and its normal; tilt_rad is the rotation relative to this.
/// Home is first. Only the first 250 poses have limbs; poses after the 2000th are omitted.
io::Json scene(const Robot& robot, const std::vector<ErrorArrow>& arrows, const SourceErrors& errors);

}  // namespace paracal::report
