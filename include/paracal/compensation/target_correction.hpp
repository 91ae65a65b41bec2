#pragma once

#include <optional>
#include <span>

#include "paracal/calibration/prediction.hpp"
#include "paracal/compensation/compensator.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// What to say of targets of a robot with spare limbs.
inline constexpr const char* kSpareLimbs =
    "the joints that the controller computes from these targets differ from the corrected ones, because with more "
    "limbs "
    "than degrees of freedom no pose of the nominal robot has those; to be exact, command the joints of compensate";

/// From commanded poses to the targets for a closed controller, which computes with the nominal robot:
///
///   target = forward(nominal, q),   q = exact inverse of the identified machine at the commanded pose
///
/// The controller computes the joints inverse(nominal, target), which bring the machine to the commanded pose. With
/// spare limbs they are nearest to q: no controller of a nominal robot commands joints that disagree.
class TargetCorrection {
 public:
  TargetCorrection(const Robot& robot, const SourceErrors& errors);
  /// The same for a controller that computes with another robot's dimensions, and drives that are uneven: q is then
  /// what is commanded so that they reach the inverse.
  TargetCorrection(const Robot& robot, const SourceErrors& errors, const Robot& controller, DriveCurves drives = {});

  const Robot& robot() const { return robot_; }
  const Machine& machine() const { return machine_; }

  /// q; nothing if the machine cannot reach the pose or is singular there.
  std::optional<Joints> joints(const Pose& wanted) const;

  /// @returns nothing if the machine cannot reach the pose or is singular there, or if the nominal robot does not close
  /// with its joints.
  std::optional<Pose> target(const Pose& wanted) const;

  /// The same for many.
  /// @param targets  as many as `wanted`.
  /// @param threads  0: one per core. The numbers do not depend on it.
  void targets(std::span<const Pose> wanted, std::span<std::optional<Pose>> targets, unsigned threads) const;

 private:
  void correct(std::span<const Pose> wanted, std::span<std::optional<Pose>> targets) const;
  std::optional<Pose> by_itself(const Pose& wanted) const;

  Robot robot_, controller_;
  Machine machine_;
  DriveCurves drives_;
  std::optional<CompensatorParameters<double>> level_;  ///< of a plate that stays level
};

}  // namespace paracal
