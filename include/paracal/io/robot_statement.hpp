#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "paracal/io/file.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::io {

/// A robot, and who says that it is the one.
struct RobotStatement {
  Robot robot;
  std::string by = {};                                   ///< file or option, for messages
  int line = 0;                                          ///< of the file; 0: no line of its own
  std::optional<std::filesystem::path> robot_file = {};  ///< that describes it, where one does
};

/// What a name of a robot stands for: a file where it has a folder or ends in .toml, else the catalogue's.
/// @param folder  that relative files are in; empty: the current one.
/// @throws InvalidArgument for a name that is neither, InputFileError for a file that is no robot.
RobotStatement named_robot(const std::string& name, const std::filesystem::path& folder = {});

/// What a comment line "# robot: NAME" of a table says; nothing for any other line. Files are found from the table's
/// folder.
/// @throws InputFileError for a name that is none.
std::optional<RobotStatement> robot_of_line(const std::string& file, int line, std::string_view text);

/// The same into `found`, where nothing is found yet.
/// @throws InputFileError as above, and where the line says something else than what was found.
void add_statement(std::optional<RobotStatement>& found, const std::string& file, int line, std::string_view text);

/// What a table says, in any line.
/// @throws InputFileError as above, and where two of its lines disagree.
std::optional<RobotStatement> robot_of_table(const TextFile& file);

/// The robot that a calibration (JSON) carries.
/// @throws InputFileError for JSON without one, or a robot that makes no sense.
RobotStatement robot_of_calibration(const TextFile& file);

/// "geometry.rod_mm 950, got 951": the first in which name, geometry or plate of two robots differ, numbers by more
/// than 1e-9 (relative, from 1 mm, deg or unit vector upwards): so much is lost when a robot is written and read.
/// Workspace and tolerances are what is wanted of it, not what it is.
std::optional<std::string> difference(const Robot& expected, const Robot& got);

/// @throws InputFileError naming the file of `got` where the two are not the same.
void require_same(const RobotStatement& expected, const RobotStatement& got);

/// "# robot: huang2016\n" for robots of the catalogue, which tables can name; nothing for others.
std::string robot_line(const Robot& robot);

}  // namespace paracal::io
