#include "paracal/io/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <unordered_map>

#include "columns.hpp"
#include "names.hpp"
#include "paracal/error.hpp"
#include "paracal/io/csv.hpp"
#include "paracal/units.hpp"
#include "readings.hpp"

namespace paracal::io {
namespace {

using PointColumns = std::array<std::string_view, 3>;
constexpr PointColumns kPoint{"x_mm", "y_mm", "z_mm"}, kSecondPoint{"x2_mm", "y2_mm", "z2_mm"};

std::string text_of(const Pose& pose) {
  return fmt::format("({}, {}, {}) mm and {} deg", pose.position.x(), pose.position.y(), pose.position.z(),
                     tidy_degrees(pose.rotation));
}

std::string text_of(const Joints& joints, Actuator actuator) {
  const Unit unit = joint_unit(actuator);
  std::string text;
  for (const double joint : joints) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", tidy(to_file_unit(unit, joint)));
  }
  return fmt::format("({}) {}", text, file_unit(unit));
}

/// Stations in the order of their first rows.
class StationList {
 public:
  explicit StationList(Actuator actuator) : actuator_(actuator) {}

  /// @throws InputFileError when an earlier row of the same name states another pose or other joints.
  std::size_t index_of(const CsvTable& table, std::size_t row, const Station& station) {
    const auto [place, is_new] = places_.try_emplace(station.name, stations_.size(), table.line(row));
    const auto [index, line] = place->second;
    if (is_new) {
      stations_.push_back(station);
    } else {
      refuse_change(table, row, station, stations_[index], line);
    }
    return index;
  }

  std::vector<Station> take() && { return std::move(stations_); }

 private:
  void refuse_change(const CsvTable& table, std::size_t row, const Station& station, const Station& first,
                     int line) const {
    const auto refuse = [&](const std::string& expected, const std::string& got) {
      table.fail(row, fmt::format("expected pose {} at {} as in line {}, got {}", station.name, expected, line, got));
    };
    if (!is_same(station.commanded, first.commanded)) refuse(text_of(first.commanded), text_of(station.commanded));
    if (is_same(station.believed, first.believed)) return;
    refuse(text_of(*first.believed, actuator_), text_of(*station.believed, actuator_));
  }

  Actuator actuator_;
  std::vector<Station> stations_;
  std::unordered_map<std::string, std::pair<std::size_t, int>> places_;  ///< index, line
};

Station station_of(const CsvTable& table, std::size_t row, const JointSpace& joints) {
  Station station{pose_name(table, row), pose_of(table, row, kCommandedPose)};
  if (joints.count > 0) station.believed = joints_of(table, row, joints);
  return station;
}

/// Empty where all three coordinates are blank.
std::optional<Eigen::Vector3d> point_of(const CsvTable& table, std::size_t row, const PointColumns& columns) {
  const auto blank =
      std::ranges::count_if(columns, [&](std::string_view column) { return table.text(row, column).empty(); });
  if (blank == 3) return std::nullopt;
  if (blank > 0) {
    table.fail(row, fmt::format("expected {}, {}, {} either all filled in or all blank, got {} blank", columns[0],
                                columns[1], columns[2], blank));
  }
  return Eigen::Vector3d(table.number(row, columns[0]), table.number(row, columns[1]), table.number(row, columns[2]));
}

/// The number of a repeat is a label for people, but one that is no count shows that columns are mixed up.
void check_repeat(const CsvTable& table, std::size_t row) {
  const std::optional<double> repeat = table.optional_number(row, "repeat");
  if (repeat && (*repeat < 1.0 || *repeat != std::floor(*repeat))) {
    table.fail(row, fmt::format("expected a whole number from 1 in column repeat, got {}", *repeat));
  }
}

/// What was read besides the point.
PointReading reading_without_point(const CsvTable& table, std::size_t row, std::size_t station) {
  check_repeat(table, row);
  PointReading reading{.station = station};
  const bool has_second = std::ranges::any_of(kSecondPoint, [&](std::string_view column) { return table.has(column); });
  if (has_second) reading.second = point_of(table, row, kSecondPoint);
  if (const auto phi = table.optional_number(row, "phi_deg")) reading.rotation = to_radians(*phi);
  reading.sigma = positive_number(table, row, "sigma_mm");
  return reading;
}

void add_row(SeriesBuilder& series, const CsvTable& table, std::size_t row, const std::string& pose,
             std::size_t station) {
  PointReading reading = reading_without_point(table, row, station);
  if (const std::optional<Eigen::Vector3d> point = point_of(table, row, kPoint)) {
    reading.point = *point;
    series.add(table.line(row), pose, reading);
    return;
  }
  const bool has_more = reading.second || reading.rotation;
  series.note(table.line(row),
              fmt::format("pose {} has no point{}", pose, has_more ? "; its other readings are passed over" : ""));
}

/// Degrees that are read back as exactly this angle wherever such degrees exist, as they do for every angle that came
/// from a file; the shortest of them that was tried.
double degrees_of(double radians) {
  const double degrees = to_degrees(radians);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double candidate :
       {tidy(degrees), degrees, std::nextafter(degrees, -infinity), std::nextafter(degrees, infinity)}) {
    if (to_radians(candidate) == radians) return candidate;
  }
  return degrees;
}

