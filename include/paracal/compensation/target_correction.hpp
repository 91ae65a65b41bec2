#pragma once

#include <optional>
#include <span>

#include "paracal/compensation/compensator.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// From wanted poses to the targets that a closed controller must be told, one that computes with the nominal robot:
///
///   target = forward(nominal, q),   q = exact inverse of the identified machine at the wanted pose
///
/// so that the controller, whose joints are inverse(nominal, target), brings the machine to the wanted pose.
class TargetCorrection {
 public:
  TargetCorrection(const Robot& robot, const SourceErrors& errors);
  /// The same for a controller that computes with another robot's dimensions.
  TargetCorrection(const Robot& robot, const SourceErrors& errors, const Robot& controller);

  const Robot& robot() const { return robot_; }
  const Compensator<double>& compensator() const { return compensator_; }

  /// @returns nothing where the machine does not reach the pose or is singular there, or the nominal robot does not
  /// close with its joints.
  std::optional<Pose> target(const Pose& wanted) const;

  /// The same for many.
  /// @param targets  as many as `wanted`.
  /// @param threads  0: one a core. The numbers do not depend on it.
  void targets(std::span<const Pose> wanted, std::span<std::optional<Pose>> targets, unsigned threads) const;

 private:
  void correct(std::span<const Pose> wanted, std::span<std::optional<Pose>> targets) const;
  std::optional<Pose> by_itself(const Pose& wanted, const CompensatorPose<double>& pose) const;

  Robot robot_, controller_;
  Compensator<double> compensator_;
};

}  // namespace paracal
