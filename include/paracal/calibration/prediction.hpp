#pragma once

#include <Eigen/Core>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/mechanism/machine.hpp"

namespace paracal {

/// Source errors known with a covariance: what predictions are made from. Built from a Calibration, a calibration file,
/// or a plan.
struct KnownErrors {
  SourceErrors errors;
  std::vector<SoughtSource> parameters;
  Eigen::MatrixXd covariance;  ///< of the parameters, mm and rad
};

KnownErrors known_errors(const Calibration& calibration);

/// What readings would tell of a machine whose errors are within their tolerances, before they are taken: zero errors
/// with the covariance after measuring as planned. Readings that state no sigma weigh as options.noise says.
/// @throws as calibrate().
KnownErrors promised(const Robot& robot, const Measurements& given, const CalibrationOptions& options = {});

/// d(x, y, z, phi) / d(parameters) at joints, mm and rad: 4 rows. Empty where the machine is singular.
Eigen::MatrixXd pose_jacobian(const Machine& machine, const Joints& joints,
                              const std::vector<SoughtSource>& parameters);

/// A pose as the identified machine takes it, with its uncertainty in the robot's frame.
struct PredictedPose {
  Pose pose;
  Eigen::Matrix4d covariance;  ///< of x, y, z (mm), phi (rad)
};

/// @throws Unreachable when the machine does not close at these joints.
PredictedPose predict(const Robot& robot, const KnownErrors& known, const Joints& joints);

/// Standard deviations over poses, as an instrument sees them that does not know the robot's frame.
struct WorkspaceUncertainty {
  double rms_distance = 0.0, max_distance = 0.0;  ///< of d_rho, the distance to home, mm
  double rms_aligned = 0.0, max_aligned = 0.0;    ///< of |dr| after the best rigid motion has been removed, mm
  double rms_rotation = 0.0, max_rotation = 0.0;  ///< of d_phi relative to home, rad
};

/// Standard deviations at one pose, of the same quantities.
struct PoseStd {
  double distance = 0.0, aligned = 0.0;  ///< mm
  double rotation = 0.0;                 ///< rad
};

/// How known errors spread over poses (home first): linear, from stacked pose Jacobians.
class PoseSpread {
 public:
  /// @throws Unreachable when the machine does not reach a station.
  PoseSpread(const Robot& robot, const SourceErrors& errors, const std::vector<SoughtSource>& parameters,
             const std::vector<Station>& stations);

  WorkspaceUncertainty uncertainty(const Eigen::MatrixXd& covariance) const;
  /// At every pose; home has neither distance nor rotation.
  std::vector<PoseStd> each(const Eigen::MatrixXd& covariance) const;
  /// B with tr(B C) = mean over the poses of the variance of the aligned position and of `lever` x rotation, mm^2.
  Eigen::MatrixXd mean_square(double lever) const;

 private:
  // Rows of every pose but home: distance to home, aligned x, y, z, rotation relative to home.
  Eigen::MatrixXd distance_, aligned_, rotation_;
};

}  // namespace paracal
