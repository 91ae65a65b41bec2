#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace paracal::test {

/// A motion as LinuxCNC's interpreter calls it: straight, or an arc about an axis of the frame. Machine coordinates,
/// mm.
struct CanonicalMove {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  double from_rotation = 0.0, to_rotation = 0.0;  ///< C, deg
  int first = 0, second = 1;                      ///< axes of the arc's plane
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double sweep = 0.0;  ///< rad; 0: straight
  double feed = 0.0;   ///< mm or deg a minute; 0: a traverse
  int line = 0;        ///< the last N word

  /// mm along X, Y and Z.
  double length() const;
  /// min, as LinuxCNC counts it: along X, Y and Z, else along C; of a traverse 0.
  double time() const;

  Eigen::Vector3d at(double t) const;
  double rotation_at(double t) const { return from_rotation + t * (to_rotation - from_rotation); }
  /// mm
  double distance(const Eigen::Vector3d& point) const;
};

/// Motions between two calls of another kind.
using CanonicalPath = std::vector<CanonicalMove>;

/// What LinuxCNC's stand-alone interpreter makes of a program.
struct CanonicalProgram {
  bool is_accepted = false;
  std::string complaint;
  double rounding = 1.5e-4;          ///< of the four decimals that are printed, in the largest unit, mm
  std::vector<std::string> others;   ///< calls that move nothing, as they are printed, but for feeds
  std::vector<CanonicalPath> paths;  ///< before the first of these, between them, behind the last
};

/// @param interpreter  rs274 of Debian's linuxcnc-uspace.
/// @param folder       where it keeps parameters and its tool table: no other interpreter's.
/// @param counts_tools the origin is that of a tool without length; else that of the first motion's.
CanonicalProgram interpreted(const std::string& interpreter, const std::filesystem::path& folder,
                             const std::filesystem::path& program, bool counts_tools = false);

}  // namespace paracal::test
