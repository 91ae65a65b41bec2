#pragma once

#include <string>
#include <vector>

namespace paracal::benchmark {

/// As in LinuxCNC's emcpos.h; mm, deg.
struct EmcPose {
  double x = 0, y = 0, z = 0, a = 0, b = 0, c = 0, u = 0, v = 0, w = 0;
};

/// Where modules of LinuxCNC are.
struct LinuxcncBuild {
  std::string title;
  std::string folder;
};

/// Debian's package, which compiles with -Os, and the same sources at -O3 (tools/comparison.sh).
std::vector<LinuxcncBuild> linuxcnc_builds();

/// A kinematics module of LinuxCNC, loaded into this program, which is all of HAL that it sees: memory, and pins, which
/// modules of one name share.
struct KinematicsModule {
  using Inverse = int (*)(const EmcPose*, double*, const unsigned long*, unsigned long*);
  using Forward = int (*)(const double*, EmcPose*, const unsigned long*, unsigned long*);
  Inverse inverse = nullptr;
  Forward forward = nullptr;

  /// Nothing can be called where it is not installed or does not start.
  static KinematicsModule load(const LinuxcncBuild& build, const std::string& name);
  bool loaded() const { return inverse != nullptr && forward != nullptr; }

  /// @returns false where the module asked for no such pin.
  static bool set(const std::string& pin, double value);
  static bool set(const std::string& pin, unsigned value);
};

}  // namespace paracal::benchmark