std::optional<double> in_degrees(const std::optional<double>& radians) {
  if (!radians) return std::nullopt;
  return degrees_of(*radians);
}

/// The optional columns that some reading of a series needs.
struct OptionalColumns {
  bool repeat = false, rotation = false, second = false, sigma = false;
  JointSpace joints = {};
};

OptionalColumns columns_for(const std::vector<PointReading>& readings, const JointSpace& joints) {
  OptionalColumns columns{.joints = joints};
  std::set<std::size_t> read;
  for (const PointReading& reading : readings) {
    columns.repeat |= !read.insert(reading.station).second;
    columns.rotation |= reading.rotation.has_value();
    columns.second |= reading.second.has_value();
    columns.sigma |= reading.sigma.has_value();
  }
  return columns;
}

std::string header_of(const OptionalColumns& columns) {
  std::string header = "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg,x_mm,y_mm,z_mm";
  if (columns.repeat) header += ",repeat";
  if (columns.rotation) header += ",phi_deg";
  if (columns.second) header += ",x2_mm,y2_mm,z2_mm";
  if (columns.sigma) header += ",sigma_mm";
  for (std::size_t i = 0; i < columns.joints.count; ++i) {
    header.append(",").append(joint_names(columns.joints.actuator)[i]);
  }
  return header + '\n';
}

/// The fields of a row, each after a comma.
class RowWriter {
 public:
  explicit RowWriter(std::string& text) : text_(text) {}

  void add(double value) { fmt::format_to(std::back_inserter(text_), ",{}", value); }
  void add(int value) { fmt::format_to(std::back_inserter(text_), ",{}", value); }
  void add(const Eigen::Vector3d& point) {
    for (const double coordinate : point) add(coordinate);
  }
  void add_or_blank(const std::optional<double>& value) { value ? add(*value) : add_blanks(1); }
  void add_or_blank(const std::optional<Eigen::Vector3d>& point) { point ? add(*point) : add_blanks(3); }

 private:
  void add_blanks(std::size_t count) { text_.append(count, ','); }

  std::string& text_;
};

void add_row(std::string& text, const Station& station, const PointReading& reading, int repeat,
             const OptionalColumns& columns) {
  text += quoted(station.name);
  RowWriter row(text);
  row.add(station.commanded.position);
  row.add(degrees_of(station.commanded.rotation));
  row.add(reading.point);
  if (columns.repeat) row.add(repeat);
  if (columns.rotation) row.add_or_blank(in_degrees(reading.rotation));
  if (columns.second) row.add_or_blank(reading.second);
  if (columns.sigma) row.add_or_blank(reading.sigma);
  if (station.believed) {
    const bool angles = joint_unit(columns.joints.actuator) == Unit::rad;
    for (const double joint : *station.believed) row.add(angles ? degrees_of(joint) : joint);
  }
  text += '\n';
}

