#pragma once

#include <map>
#include <string>
#include <vector>

#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// Where the errors of an export come from, to be found again from the controller.
struct ExportOrigin {
  std::string calibration;                ///< file name
  std::string sha256;                     ///< of that file
  std::string date;                       ///< of the export, ISO 8601
  std::vector<std::string> remarks = {};  ///< lines for its head: what was assumed, joints to compare
};

/// Text, as a file's name, that cannot end a comment or a string of any target.
std::string harmless(std::string text);

/// A compensator as one header for freestanding targets, C99 and C++: the exact way of compensator.hpp, or of struts,
/// with the constants of this machine, the way back from joints to pose, and a self-test vector with a function that
/// runs it. It needs sqrt, sin, cos and, where there are arms, atan2.
/// @throws Unreachable when the machine does not reach the centre of the robot's workspace.
std::string c99_header(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin);

/// The same as a component of LinuxCNC, to be built by halcompile from a file named paracal_kins.comp: kinematics
/// (forward and inverse) and, for trying, a HAL function between pins.
/// @throws as c99_header.
std::string linuxcnc_component(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin);

/// A plate on struts for LinuxCNC's own genhexkins: the 36 coordinates of its joints, and the lengths and gains of its
/// drives, as lines of HAL.
/// @throws InvalidArgument for other robots.
std::string genhexkins(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin);

/// A sample machine of LinuxCNC around that component: the files of a folder by their names, with INI, HAL, tools, work
/// offsets, a program and README.md. Its motors are loops in HAL. Joints are homed where they take the plate to the
/// centre of the workspace; their limits are what the whole workspace asks of the identified machine and 1 deg, or 5 mm
/// of rails, more on each side. Speeds are sample values.
/// @throws as c99_header.
std::map<std::string, std::string> linuxcnc_configuration(const Robot& robot, const SourceErrors& errors,
                                                          const ExportOrigin& origin);

/// The compensator as IEC 61131-3 Structured Text for programmable controllers: function blocks paracal_compensator,
/// paracal_forward and paracal_self_test, in what CODESYS, TwinCAT and matiec have in common. It asks for no root of a
/// negative number and for no division by zero.
/// @throws as c99_header.
std::string structured_text(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin);

}  // namespace paracal
