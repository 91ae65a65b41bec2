#pragma once

// Private to io: what the readers and writers of tables share.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/io/csv.hpp"
#include "paracal/mechanism/pose.hpp"

namespace paracal::io {

inline constexpr std::array<std::string_view, kMaxLimbs> kJointColumns{"q1_deg", "q2_deg", "q3_deg", "q4_deg"};

/// `columns` and the joint columns of that many limbs; 0: of any robot.
std::vector<std::string_view> with_joint_columns(std::vector<std::string_view> columns, std::size_t limb_count);

/// How many joint columns a pose table has: none, those of `limb_count`, or where that is 0 at least three, q1 first.
std::size_t joint_columns(const CsvTable& table, std::size_t limb_count);

Joints joints_of(const CsvTable& table, std::size_t row, std::size_t limb_count);

/// Where a table states a pose.
struct PoseColumns {
  std::string_view x, y, z, phi;
};
inline constexpr PoseColumns kPlainPose{"x_mm", "y_mm", "z_mm", "phi_deg"};
inline constexpr PoseColumns kCommandedPose{"x_cmd_mm", "y_cmd_mm", "z_cmd_mm", "phi_cmd_deg"};

/// A missing column phi is 0.
Pose pose_of(const CsvTable& table, std::size_t row, const PoseColumns& columns);

/// The name in column pose.
std::string pose_name(const CsvTable& table, std::size_t row);

/// The same, or the row's number where the table has no such column.
std::string row_name(const CsvTable& table, std::size_t row);

std::optional<double> positive_number(const CsvTable& table, std::size_t row, std::string_view column);

/// A field as it must stand in a table to be read back: in quotation marks where it would be cut, trimmed or taken for
/// a comment.
std::string quoted(const std::string& field);

/// The text cut into lines, without line ends and a leading byte-order mark.
std::vector<std::string_view> lines_of(std::string_view text);

/// Empty where the text is anything but one finite number.
std::optional<double> finite_number(std::string_view text);

bool is_utf8(std::string_view text);

}  // namespace paracal::io
