#pragma once

// Private to io: what the readers and writers of tables share.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/io/csv.hpp"
#include "paracal/mechanism/source_errors.hpp"

namespace paracal::io {

/// "q1_deg", ... or "q1_mm", ...
const std::array<std::string_view, kMaxLimbs>& joint_names(Unit unit);

/// `columns` and the joint columns of these joints; of any robot where they are none.
std::vector<std::string_view> with_joint_columns(std::vector<std::string_view> columns, const JointSpace& joints);

/// Which joint columns a pose table has: none, those of `joints`, or where these are any robot's at least three, q1
/// first.
JointSpace joint_columns(const CsvTable& table, const JointSpace& joints);

Joints joints_of(const CsvTable& table, std::size_t row, const JointSpace& joints);

/// Whether a row states joints: some of its fields in these columns are not blank.
bool states_joints(const CsvTable& table, std::size_t row, const JointSpace& joints);

/// Half of the last digit of a number as it is written: 0.005 of "12.34", 5 of "1.2e2".
double half_last_digit(std::string_view number);

/// Where a table states a pose.
struct PoseColumns {
  std::string_view x, y, z, phi;
  std::array<std::string_view, 3> tilt = {};
  bool tilt_in_rad = false;
};
inline constexpr PoseColumns kPlainPose{"x_mm", "y_mm", "z_mm", "phi_deg", {"tilt_x_deg", "tilt_y_deg", "tilt_z_deg"}};
/// What `forward` prints: the pose of a plate with six freedoms, else with a tilt that nobody commands.
inline constexpr PoseColumns kPlatePose{"x_mm", "y_mm", "z_mm", "phi_deg", {"tilt_x_rad", "tilt_y_rad", "tilt_z_rad"},
                                        true};
inline constexpr PoseColumns kCommandedPose{
    "x_cmd_mm", "y_cmd_mm", "z_cmd_mm", "phi_cmd_deg", {"tilt_x_cmd_deg", "tilt_y_cmd_deg", "tilt_z_cmd_deg"}};

/// Missing columns of phi and tilt are 0, that of z is where guides hold it.
Pose pose_of(const CsvTable& table, std::size_t row, const PoseColumns& columns, const JointSpace& joints);

/// The name in column pose.
std::string pose_name(const CsvTable& table, std::size_t row);

/// The same, or the row's number where the table has no such column.
std::string row_name(const CsvTable& table, std::size_t row);

/// A name as it must stand in a table to be read back: in quotation marks where it would be cut, trimmed or taken for
/// a comment, and with an apostrophe where a spreadsheet would take it for a formula.
std::string quoted(const std::string& name);

std::string_view without_byte_order_mark(std::string_view text);

/// A line without the characters that end it.
std::string_view without_end(std::string_view line);

/// Without what stands before and behind.
std::string_view trimmed(std::string_view text, std::string_view blanks = " \t\r");

/// The text between separators; never empty.
std::vector<std::string_view> split(std::string_view text, char separator);
/// The same, without blanks around.
std::vector<std::string_view> cut(std::string_view text, char separator);

/// The text cut into lines, without line ends and a leading byte-order mark.
std::vector<std::string_view> lines_of(std::string_view text);

/// Empty where the text is anything but one finite number.
std::optional<double> finite_number(std::string_view text);

}  // namespace paracal::io