/// A table holds every pose once, by a name in one line.
void check_names(const std::vector<Station>& stations) {
  std::set<std::string_view> names;
  for (const auto& [name, commanded, believed] : stations) {
    if (name.empty() || name.find('\n') != std::string::npos || !is_utf8(name)) {
      throw InvalidArgument(fmt::format("station {}: expected a name in one line of UTF-8 text", names.size() + 1));
    }
    if (!names.insert(name).second) {
      throw InvalidArgument(fmt::format("expected every station's name once, got \"{}\" twice", name));
    }
  }
}

/// Joint coordinates that every station states; 0 where none does.
std::size_t joint_count_of(const std::vector<Station>& stations) {
  const auto stated =
      std::ranges::count_if(stations, [](const Station& station) { return station.believed.has_value(); });
  if (stated == 0) return 0;
  if (static_cast<std::size_t>(stated) != stations.size()) {
    throw InvalidArgument(fmt::format("expected the believed joints of all {} stations or of none, got those of {}",
                                      stations.size(), stated));
  }
  const auto count = static_cast<std::size_t>(stations.front().believed->size());
  if (count < 3) throw InvalidArgument(fmt::format("expected 3 or 4 believed joints a station, got {}", count));
  return count;
}

/// The readings in their order, but one of home first: the first row of a table is home.
std::vector<PointReading> home_first(std::vector<PointReading> readings) {
  const auto home = std::ranges::find(readings, std::size_t{0}, &PointReading::station);
  if (home != readings.end()) std::rotate(readings.begin(), home, home + 1);
  return readings;
}

}  // namespace

Measurements read_points(const TextFile& file, const JointSpace& joints) {
  const CsvTable table(file);
  table.allow_only(with_joint_columns({"pose", "x_cmd_mm", "y_cmd_mm", "z_cmd_mm", "phi_cmd_deg", "x_mm", "y_mm",
                                       "z_mm", "repeat", "phi_deg", "x2_mm", "y2_mm", "z2_mm", "sigma_mm"},
                                      joints));
  const JointSpace present = joint_columns(table, joints);
  StationList stations(present.actuator);
  SeriesBuilder series(file);
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const Station station = station_of(table, row, present);
    add_row(series, table, row, station.name, stations.index_of(table, row, station));
  }
  if (series.is_empty()) throw InputFileError(file.name, 0, "expected at least one row with a point, got none");
  return std::move(series).finish(std::move(stations).take());
}

std::string point_table(const Measurements& measurements, Actuator actuator) {
  if (measurements.series.size() != 1 || measurements.series.front().readings.empty()) {
    throw InvalidArgument(
        fmt::format("expected one series of points to write, got {}",
                    measurements.series.size() == 1 ? "an empty one" : std::to_string(measurements.series.size())));
  }
  const std::vector<Station>& stations = measurements.stations;
  const std::size_t joint_count = joint_count_of(stations);
  check(measurements, joint_count);
  check_names(stations);
  const std::vector<PointReading> readings = home_first(measurements.series.front().readings);
  const OptionalColumns columns = columns_for(readings, {joint_count, actuator});
  std::string text = header_of(columns);
  std::vector<int> visits(stations.size());
  for (const PointReading& reading : readings) {
    add_row(text, stations[reading.station], reading, ++visits[reading.station], columns);
  }
  return text;
}

std::string station_table(const std::vector<Station>& stations) {
  check_names(stations);
  std::string text = "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg\n";
  for (const Station& station : stations) {
    text += quoted(station.name);
    RowWriter row(text);
    row.add(station.commanded.position);
    row.add(tidy_degrees(station.commanded.rotation));
    text += '\n';
  }
  return text;
}

}  // namespace paracal::io
