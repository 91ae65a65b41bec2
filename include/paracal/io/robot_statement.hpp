#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "paracal/io/file.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::io {

struct JsonFile;

/// A robot, and where it is stated.
struct RobotStatement {
  Robot robot;
  std::string by = {};                                   ///< file or option, for messages
  int line = 0;                                          ///< of the file; 0: no line
  std::optional<std::filesystem::path> robot_file = {};  ///< that describes it, if any
};

/// The robot of a name: a file if the name has a folder or ends in .toml, else a robot of the catalogue.
/// @param folder  of relative files; empty: the current one.
/// @throws InvalidArgument for a name that is neither, InputFileError for a file that is not a robot.
RobotStatement named_robot(const std::string& name, const std::filesystem::path& folder = {});

/// The robot of a comment line "# robot: NAME" of a table; nothing for any other line. Files are relative to the
/// table's folder.
/// @throws InputFileError for an unknown name.
std::optional<RobotStatement> robot_of_line(const std::string& file, int line, std::string_view text);

/// The same into `found`, if it is empty.
/// @throws InputFileError as above, and if the line states another robot than `found`.
void add_statement(std::optional<RobotStatement>& found, const std::string& file, int line, std::string_view text);

/// The robot that a table states, in any line.
/// @throws InputFileError as above, and if two of its lines disagree.
std::optional<RobotStatement> robot_of_table(const TextFile& file);

/// The robot in a calibration (JSON).
/// @throws InputFileError for JSON without a robot, or an implausible robot.
RobotStatement robot_of_calibration(const JsonFile& file);

/// "geometry.rod_mm 950, got 951": the first difference in name, geometry or plate of two robots. Numbers differ if by
/// more than 1e-9 (relative, from 1 mm, deg or unit vector upwards): writing and reading a robot loses that much.
/// Workspace and tolerances are requirements and are not compared.
std::optional<std::string> difference(const Robot& expected, const Robot& got);

/// @throws InputFileError with the file of `got` if the two differ.
void require_same(const RobotStatement& expected, const RobotStatement& got);

/// "# robot: huang2016\n" for robots of the catalogue; nothing for others.
std::string robot_line(const Robot& robot);

}  // namespace paracal::io
