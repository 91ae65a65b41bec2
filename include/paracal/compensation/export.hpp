#pragma once

#include <map>
#include <string>
#include <vector>

#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// Origin of the errors of an export, so that it can be traced from the controller.
struct ExportOrigin {
  std::string calibration;                ///< file name
  std::string sha256;                     ///< of that file
  std::string date;                       ///< of the export, ISO 8601
  std::vector<std::string> remarks = {};  ///< lines for its head: assumptions, joints to compare
};

/// Text, such as a file name, that cannot end a comment or a string of any target.
std::string harmless(std::string text);

/// A plate that three or four parallelograms keep level, or limbs of one kind with one rod each, as many as the plate
/// has degrees of freedom.
bool has_compensator(const Robot& robot);

/// A compensator as one header for freestanding targets, C99 and C++: the exact method of compensator.hpp, or of
/// struts, with the constants of this machine. It also has the forward kinematics and a self-test with its data. It
/// needs sqrt, sin, cos and, for arms, atan2.
/// @throws Unreachable when the machine does not reach the centre of the robot's workspace.
std::string c99_header(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin);

/// The same as a component of LinuxCNC, to be built by halcompile from a file named paracal_kins.comp: kinematics
/// (forward and inverse) and, for tests, a HAL function between pins.
/// @throws as c99_header.
std::string linuxcnc_component(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin);

/// A plate on struts for LinuxCNC's own genhexkins: the 36 coordinates of its joints, and the lengths and gains of its
/// drives, as HAL lines.
/// @throws InvalidArgument for other robots.
std::string genhexkins(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin);

/// An example configuration of LinuxCNC with that component: the files of a folder by name, with INI, HAL, tools, work
/// offsets, a program and README.md. Its motors are loops in HAL. Joints are homed with the plate at the centre of the
/// workspace. Their limits are the joint range of the whole workspace with the identified machine, plus 1 deg (5 mm on
/// rails) on each side. Speeds are examples.
/// @throws as c99_header.
std::map<std::string, std::string> linuxcnc_configuration(const Robot& robot, const SourceErrors& errors,
                                                          const ExportOrigin& origin);

/// The compensator as IEC 61131-3 Structured Text for programmable controllers: function blocks paracal_compensator,
/// paracal_forward and paracal_self_test, in the common subset of CODESYS, TwinCAT and matiec. It never takes the root
/// of a negative number and never divides by zero.
/// @throws as c99_header.
std::string structured_text(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin);

}  // namespace paracal
