#include "paracal/io/measurement_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "columns.hpp"
#include "paracal/error.hpp"
#include "paracal/io/points.hpp"
#include "paracal/io/tables.hpp"
#include "readings.hpp"

namespace paracal::io {
namespace {

/// The first line that is neither empty nor a comment.
std::string_view header_of(std::string_view text) {
  for (const std::string_view line : lines_of(text)) {
    if (!line.starts_with('#') && !trimmed(line).empty()) return line;
  }
  return {};
}

/// Whether a header has a column of points or distances that no export has.
bool is_ours(std::string_view header) {
  constexpr std::array<std::string_view, 7> kOurs{"_cmd_mm", "q1_",  "x2_mm",      "repeat",
                                                  "phi_deg", "from", "distance_mm"};
  return std::ranges::any_of(kOurs,
                             [&](std::string_view column) { return header.find(column) != std::string_view::npos; });
}

/// The tables of poses, as others ask for them one after the other.
class PoseTables {
 public:
  explicit PoseTables(const std::vector<TextFile>& tables) : tables_(tables) {}

  bool empty() const { return tables_.empty(); }
  const TextFile& next(const std::string& asking) {
    if (tables_.empty()) throw InvalidArgument(fmt::format("poses: expected a table for {}, got none", asking));
    const std::size_t place = tables_.size() == 1 ? 0 : asked_;
    ++asked_;
    if (place < tables_.size()) return tables_[place];
    throw InvalidArgument(fmt::format(
        "poses: expected one table for all measurements that name poses, or one for each, got {} and none for {}",
        tables_.size(), asking));
  }
  void check_all_used() const {
    if (tables_.size() < 2 || asked_ == tables_.size()) return;
    throw InvalidArgument(fmt::format(
        "poses: expected one table for each of {} measurement tables that name poses, got {}", asked_, tables_.size()));
  }

 private:
  const std::vector<TextFile>& tables_;
  std::size_t asked_ = 0;
};

Measurements read_table(const TextFile& table, PoseTables& tables, const ExportStatement& exported,
                        const JointSpace& joints) {
  const auto poses = [&]() -> const TextFile& { return tables.next(table.name); };
  switch (exported.is_silent() ? kind_of_table(table, !tables.empty()) : TableKind::exported) {
    case TableKind::lengths:
      return read_lengths(table, poses(), joints);
    case TableKind::distances:
      return read_distances(table, poses(), joints);
    case TableKind::exported: {
      const std::vector<Station> commanded = read_poses(poses(), joints);  // where both are refused, always this
      return read_tracker_export(table, find_columns(table, exported.columns, exported.unit, exported.by_order),
                                 commanded, joints);
    }
    case TableKind::points:
      break;
  }
  return read_points(table, joints);
}

}  // namespace

Measurements read_measurements(const std::vector<TextFile>& tables, const std::vector<TextFile>& poses,
                               const ExportStatement& exported, const JointSpace& joints) {
  PoseTables pose_tables(poses);
  std::vector<Measurements> parts;
  parts.reserve(tables.size());
  for (const TextFile& table : tables) parts.push_back(read_table(table, pose_tables, exported, joints));
  pose_tables.check_all_used();
  return parts.size() == 1 ? std::move(parts.front()) : merge(std::move(parts));
}

TableKind kind_of_table(const TextFile& file, bool has_poses) {
  const std::string_view header = header_of(file.text);
  const auto has = [&](std::string_view column) { return header.find(column) != std::string_view::npos; };
  if (length_kind_in(header)) return TableKind::lengths;
  if (header.starts_with("//")) return TableKind::exported;
  if ((has_poses || !has("x_mm")) && !is_ours(header) && has_export_header(file)) return TableKind::exported;
  if (has("x_mm")) return TableKind::points;
  if (has_poses) return is_ours(header) ? TableKind::distances : TableKind::exported;  // which says what it expects
  return has("distance_mm") ? TableKind::distances : TableKind::points;
}

std::vector<std::string> used_before(const std::vector<InputFile>& inputs, const Measurements& measurements,
                                     const std::vector<std::string>& tables) {
  std::vector<std::string> used;
  for (const InputFile& file : measurements.files) {
    const bool is_known = std::ranges::find(inputs, file.sha256, &InputFile::sha256) != inputs.end();
    if (is_known && std::ranges::find(tables, file.name) != tables.end()) used.push_back(file.name);
  }
  return used;
}

std::string confirms_nothing(const std::string& table) {
  return title_of(table) + " was used for the calibration, so it cannot confirm it: use other measurements";
}

}  // namespace paracal::io
