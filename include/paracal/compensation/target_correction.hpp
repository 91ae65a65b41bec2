#pragma once

#include <optional>
#include <span>

#include "paracal/compensation/compensator.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// From commanded poses to the targets for a closed controller, which computes with the nominal robot:
///
///   target = forward(nominal, q),   q = exact inverse of the identified machine at the commanded pose
///
/// The controller computes the joints inverse(nominal, target), which bring the machine to the commanded pose.
class TargetCorrection {
 public:
  TargetCorrection(const Robot& robot, const SourceErrors& errors);
  /// The same for a controller that computes with another robot's dimensions.
  TargetCorrection(const Robot& robot, const SourceErrors& errors, const Robot& controller);

  const Robot& robot() const { return robot_; }
  const Compensator<double>& compensator() const { return compensator_; }

  /// @returns nothing if the machine cannot reach the pose or is singular there, or if the nominal robot does not close
  /// with its joints.
  std::optional<Pose> target(const Pose& wanted) const;

  /// The same for many.
  /// @param targets  as many as `wanted`.
  /// @param threads  0: one per core. The numbers do not depend on it.
  void targets(std::span<const Pose> wanted, std::span<std::optional<Pose>> targets, unsigned threads) const;

 private:
  void correct(std::span<const Pose> wanted, std::span<std::optional<Pose>> targets) const;
  std::optional<Pose> by_itself(const Pose& wanted, const CompensatorPose<double>& pose) const;

  Robot robot_, controller_;
  Compensator<double> compensator_;
};

}  // namespace paracal
