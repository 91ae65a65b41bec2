#pragma once

// Private to calibration: joints that a controller displays, against those of a suspect.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "controller_suspects.hpp"
#include "paracal/calibration/controller_joints.hpp"

namespace paracal::detail {

/// What a fit to the displayed joints leaves of it.
struct Explained {
  const ControllerSuspect* suspected = nullptr;
  PoseJoints joints;
  std::string text;
  int unknowns = 0;  ///< the fewest of all that give the same joints
};

/// Displayed minus expected, over the rounding; NaN where some pose is not reached.
class Comparison {
 public:
  /// @param displayed  must outlive it.
  Comparison(const Robot& robot, const std::vector<DisplayedJoints>& displayed);

  Eigen::VectorXd residuals(const PoseJoints& expected) const;
  Eigen::VectorXd residuals(const ControllerSuspect& suspected, const Eigen::VectorXd& values) const {
    return residuals(suspected.controller(values));
  }

  /// The coarsest of each joint.
  Joints tolerance() const;

 private:
  const std::vector<DisplayedJoints>& displayed_;
  std::vector<Joints> tolerances_;
};

/// d residuals / d values, by central differences.
Eigen::MatrixXd slopes(const Comparison& comparison, const ControllerSuspect& suspected, const Eigen::VectorXd& values);

/// The smallest change of the joints, in roundings, by a unit of the values in any direction.
double shown_by(const Eigen::MatrixXd& slope);

/// The values of a suspect that explain the joints, from the first of its starts that leads there.
/// @returns empty where the joints do not show them or no values explain the joints.
std::optional<Explained> explain(const Comparison& comparison, const ControllerSuspect& suspected);

}  // namespace paracal::detail
