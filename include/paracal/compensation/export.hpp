#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "paracal/calibration/prediction.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal {

/// How exports find the tilt of a plate on limbs with two rods. Other limbs close in closed form: always exact.
enum class ExportVariant : std::uint8_t {
  exact,     ///< until it converges
  one_step,  ///< one step: bounded time, less code to run
  single,    ///< a fixed number of steps in float: for controllers without a unit for double
};

/// Origin of the errors of an export, so that it can be traced from the controller.
struct ExportOrigin {
  std::string calibration;                ///< file name
  std::string sha256;                     ///< of that file
  std::string date;                       ///< of the export, ISO 8601
  std::vector<std::string> remarks = {};  ///< lines for its head: assumptions, joints to compare
  ExportVariant variant = ExportVariant::exact;
};

/// The numbers of a machine for paracal_change of an export: numbers, layout and sum as one list, and what they are.
struct ExportedSet {
  std::vector<std::string> names;  ///< "limb 1 base x"; of the numbers
  std::vector<double> set;
};
ExportedSet exported_set(const Robot& robot, const SourceErrors& errors, const DriveCurves& drives = {});

/// Text, such as a file name, that cannot end a comment or a string of any target.
std::string harmless(std::string text);

/// A compensator of any robot that has_compensator(), as one header for freestanding targets, C99 and C++, with the
/// numbers of this machine. It also has the forward kinematics, the derivative of the joints by the pose, changes to
/// the numbers of a later calibration, and a self-test with its data. It needs sqrt, sin, cos and atan2.
/// @throws Unreachable when the machine does not reach the centre of the robot's workspace; InvalidArgument for robots
/// without compensator.
std::string c99_header(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin,
                       const DriveCurves& drives = {});

/// The same as a component of LinuxCNC, to be built by halcompile from a file named paracal_kins.comp: kinematics
/// (forward and inverse) and, for tests, HAL functions between pins.
/// @throws as c99_header.
std::string linuxcnc_component(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin,
                               const DriveCurves& drives = {});

/// A plate on struts for LinuxCNC's own genhexkins: the 36 coordinates of its joints, and the lengths and gains of its
/// drives, as HAL lines.
/// @throws InvalidArgument for other robots.
std::string genhexkins(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin);

/// An example configuration of LinuxCNC with that component: the files of a folder by name, with INI, HAL, tools, work
/// offsets, a program and README.md. Its motors are loops in HAL. Joints are homed with the plate at the centre of the
/// workspace. Their limits are the joint range of the whole workspace with the identified machine, plus 1 deg (5 mm of
/// carriages and struts) on each side. Speeds are examples.
/// @throws as c99_header.
std::map<std::string, std::string> linuxcnc_configuration(const Robot& robot, const SourceErrors& errors,
                                                          const ExportOrigin& origin, const DriveCurves& drives = {});

/// The compensator as IEC 61131-3 Structured Text for programmable controllers: function blocks paracal_compensator,
/// paracal_jacobian, paracal_forward, paracal_changing and paracal_self_test, in the common subset of CODESYS, TwinCAT
/// and matiec. It never takes the root of a negative number and never divides by zero.
/// @throws as c99_header; InvalidArgument for the variant in float.
std::string structured_text(const Robot& robot, const SourceErrors& errors, const ExportOrigin& origin,
                            const DriveCurves& drives = {});

}  // namespace paracal
