#pragma once

#include "paracal/io/file.hpp"
#include "paracal/mechanism/robot.hpp"
#include "paracal/tolerance/allocation.hpp"

namespace paracal::io {

/// Requirements and costs (TOML), as docs/files.md has them. `rest` is what the file does not choose.
/// @throws InputFileError for syntax, missing, unknown or wrongly typed keys, and values that make no sense,
/// or are not to be asked of the robot.
AllocationProblem read_allocation_problem(const TextFile& file, const Tolerances& rest, const Robot& robot);

}  // namespace paracal::io
