#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "paracal/calibration/controller_joints.hpp"
#include "paracal/calibration/measurement.hpp"
#include "paracal/io/csv_stream.hpp"
#include "paracal/io/file.hpp"
#include "paracal/kinematics/forward.hpp"

namespace paracal::io {

/// Joint coordinates of one pose, rad or mm, with the name of its row.
struct NamedJoints {
  std::string name;
  Joints joints;
  std::string stated_in = {};  ///< as of a Station
};

/// Pose table (CSV): x_mm,y_mm,z_mm,phi_deg or x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg, optional tilt_x_deg, tilt_y_deg,
/// tilt_z_deg or tilt_x_cmd_deg, ..., pose (name) and q1_deg... or q1_mm... (commanded joints). Plates with six degrees
/// of freedom may have tilt_x_rad, ..., as printed by forward kinematics. If both kinds are present, as in a
/// measurement file, the commanded ones count. A missing phi is 0, a missing name is the number of the row. Other
/// columns of measurement and pose tables are ignored.
/// @param joints  joint columns, if present, must be these.
/// @throws InputFileError for anything else, or a repeated name.
std::vector<Station> read_poses(const TextFile& file, const JointSpace& joints = {});

/// Rows of a pose or point table with the joints that a controller displays at the commanded poses, and the rounding of
/// these numbers as written. Rows without joints are ignored.
/// @throws InputFileError as read_poses(); a name may be repeated.
std::vector<DisplayedJoints> read_displayed_joints(const TextFile& file, const JointSpace& joints);

/// Joint table (CSV): q1_deg, q2_deg, ... (of rails q1_mm, ...) for every limb, optional pose.
std::vector<NamedJoints> read_joints(const TextFile& file, const JointSpace& joints);

/// The same tables row by row, with constant memory: a repeated name is detected if it is in one of
/// the first kNamesCompared rows.
inline constexpr std::size_t kNamesCompared = 100'000;
void read_poses(CsvStream& table, const JointSpace& joints, const std::function<void(const Station&)>& take);
void read_joints(CsvStream& table, const JointSpace& joints, const std::function<void(const NamedJoints&)>& take);

/// Distance table (CSV): from,to,distance_mm and optional rotation_deg, sigma_mm; names are those of the pose table.
Measurements read_distances(const TextFile& distances, const TextFile& poses, const JointSpace& joints = {});
Measurements read_distances(const std::filesystem::path& distances, const std::filesystem::path& poses,
                            const JointSpace& joints = {});

/// Table of lengths of one kind (CSV): pose, the kind's column (height_mm) and optional sigma_mm; names are those of
/// the pose table, repeats are further rows. One file is one setup, named after the file. Rows may state several setups
/// (in LengthWords::at_columns: optional for a ball bar, required for a dial).
Measurements read_lengths(const TextFile& lengths, const TextFile& poses, const JointSpace& joints = {});

/// The kind of length in a header; empty if there is none.
std::optional<LengthKind> length_kind_in(std::string_view header);

/// A pose with the name of its row.
struct NamedPose {
  std::string name;
  Pose pose;
};

/// Exact pose of one row of a joint table.
struct NamedPlate {
  std::string name;
  ForwardResult result;
  double rotation = 0.0;  ///< phi, rad
};

/// Lines of tables for the readers above, with line ends: the header, and a row. The table of plates also has
/// tilt_x_rad, tilt_y_rad, tilt_z_rad, residual_mm.
std::string joint_table_header(const JointSpace& joints);
std::string joint_table_row(const NamedJoints& row, Actuator actuator = Actuator::revolute);
/// @param tilts  for plates with six degrees of freedom.
std::string pose_table_header(bool tilts = false);
std::string pose_table_row(const NamedPose& row, bool tilts = false);
std::string_view plate_table_header();
std::string plate_table_row(const NamedPlate& row);

}  // namespace paracal::io
