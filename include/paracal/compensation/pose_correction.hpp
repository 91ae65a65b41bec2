#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "paracal/calibration/prediction.hpp"
#include "paracal/compensation/compensator.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

/// U of a pose in the robot's frame (about 95 %), mm and rad: of position and rotation, of position and tilt where the
/// plate has six freedoms.
struct StatedU {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double rotation = 0.0;
  std::optional<Eigen::Vector3d> tilt = {};
};

/// What a controller has to be told so that a machine goes where it is wanted.
struct [[nodiscard]] CorrectedPose {
  CompensationStatus status = CompensationStatus::unreachable;  ///< of the joints; without ok the rest says nothing
  Joints joints;                                                ///< to command, rad or mm
  std::optional<Pose> target = {};          ///< for a controller that computes with the nominal robot; empty: none has
                                            ///< these joints
  CompensatorTilt<double> tilt = {};        ///< that no joint removes
  std::optional<StatedU> uncertainty = {};  ///< of where the machine then stands, where a covariance is known
};

/// Corrects the poses of one machine, each by itself. Copies what it needs; threads may share it.
using PoseCorrector = std::function<CorrectedPose(const Pose& wanted)>;

/// By the compensator where the plate stays level, by the inverse kinematics of the machine with its errors where it
/// has six freedoms.
/// @param controller  whose nominal inverse takes the targets.
/// @throws InvalidArgument for a linear way of a plate with six freedoms: these are of one that stays level.
PoseCorrector pose_corrector(const Robot& robot, const KnownErrors& known, CompensationWay way,
                             const Robot& controller);
/// The same of a controller that computes with that robot.
PoseCorrector pose_corrector(const Robot& robot, const KnownErrors& known,
                             CompensationWay way = CompensationWay::exact);

}  // namespace paracal
