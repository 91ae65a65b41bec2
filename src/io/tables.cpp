#include "paracal/io/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "columns.hpp"
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

}  // namespace

std::vector<Station> read_poses(const TextFile& file, const JointSpace& joints) {
  const CsvTable table(file);
  table.allow_only(with_joint_columns(
      {"pose", "x_cmd_mm", "y_cmd_mm", "z_cmd_mm", "phi_cmd_deg", "x_mm", "y_mm", "z_mm", "phi_deg", "repeat", "x2_mm",
       "y2_mm", "z2_mm", "sigma_mm", "tilt_x_rad", "tilt_y_rad", "tilt_z_rad", "residual_mm"},
      joints));
  const PoseColumns& columns = table.has("x_cmd_mm") ? kCommandedPose : kPlainPose;
  const JointSpace present = joint_columns(table, joints);
  std::map<std::string, int> lines;
  std::vector<Station> stations;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    Station station{row_name(table, row), pose_of(table, row, columns)};
    const auto [first, inserted] = lines.try_emplace(station.name, table.line(row));
    if (!inserted) {
      table.fail(row, fmt::format("expected every pose once, got \"{}\" again (first in line {})", station.name,
                                  first->second));
    }
    if (present.count > 0) station.believed = joints_of(table, row, present);
    stations.push_back(std::move(station));
  }
  return stations;
}

std::vector<NamedJoints> read_joints(const TextFile& file, const JointSpace& joints) {
  const CsvTable table(file);
  table.allow_only(with_joint_columns({"pose"}, joints));
  std::vector<NamedJoints> rows;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    rows.push_back({row_name(table, row), joints_of(table, row, joints)});
  }
  return rows;
}

Measurements read_distances(const TextFile& distances, const TextFile& poses, const JointSpace& joints) {
  Measurements measurements;
  measurements.stations = read_poses(poses, joints);
  const StationIndex stations(measurements.stations);
  const CsvTable table(distances);
  table.allow_only({"from", "to", "distance_mm", "rotation_deg", "sigma_mm"});
  std::map<std::pair<std::size_t, std::size_t>, int> lines;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    DistanceReading reading;
    reading.from = stations.at(table, row, "from", poses.name);
    reading.to = stations.at(table, row, "to", poses.name);
    if (reading.from == reading.to) table.fail(row, "expected two different poses, got one");
    const auto [first, inserted] = lines.try_emplace(std::minmax(reading.from, reading.to), table.line(row));
    if (!inserted) {
      table.fail(row, fmt::format("expected every pair of poses once, got line {}'s again", first->second));
    }
    reading.distance = table.number(row, "distance_mm");
    if (!(reading.distance > 0.0)) {
      table.fail(row, fmt::format("expected distance_mm above 0, got {}", reading.distance));
    }
    reading.distance_sigma = positive_number(table, row, "sigma_mm");
    if (const auto rotation = table.optional_number(row, "rotation_deg")) reading.rotation = to_radians(*rotation);
    measurements.distances.push_back(reading);
  }
  measurements.files = {{distances.name, sha256(distances.text)}, {poses.name, sha256(poses.text)}};
  return measurements;
}

Measurements read_heights(const TextFile& heights, const TextFile& poses, const JointSpace& joints) {
  Measurements measurements;
  measurements.stations = read_poses(poses, joints);
  const StationIndex stations(measurements.stations);
  const CsvTable table(heights);
  table.allow_only({"pose", "height_mm", "sigma_mm"});
  HeightSeries plane{title_of(heights.name), {}};
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    plane.readings.push_back({.station = stations.at(table, row, "pose", poses.name),
                              .height = table.number(row, "height_mm"),
                              .sigma = positive_number(table, row, "sigma_mm")});
  }
  measurements.planes.push_back(std::move(plane));
  measurements.files = {{heights.name, sha256(heights.text)}, {poses.name, sha256(poses.text)}};
  return measurements;
}

Measurements read_distances(const std::filesystem::path& distances, const std::filesystem::path& poses,
                            const JointSpace& joints) {
  return read_distances(read_file(distances), read_file(poses), joints);
}

std::string joint_table(const std::vector<NamedJoints>& rows, Actuator actuator) {
  std::string text = "pose";
  const Eigen::Index count = rows.empty() ? 0 : rows.front().joints.size();
  for (Eigen::Index i = 0; i < count; ++i) text.append(",").append(joint_names(actuator)[static_cast<std::size_t>(i)]);
  text += '\n';
  for (const NamedJoints& row : rows) {
    text += quoted(row.name);
    for (const double joint : row.joints) {
      fmt::format_to(std::back_inserter(text), ",{}", to_file_unit(joint_unit(actuator), joint));
    }
    text += '\n';
  }
  return text;
}

std::string pose_table(const std::vector<NamedPose>& rows) {
  std::string text = "pose,x_mm,y_mm,z_mm,phi_deg\n";
  for (const NamedPose& row : rows) {
    const Eigen::Vector3d& r = row.pose.position;
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", quoted(row.name), r.x(), r.y(), r.z(),
                   to_degrees(row.pose.rotation));
  }
  return text;
}

std::string plate_table(const std::vector<NamedPlate>& rows) {
  std::string text = "pose,x_mm,y_mm,z_mm,phi_deg,tilt_x_rad,tilt_y_rad,tilt_z_rad,residual_mm\n";
  for (const NamedPlate& row : rows) {
    const PlateState& plate = row.result.plate;
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{}\n", quoted(row.name), plate.position.x(),
                   plate.position.y(), plate.position.z(), to_degrees(row.rotation), plate.tilt.x(), plate.tilt.y(),
                   plate.tilt.z(), row.result.residual);
  }
  return text;
}

}  // namespace paracal::io
