#pragma once

// Private to the filter: blocks of a program that ask too much of the joints.

#include <optional>

#include "target_line.hpp"

namespace paracal::io {

/// Speed and acceleration of the joints along each block at its feed,
///
///   q' = dq/dt,  q'' = d2q/dt2,  with q(t) of the identified machine at kSteps + 1 even times of the block,
///
/// against the limits of the robot. Ramps and corners between blocks belong to the controller.
class JointLoads {
 public:
  JointLoads(const TargetCorrection& correction, const RobotAxes& axes, FilterSummary& summary)
      : correction_(correction), axes_(axes), summary_(summary), limits_(correction.robot().joint_limits()) {}

  /// A corrected block. One that does not move at a known feed from a known place asks for nothing known.
  void add(const TargetLine& line);

 private:
  static constexpr int kSteps = 8;  ///< as good as 400, within a tenth (Gcode.JointLoadsAreThoseAlongTheBlock)

  bool exceeds_limit(const TargetLine& line, double seconds) const;

  const TargetCorrection& correction_;
  const RobotAxes& axes_;
  FilterSummary& summary_;
  std::optional<JointLimits> limits_;
};

}  // namespace paracal::io
