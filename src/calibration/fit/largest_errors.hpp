#pragma once

// Private to calibration: the largest error of a machine anywhere, which 95 % of the machines stay below.

#include <Eigen/Core>
#include <vector>

namespace paracal::detail {

/// What moves a quantity of one or three coordinates at each of many poses.
struct PoseQuantity {
  Eigen::Index coordinates = 1;  ///< rows of a pose
  Eigen::MatrixXd by_errors;     ///< by independent standard normal numbers, those of the machine
  Eigen::MatrixXd by_joints;     ///< by the joints at the pose
  Eigen::MatrixXd by_home;       ///< by the joints at home, to which the quantity is relative; empty: to nothing
};

/// Machines that are drawn once, for every quantity and for every size of what joints are off.
class DrawnMachines {
 public:
  /// @param errors  how many numbers a machine has; a quantity may depend on the first of them alone.
  DrawnMachines(Eigen::Index errors, Eigen::Index joints);

  /// What a twentieth of the machines exceeds at some pose: |value|, or the length of three coordinates.
  ///
  /// The poses are taken in the order of their standard deviations, until those that are left hardly matter: with x
  /// exceeded by a twentieth so far, they exceed it with a probability of at most the sum of those of each.
  /// @param joint_std  of what each joint is off, anew at each pose: a figure for each of these.
  std::vector<double> largest(const PoseQuantity& quantity, const std::vector<Eigen::VectorXd>& joint_std) const;

 private:
  Eigen::MatrixXd dealt(Eigen::Index pose, Eigen::Index poses) const;

  Eigen::MatrixXd errors_;  ///< a column of each machine
  Eigen::MatrixXd joints_;  ///< dealt out anew to each machine and pose
};

}  // namespace paracal::detail
