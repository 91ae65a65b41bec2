#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "paracal/kinematics/closure.hpp"
#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/tolerance/characteristic.hpp"

namespace paracal {

enum class Model : std::uint8_t {
  linear,  ///< [huang2016, Eqs. (5), (6)]
  exact,   ///< the closure itself, least squares over all rods
};

/// Actual poses of a machine, by the exact model.
class SentMachine {
 public:
  /// @param compensated  its controller uses the machine without tilt errors instead of the nominal robot.
  SentMachine(const Robot& robot, const SourceErrors& errors, bool compensated);

  /// Empty if it has no solution there or at the workspace's centre, or the compensated pose is out of reach.
  std::optional<Reached> at(const Pose& commanded) const;

 private:
  Machine machine_, believed_;
  std::optional<PlateState> home_;
};

/// The components of several characteristics at several poses, as one vector. Those of characteristic c begin at row
/// first_row(c); component j at pose p is row first_row(c) + j poses + p.
class Response {
 public:
  /// @throws Unreachable, InvalidArgument as LinearModel::rows.
  Response(const Robot& robot, std::vector<Characteristic> characteristics, std::vector<Pose> poses);

  const std::vector<Characteristic>& characteristics() const { return characteristics_; }
  const std::vector<Pose>& poses() const { return poses_; }
  Eigen::Index rows() const { return linear_.rows(); }
  Eigen::Index first_row(std::size_t characteristic) const { return first_row_[characteristic]; }

  /// Derivative with respect to the parameters of the robot.
  const Eigen::MatrixXd& linear() const { return linear_; }

  /// The components of a machine, by the exact model: its controller uses the nominal robot, or (compensated) the
  /// machine without its tilt errors.
  /// @returns false if there is no solution, or the compensated pose is out of reach, at some pose.
  bool exact(const SourceErrors& errors, Eigen::Ref<Eigen::VectorXd> components) const;

  /// Squared lengths of a characteristic, from components of many machines, one column each; one row per pose.
  Eigen::ArrayXXd squared_lengths(std::size_t characteristic, const Eigen::MatrixXd& components) const;

 private:
  bool add_exact(const SourceErrors& errors, bool compensated, Eigen::Ref<Eigen::VectorXd> components) const;

  Robot robot_;  ///< a copy: the caller may give a temporary
  std::vector<Characteristic> characteristics_;
  std::vector<Pose> poses_;
  std::vector<Eigen::Index> first_row_;
  Eigen::MatrixXd linear_;
};

}  // namespace paracal
