#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "paracal/io/file.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal::io {

/// Robot file (TOML); keys as in docs/files.md. Unknown keys are refused, so a misspelt one is not silently
/// ignored.
/// @throws InputFileError for syntax, missing, unknown or wrongly typed keys, and for geometry that Robot refuses.
Robot read_robot(const TextFile& file);

/// Commented robot files to start from, by kind: "hexapod".
std::vector<std::string> robot_templates();
/// @throws InvalidArgument for an unknown kind.
TextFile robot_template(std::string_view kind);

/// The robot as a file that read_robot() accepts.
std::string robot_toml(const Robot& robot);

/// Source errors (TOML): one [[limb]] table per limb, missing keys are zero.
/// @throws InputFileError as above, and when the file has more or fewer limbs than the robot.
SourceErrors read_source_errors(const TextFile& file, const JointSpace& joints);

/// The errors as a file that read_source_errors() accepts; numbers are read back within rounding.
std::string source_errors_toml(const SourceErrors& errors, const JointSpace& joints);

/// Tolerances (TOML): half-widths or drawing statements (half_width_of), at top level or in a [tolerances] table. With
/// that table other tables, such as those of a robot file, are ignored. A table that lists only some tolerances states
/// the others by `others = "exact"` or `"generous"` (default tolerances).
/// @param robot  nominal: default tolerances and the sizes on its drawings depend on it.
/// @throws InputFileError as above, for a negative half-width, for an invalid drawing statement, and if `others`
///         is needed and missing.
Tolerances read_tolerances(const TextFile& file, const Robot& robot);

/// The tolerances as a file that read_tolerances() accepts.
std::string tolerances_toml(const Tolerances& tolerances, const Limbs& limbs);
/// The same with the drawing statements as comments.
std::string tolerances_toml(const Tolerances& tolerances, const Robot& robot);

}  // namespace paracal::io
