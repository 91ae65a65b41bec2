#pragma once

#include "paracal/io/file.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/tolerance/allocation.hpp"

namespace paracal::io {

/// Requirements and costs (TOML), as docs/files.md has them. `rest`: tolerances that the file does not choose.
/// @throws InputFileError for syntax, missing, unknown or wrongly typed keys, and values that are implausible or do not
/// apply to the robot.
AllocationProblem read_allocation_problem(const TextFile& file, const Tolerances& rest, const Robot& robot);

}  // namespace paracal::io
