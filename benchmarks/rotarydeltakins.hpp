#pragma once

#include <array>
#include <memory>

#include "linuxcnc_hal.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::benchmark {

/// LinuxCNC's kinematics of a Delta: its compiled module, called in the same way as by its motion controller.
class RotaryDeltaKins {
 public:
  /// @returns nothing where LinuxCNC is not installed or the robot is not a Delta of three arms at 120 deg.
  static std::unique_ptr<RotaryDeltaKins> of(const Robot& robot, const LinuxcncBuild& build);
  virtual ~RotaryDeltaKins() = default;

  /// Nominal inverse, deg, knees down positive; x, y, z in mm. Its limb 0 swings in the yz plane.
  virtual std::array<double, 3> inverse(double x, double y, double z) const = 0;
  /// Nominal forward, mm, of such joints.
  virtual EmcPose forward(const std::array<double, 3>& joints) const = 0;
};

}  // namespace paracal::benchmark
