#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/io/file.hpp"

namespace paracal::io {

struct JsonFile;

/// Content of a table of measurements.
enum class TableKind : std::uint8_t { points, distances, lengths, exported };

/// From the header of the table. Points and lengths have their own columns. An instrument export begins with //, or
/// names x, y and z but no commanded poses (x_mm, y_mm, z_mm: only if poses are given). Any other table counts as
/// distances if their poses are given or if it has their column, else as points. A file that is neither then gives a
/// message about the file.
/// @param has_poses  tables of poses are given, which distances need.
TableKind kind_of_table(const TextFile& file, bool has_poses);

/// How to read instrument exports among the tables, see find_columns().
struct ExportStatement {
  std::string columns = {}, unit = {};
  bool by_order = false;

  bool is_silent() const { return columns.empty() && unit.empty() && !by_order; }
};

/// Reads every table by its header, or as an export if `exported` states how to read exports; merges all, see
/// merge().
/// @param poses   one table for all that name poses, or one for each of these in their order.
/// @param joints  joint columns, if present, must be these.
/// @throws InputFileError for a table that cannot be read. InvalidArgument for an export that is not as stated and for
/// missing or too many poses; its message begins with "columns: ", "unit: " or "poses: ".
Measurements read_measurements(const std::vector<TextFile>& tables, const std::vector<TextFile>& poses,
                               const ExportStatement& exported = {}, const JointSpace& joints = {});

/// Names of those tables that the calibration used: they cannot validate it.
/// @param inputs  of the calibration.
/// @param tables  that hold readings; poses may be the same.
std::vector<std::string> used_before(const std::vector<InputFile>& inputs, const Measurements& measurements,
                                     const std::vector<std::string>& tables);

/// @throws InputFileError for a calibration that does not state its input files: readings of its own could confirm it.
void require_inputs(const JsonFile& calibration);

/// Why a validation with such a table is not accepted.
std::string confirms_nothing(const std::string& table);

}  // namespace paracal::io
