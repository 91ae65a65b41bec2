#pragma once

#include <string>
#include <vector>

#include "paracal/io/file.hpp"

namespace paracal::app {

/// A file's text, which input_file() will take: what comes through a pipe cannot be read twice.
const io::TextFile& look_into(const std::string& name);

/// A file's text, read now unless somebody has looked into it.
io::TextFile input_file(const std::string& name);

/// Input files that may say which robot they are of; empty names are passed over.
struct RobotSources {
  std::vector<std::string> calibrations = {};  ///< JSON, which carries its robot
  std::vector<std::string> tables = {};        ///< with a line "# robot: NAME", or without
};

/// Whether --errors names a calibration (.json) rather than source errors (TOML), which do not say of which robot.
bool is_calibration(const std::string& errors_file);

/// What --errors names, if it is a calibration, and tables.
RobotSources sources_of(const std::string& errors_file, std::vector<std::string> tables);

}  // namespace paracal::app
