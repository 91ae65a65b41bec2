#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/calibration/measurement.hpp"
#include "paracal/io/file.hpp"

namespace paracal::io {

/// What a table of measurements holds.
enum class TableKind : std::uint8_t { points, distances, lengths, exported };

/// By the header of the table. Points and lengths say so. A file whose first line begins with //, or that names x, y
/// and z but no commanded poses, is the export of an instrument (x_mm, y_mm, z_mm: where poses are given). Any other
/// table is taken for distances where their poses are given or it says that it holds some, else for points: so a file
/// that is neither is complained of as a file.
/// @param has_poses  tables of poses are given, which distances need.
TableKind kind_of_table(const TextFile& file, bool has_poses);

/// How the exports of instruments among tables are to be read, as find_columns() takes it.
struct ExportStatement {
  std::string columns = {}, unit = {};
  bool by_order = false;

  bool is_silent() const { return columns.empty() && unit.empty() && !by_order; }
};

/// Every table by what its header says it is, or as an export where somebody states how these are to be read; all in
/// one, see merge().
/// @param poses   one table for all that name poses, or one for each of these in their order.
/// @param joints  where joint columns stand, they must be these.
/// @throws InputFileError for a table that cannot be read, InvalidArgument for an export that is not as stated and for
/// poses that are missing or too many; its message begins with what it is of: "columns: ", "unit: " or "poses: ".
Measurements read_measurements(const std::vector<TextFile>& tables, const std::vector<TextFile>& poses,
                               const ExportStatement& exported = {}, const JointSpace& joints = {});

/// Those of these tables, by name, that a calibration was made from: they confirm nothing.
/// @param inputs  of the calibration.
/// @param tables  that hold readings; poses may be the same.
std::vector<std::string> used_before(const std::vector<InputFile>& inputs, const Measurements& measurements,
                                     const std::vector<std::string>& tables);

/// Why a validation by such a table is not accepted.
std::string confirms_nothing(const std::string& table);

}  // namespace paracal::io
