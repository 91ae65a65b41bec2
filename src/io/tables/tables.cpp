#include "paracal/io/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <unordered_map>

#include "columns.hpp"
#include "length_rows.hpp"
#include "names.hpp"
#include "paracal/io/csv.hpp"
#include "paracal/units.hpp"
#include "readings.hpp"

namespace paracal::io {
namespace {

/// Position of a name in the pose table.
class StationIndex {
 public:
  explicit StationIndex(const std::vector<Station>& stations) {
    for (std::size_t k = 0; k < stations.size(); ++k) positions_[stations[k].name] = k;
  }

  std::size_t at(const CsvTable& table, std::size_t row, std::string_view column, const std::string& pose_file) const {
    const std::string& name = table.text(row, column);
    const auto found = positions_.find(name);
    if (found == positions_.end()) {
      table.fail(row, fmt::format("expected a pose of {} in column {}, got \"{}\"", pose_file, column, name));
    }
    return found->second;
  }

 private:
  std::map<std::string, std::size_t> positions_;
};

/// Columns of poses in any table that holds some; those with U stand behind targets that compensate prints.
constexpr std::string_view kPoseTable =
    "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg,x_mm,y_mm,z_mm,phi_deg,repeat,x2_mm,y2_mm,z2_mm,sigma_mm,qw,"
    "qx,qy,qz,sigma_deg,tilt_x_rad,tilt_y_rad,tilt_z_rad,residual_mm,tilt_x_deg,tilt_y_deg,tilt_z_deg,U_x_mm,"
    "U_y_mm,U_z_mm,U_phi_deg,U_tilt_x_deg,U_tilt_y_deg,U_tilt_z_deg,tilt_x_cmd_deg,tilt_y_cmd_deg,"
    "tilt_z_cmd_deg";

/// Rows of a pose table, whose header it has checked.
class PoseRows {
 public:
  /// @param names  how many rows' names are kept, to be known again.
  PoseRows(const CsvTable& table, const JointSpace& joints, std::size_t names)
      : columns_(columns_of(table, joints)),
        joints_(joints),
        present_(joint_columns(table, joints)),
        names_(table.has("pose") ? names : 0) {
    table.allow_only(with_joint_columns(split(kPoseTable, ','), joints));
  }

  Station read(const CsvTable& table, std::size_t row) {
    Station station{row_name(table, row), pose_of(table, row, columns_, joints_), {}, table.place(row)};
    require_new(table, row, station.name);
    if (present_.count > 0 && states_joints(table, row, present_)) station.believed = joints_of(table, row, present_);
    return station;
  }

 private:
  static const PoseColumns& columns_of(const CsvTable& table, const JointSpace& joints) {
    if (table.has("x_cmd_mm")) return kCommandedPose;
    const bool printed = on_single_rods(joints.actuator) && table.has("tilt_x_rad");
    return printed ? kPlatePose : kPlainPose;
  }

  /// Rows that have numbers for names cannot share one.
  void require_new(const CsvTable& table, std::size_t row, const std::string& name) {
    if (names_ == 0) return;
    const auto first = lines_.find(name);
    if (first != lines_.end()) {
      table.fail(row,
                 fmt::format("expected every pose once, got \"{}\" again (first in line {})", name, first->second));
    }
    if (lines_.size() < names_) lines_.emplace(name, table.line(row));
  }

  const PoseColumns& columns_;
  JointSpace joints_, present_;
  std::size_t names_;  ///< 0: none
  std::unordered_map<std::string, int> lines_;
};

/// Half of the last digit of each joint, rad or mm.
Joints rounding_of(const CsvTable& table, std::size_t row, const JointSpace& joints) {
  Joints rounding(static_cast<Eigen::Index>(joints.count));
  for (std::size_t i = 0; i < joints.count; ++i) {
    const double digit = half_last_digit(table.text(row, joint_names(joint_unit(joints.actuator))[i]));
    rounding(static_cast<Eigen::Index>(i)) = from_file_unit(joint_unit(joints.actuator), digit);
  }
  return rounding;
}

void allow_joints(const CsvTable& table, const JointSpace& joints) {
  table.allow_only(with_joint_columns({"pose"}, joints));
}

NamedJoints named_joints(const CsvTable& table, std::size_t row, const JointSpace& joints) {
  return {row_name(table, row), joints_of(table, row, joints), table.place(row)};
}

}  // namespace

namespace {

std::vector<Station> stations_of(const CsvTable& table, const JointSpace& joints) {
  PoseRows rows(table, joints, table.row_count());
  std::vector<Station> stations;
  for (std::size_t row = 0; row < table.row_count(); ++row) stations.push_back(rows.read(table, row));
  return stations;
}

/// What readings by name begin with: their poses, and what is to be said of both tables.
Measurements begun(const CsvTable& readings, const TextFile& readings_file, const TextFile& poses_file,
                   const JointSpace& joints) {
  const CsvTable poses(poses_file);
  Measurements measurements;
  measurements.stations = stations_of(poses, joints);
  measurements.notes = readings.notes();
  for (const std::string& note : poses.notes())
    measurements.notes.push_back(fmt::format("{}, {}", title_of(poses_file.name), note));
  measurements.files = {{readings_file.name, sha256(readings_file)}, {poses_file.name, sha256(poses_file)}};
  return measurements;
}

}  // namespace

std::vector<Station> read_poses(const TextFile& file, const JointSpace& joints) {
  return stations_of(CsvTable(file), joints);
}

void read_poses(CsvStream& table, const JointSpace& joints, const std::function<void(const Station&)>& take) {
  std::optional<PoseRows> rows;
  while (const CsvTable* row = table.next()) {
    if (!rows) rows.emplace(*row, joints, kNamesCompared);
    take(rows->read(*row, 0));
  }
}

std::vector<DisplayedJoints> read_displayed_joints(const TextFile& file, const JointSpace& joints) {
  constexpr std::size_t kMayComeAgain = 0;  // as rows of visits do
  const CsvTable table(file);
  PoseRows rows(table, joints, kMayComeAgain);
  std::vector<DisplayedJoints> displayed;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const Station station = rows.read(table, row);
    if (!station.believed) continue;
    displayed.push_back(
        {station.name, station.commanded, *station.believed, rounding_of(table, row, joints), table.line(row)});
  }
  return displayed;
}

