#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "paracal/calibration/prediction.hpp"
#include "paracal/compensation/compensator.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// U (k = 2, 95 %) of a pose in the robot's frame, mm and rad: of position and rotation, or of position and tilt if the
/// plate has six degrees of freedom.
struct StatedU {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double rotation = 0.0;
  std::optional<Eigen::Vector3d> tilt = {};
};

/// Joints and target to command so that a machine reaches the commanded pose.
struct [[nodiscard]] CorrectedPose {
  CompensationStatus status = CompensationStatus::unreachable;  ///< of the joints; the rest is valid only if ok
  Joints joints;                                                ///< to command, rad or mm
  std::optional<Pose> target = {};          ///< for a controller that computes with the nominal robot; empty: no pose
                                            ///< has these joints
  CompensatorTilt<double> tilt = {};        ///< that no joint can remove
  std::optional<StatedU> uncertainty = {};  ///< of the resulting pose, if a covariance is known
};

/// Corrects poses of one machine. It owns copies of its inputs; threads may share it.
using PoseCorrector = std::function<CorrectedPose(const Pose& wanted)>;

/// By the inverse kinematics of the machine with its errors; linear methods by the compensator.
/// @param controller  its nominal inverse takes the targets.
/// @throws InvalidArgument for a linear method and a plate that does not stay level.
PoseCorrector pose_corrector(const Robot& robot, const KnownErrors& known, CompensationWay way,
                             const Robot& controller);
/// What a controller loses that holds the rigid machine of a calibration instead of the one with its drives: largest
/// error of distances to home over the workspace_stations(), mm; 0 where drives are even.
double loss_without_drives(const Robot& robot, const KnownErrors& with_drives, const SourceErrors& rigid);

/// The same for a controller that computes with that robot.
PoseCorrector pose_corrector(const Robot& robot, const KnownErrors& known,
                             CompensationWay way = CompensationWay::exact);

}  // namespace paracal
