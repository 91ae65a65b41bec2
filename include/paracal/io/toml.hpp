#pragma once

#include <filesystem>
#include <string>

#include "paracal/io/file.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal::io {

/// Robot file (TOML); keys as in docs/files.md. Unknown keys are refused, so that a misspelt one is not silently
/// ignored.
/// @throws InputFileError for syntax, missing, unknown or wrongly typed keys, and for geometry that Robot refuses.
Robot read_robot(const TextFile& file);

/// The robot as a file that read_robot() accepts.
std::string robot_toml(const Robot& robot);

/// Source errors (TOML): one [[limb]] table a limb, missing keys are zero.
/// @throws InputFileError as above, and when the file has more or fewer limbs than the robot.
SourceErrors read_source_errors(const TextFile& file, std::size_t limb_count);

}  // namespace paracal::io