std::vector<NamedJoints> read_joints(const TextFile& file, const JointSpace& joints) {
  const CsvTable table(file);
  allow_joints(table, joints);
  std::vector<NamedJoints> rows;
  for (std::size_t row = 0; row < table.row_count(); ++row) rows.push_back(named_joints(table, row, joints));
  return rows;
}

void read_joints(CsvStream& table, const JointSpace& joints, const std::function<void(const NamedJoints&)>& take) {
  while (const CsvTable* row = table.next()) {
    if (row->number_of(0) == 1) allow_joints(*row, joints);
    take(named_joints(*row, 0, joints));
  }
}

Measurements read_distances(const TextFile& distances, const TextFile& poses, const JointSpace& joints) {
  const CsvTable table(distances);
  Measurements measurements = begun(table, distances, poses, joints);
  const StationIndex stations(measurements.stations);
  table.allow_only({"from", "to", "distance_mm", "rotation_deg", "sigma_mm"});
  std::map<std::pair<std::size_t, std::size_t>, int> lines;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    DistanceReading reading;
    reading.from = stations.at(table, row, "from", poses.name);
    reading.to = stations.at(table, row, "to", poses.name);
    if (reading.from == reading.to) table.fail(row, "expected two different poses, got the same pose twice");
    const auto [first, inserted] = lines.try_emplace(std::minmax(reading.from, reading.to), table.line(row));
    if (!inserted) {
      table.fail(row, fmt::format("expected every pair of poses once, got that of line {} again", first->second));
    }
    reading.distance = table.number(row, "distance_mm", plausible::positive_length(joints.reach));
    reading.distance_sigma = table.optional_number(row, "sigma_mm", plausible::kNoise);
    if (const auto rotation = table.optional_number(row, "rotation_deg", plausible::kAngle)) {
      reading.rotation = to_radians(*rotation);
    }
    measurements.distances.push_back(reading);
  }
  return measurements;
}

std::optional<LengthKind> length_kind_in(std::string_view header) {
  for (const LengthWords& kind : length_kinds()) {
    if (header.find(kind.column) != std::string_view::npos) return kind.kind;
  }
  return std::nullopt;
}

Measurements read_lengths(const TextFile& lengths, const TextFile& poses, const JointSpace& joints) {
  const CsvTable table(lengths);
  Measurements measurements = begun(table, lengths, poses, joints);
  const StationIndex stations(measurements.stations);
  LengthRows rows(table, title_of(lengths.name), joints.reach);
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    rows.add(row, stations.at(table, row, "pose", poses.name));
  }
  measurements.lengths = std::move(rows).take();
  return measurements;
}

Measurements read_distances(const std::filesystem::path& distances, const std::filesystem::path& poses,
                            const JointSpace& joints) {
  return read_distances(read_file(distances), read_file(poses), joints);
}

std::string joint_table_header(const JointSpace& joints) {
  std::string text = "pose";
  for (std::size_t i = 0; i < joints.count; ++i) text.append(",").append(joint_names(joint_unit(joints.actuator))[i]);
  return text + '\n';
}

std::string joint_table_row(const NamedJoints& row, Actuator actuator) {
  std::string text = quoted(row.name);
  for (const double joint : row.joints) {
    fmt::format_to(std::back_inserter(text), ",{}", to_file_unit(joint_unit(actuator), joint));
  }
  return text + '\n';
}

std::string pose_table_header(bool tilts) {
  return fmt::format("pose,x_mm,y_mm,z_mm,phi_deg{}\n", tilts ? ",tilt_x_deg,tilt_y_deg,tilt_z_deg" : "");
}

std::string pose_table_row(const NamedPose& row, bool tilts) {
  const auto& [r, rotation, tilt] = row.pose;
  std::string text = fmt::format("{},{},{},{},{}", quoted(row.name), r.x(), r.y(), r.z(), to_degrees(rotation));
  for (const double angle : tilt) {
    if (tilts) fmt::format_to(std::back_inserter(text), ",{}", to_degrees(angle));
  }
  return text + '\n';
}

std::string_view plate_table_header() {
  return "pose,x_mm,y_mm,z_mm,phi_deg,tilt_x_rad,tilt_y_rad,tilt_z_rad,residual_mm\n";
}

std::string plate_table_row(const NamedPlate& row) {
  const PlateState& plate = row.result.plate;
  return fmt::format("{},{},{},{},{},{},{},{},{}\n", quoted(row.name), plate.position.x(), plate.position.y(),
                     plate.position.z(), to_degrees(row.rotation), plate.tilt.x(), plate.tilt.y(), plate.tilt.z(),
                     row.result.residual);
}

}  // namespace paracal::io
