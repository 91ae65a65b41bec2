#include "columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "paracal/units.hpp"

namespace paracal::io {

std::vector<std::string_view> with_joint_columns(std::vector<std::string_view> columns, std::size_t limb_count) {
  const std::size_t count = limb_count == 0 ? kJointColumns.size() : std::min(limb_count, kJointColumns.size());
  columns.insert(columns.end(), kJointColumns.begin(), kJointColumns.begin() + static_cast<std::ptrdiff_t>(count));
  return columns;
}

std::size_t joint_columns(const CsvTable& table, std::size_t limb_count) {
  const auto present = static_cast<std::size_t>(
      std::ranges::count_if(kJointColumns, [&](std::string_view column) { return table.has(column); }));
  return present == 0 ? 0 : std::max({present, limb_count, std::size_t{3}});
}

Joints joints_of(const CsvTable& table, std::size_t row, std::size_t limb_count) {
  Joints joints(static_cast<Eigen::Index>(limb_count));
  for (std::size_t i = 0; i < limb_count; ++i) {
    joints(static_cast<Eigen::Index>(i)) = to_radians(table.number(row, kJointColumns[i]));
  }
  return joints;
}

Pose pose_of(const CsvTable& table, std::size_t row, const PoseColumns& columns) {
  Pose pose{{table.number(row, columns.x), table.number(row, columns.y), table.number(row, columns.z)}};
  if (table.has(columns.phi)) pose.rotation = to_radians(table.number(row, columns.phi));
  return pose;
}

std::string pose_name(const CsvTable& table, std::size_t row) {
  const std::string& name = table.text(row, "pose");
  if (name.empty()) table.fail(row, "expected a name in column pose, got none");
  return name;
}

std::string row_name(const CsvTable& table, std::size_t row) {
  return table.has("pose") ? pose_name(table, row) : std::to_string(row + 1);
}

std::optional<double> positive_number(const CsvTable& table, std::size_t row, std::string_view column) {
  const std::optional<double> value = table.optional_number(row, column);
  if (value && !(*value > 0.0)) table.fail(row, fmt::format("expected {} above 0, got {}", column, *value));
  return value;
}

std::string quoted(const std::string& field) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  const bool has_blank_ends = !field.empty() && (is_blank(field.front()) || is_blank(field.back()));
  if (field.find_first_of(",\"\r\n#") == std::string::npos && !has_blank_ends) return field;
  std::string text = "\"";
  for (const char c : field) text.append(c == '"' ? 2 : 1, c);
  return text + '"';
}

std::vector<std::string_view> lines_of(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::optional<double> finite_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Names go into JSON later, which takes nothing but UTF-8; its writer is also the one who can tell.
bool is_utf8(std::string_view text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

}  // namespace paracal::io
