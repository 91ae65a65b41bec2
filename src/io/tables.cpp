#include "paracal/io/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>

#include "paracal/error.hpp"
#include "paracal/io/csv.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

constexpr std::array<std::string_view, kMaxLimbs> kJointColumns{"q1_deg", "q2_deg", "q3_deg", "q4_deg"};

std::string row_name(const CsvTable& table, std::size_t row) {
  if (!table.has("pose")) return std::to_string(row + 1);
  const std::string& name = table.text(row, "pose");
  if (name.empty()) table.fail(row, "expected a name in column pose, got none");
  return name;
}

Joints joints_of(const CsvTable& table, std::size_t row, std::size_t limb_count) {
  Joints joints(static_cast<Eigen::Index>(limb_count));
  for (std::size_t i = 0; i < limb_count; ++i) {
    joints(static_cast<Eigen::Index>(i)) = to_radians(table.number(row, kJointColumns[i]));
  }
  return joints;
}

/// How many joint columns a pose table has: none, those of `limb_count`, or where that is 0 at least three, q1 first.
std::size_t joint_columns(const CsvTable& table, std::size_t limb_count) {
  const auto present = static_cast<std::size_t>(
      std::ranges::count_if(kJointColumns, [&](std::string_view column) { return table.has(column); }));
  return present == 0 ? 0 : std::max({present, limb_count, std::size_t{3}});
}

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

std::optional<double> positive_number(const CsvTable& table, std::size_t row, std::string_view column) {
  const std::optional<double> value = table.optional_number(row, column);
  if (value && !(*value > 0.0)) table.fail(row, fmt::format("expected {} above 0, got {}", column, *value));
  return value;
}

std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\n#") == std::string::npos) return field;
  std::string text = "\"";
  for (const char c : field) text.append(c == '"' ? 2 : 1, c);
  return text + '"';
}

}  // namespace

std::vector<Station> read_poses(const TextFile& file, std::size_t limb_count) {
  const CsvTable table(file);
  table.allow_only({"pose",    "x_cmd_mm", "y_cmd_mm",   "z_cmd_mm",   "phi_cmd_deg", "x_mm",       "y_mm",  "z_mm",
                    "phi_deg", "q1_deg",   "q2_deg",     "q3_deg",     "q4_deg",      "repeat",     "x2_mm", "y2_mm",
                    "z2_mm",   "sigma_mm", "tilt_x_rad", "tilt_y_rad", "tilt_z_rad",  "residual_mm"});
  const bool commanded = table.has("x_cmd_mm");
  const auto column = [&](std::string_view plain, std::string_view cmd) { return commanded ? cmd : plain; };
  const std::size_t joint_count = joint_columns(table, limb_count);
  std::map<std::string, int> lines;
  std::vector<Station> stations;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    Station station{row_name(table, row), {}, {}};
    const auto [first, inserted] = lines.try_emplace(station.name, table.line(row));
    if (!inserted) {
      table.fail(row, fmt::format("expected every pose once, got \"{}\" again (first in line {})", station.name,
                                  first->second));
    }
    station.commanded.position = {table.number(row, column("x_mm", "x_cmd_mm")),
                                  table.number(row, column("y_mm", "y_cmd_mm")),
                                  table.number(row, column("z_mm", "z_cmd_mm"))};
    const std::string_view phi = column("phi_deg", "phi_cmd_deg");
    if (table.has(phi)) station.commanded.rotation = to_radians(table.number(row, phi));
    if (joint_count > 0) station.believed = joints_of(table, row, joint_count);
    stations.push_back(std::move(station));
  }
  return stations;
}

std::vector<NamedJoints> read_joints(const TextFile& file, std::size_t limb_count) {
  const CsvTable table(file);
  std::vector<std::string_view> known{"pose"};
  known.insert(known.end(), kJointColumns.begin(), kJointColumns.begin() + static_cast<std::ptrdiff_t>(limb_count));
  table.allow_only(known);
  std::vector<NamedJoints> rows;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    rows.push_back({row_name(table, row), joints_of(table, row, limb_count)});
  }
  return rows;
}

Measurements read_distances(const TextFile& distances, const TextFile& poses, std::size_t limb_count) {
  Measurements measurements;
  measurements.stations = read_poses(poses, limb_count);
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

Measurements read_distances(const std::filesystem::path& distances, const std::filesystem::path& poses,
                            std::size_t limb_count) {
  return read_distances(read_file(distances), read_file(poses), limb_count);
}

std::string joint_table(const std::vector<NamedJoints>& rows) {
  std::string text = "pose";
  const Eigen::Index joints = rows.empty() ? 0 : rows.front().joints.size();
  for (Eigen::Index i = 0; i < joints; ++i) text.append(",").append(kJointColumns[static_cast<std::size_t>(i)]);
  text += '\n';
  for (const NamedJoints& row : rows) {
    text += quoted(row.name);
    for (const double joint : row.joints) fmt::format_to(std::back_inserter(text), ",{}", to_degrees(joint));
    text += '\n';
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
