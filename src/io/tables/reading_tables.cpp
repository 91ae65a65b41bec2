// Readings and poses as the tables that are read again.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string_view>

#include "columns.hpp"
#include "io/files/utf8.hpp"
#include "names.hpp"
#include "paracal/error.hpp"
#include "paracal/io/points.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

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
  bool tilts = false, repeat = false, orientation = false, rotation = false, second = false, sigma = false,
       orientation_sigma = false;
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
    columns.orientation |= reading.orientation.has_value();
    columns.orientation_sigma |= reading.orientation_sigma.has_value();
  }
  return columns;
}

bool any_tilted(const std::vector<Station>& stations) {
  return std::ranges::any_of(stations, [](const Station& one) { return !one.commanded.tilt.isZero(0.0); });
}

/// Columns of the commanded pose.
std::string commanded_header(bool tilts) {
  std::string header = "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg";
  for (const std::string_view column : kCommandedPose.tilt) {
    if (tilts) header.append(",").append(column);
  }
  return header;
}

std::string header_of(const OptionalColumns& columns) {
  std::string header = commanded_header(columns.tilts) + ",x_mm,y_mm,z_mm";
  if (columns.repeat) header += ",repeat";
  if (columns.orientation) header += ",qw,qx,qy,qz";
  if (columns.rotation) header += ",phi_deg";
  if (columns.second) header += ",x2_mm,y2_mm,z2_mm";
  if (columns.sigma) header += ",sigma_mm";
  if (columns.orientation_sigma) header += ",sigma_deg";
  for (std::size_t i = 0; i < columns.joints.count; ++i) {
    header.append(",").append(joint_names(joint_unit(columns.joints.actuator))[i]);
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
  void add(const Pose& commanded, bool tilts) {
    add(commanded.position);
    add(degrees_of(commanded.rotation));
    for (const double angle : commanded.tilt) {
      if (tilts) add(degrees_of(angle));
    }
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
  row.add(station.commanded, columns.tilts);
  row.add(reading.point);
  if (columns.repeat) row.add(repeat);
  if (reading.orientation) {
    const Quaternion& q = *reading.orientation;
    for (const double number : {q.w(), q.x(), q.y(), q.z()}) row.add(number);
  }
  if (columns.rotation) row.add_or_blank(in_degrees(reading.rotation));
  if (columns.second) row.add_or_blank(reading.second);
  if (columns.sigma) row.add_or_blank(reading.sigma);
  if (columns.orientation_sigma) row.add_or_blank(in_degrees(reading.orientation_sigma));
  if (station.believed) {
    const bool angles = joint_unit(columns.joints.actuator) == Unit::rad;
    for (const double joint : *station.believed) row.add(angles ? degrees_of(joint) : joint);
  }
  text += '\n';
}

/// A table holds every pose once, by a name in one line.
void check_names(const std::vector<Station>& stations) {
  std::set<std::string_view> names;
  for (const auto& [name, commanded, believed, stated_in] : stations) {
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
    throw InvalidArgument(fmt::format("expected commanded joints of all {} stations or of none, got those of {}",
                                      stations.size(), stated));
  }
  const auto count = static_cast<std::size_t>(stations.front().believed->size());
  if (count < 3) throw InvalidArgument(fmt::format("expected 3 or 4 commanded joints per station, got {}", count));
  return count;
}

/// The readings in their order, but one of home first: the first row of a table is home.
std::vector<PointReading> home_first(std::vector<PointReading> readings) {
  const auto home = std::ranges::find(readings, std::size_t{0}, &PointReading::station);
  if (home != readings.end()) std::rotate(readings.begin(), home, home + 1);
  return readings;
}

}  // namespace

std::string point_table(const Measurements& measurements, Actuator actuator) {
  if (measurements.series.size() != 1 || measurements.series.front().readings.empty()) {
    throw InvalidArgument(
        fmt::format("expected one series of points, got {}",
                    measurements.series.size() == 1 ? "an empty one" : std::to_string(measurements.series.size())));
  }
  const std::vector<Station>& stations = measurements.stations;
  const std::size_t joint_count = joint_count_of(stations);
  check(measurements, joint_count);
  check_names(stations);
  const std::vector<PointReading> readings = home_first(measurements.series.front().readings);
  OptionalColumns columns = columns_for(readings, {joint_count, actuator});
  columns.tilts = any_tilted(stations);
  std::string text = header_of(columns);
  std::vector<int> visits(stations.size());
  for (const PointReading& reading : readings) {
    add_row(text, stations[reading.station], reading, ++visits[reading.station], columns);
  }
  return text;
}

std::string distance_table(const Measurements& measurements) {
  check_names(measurements.stations);
  const auto has = [&](auto member) {
    return std::ranges::any_of(measurements.distances, [&](const auto& one) { return (one.*member).has_value(); });
  };
  const bool rotation = has(&DistanceReading::rotation), sigma = has(&DistanceReading::distance_sigma);
  std::string text =
      fmt::format("from,to,distance_mm{}{}\n", rotation ? ",rotation_deg" : "", sigma ? ",sigma_mm" : "");
  for (const DistanceReading& reading : measurements.distances) {
    text += quoted(measurements.stations[reading.from].name);
    text.append(",").append(quoted(measurements.stations[reading.to].name));
    RowWriter row(text);
    row.add(reading.distance);
    if (rotation) row.add_or_blank(in_degrees(reading.rotation));
    if (sigma) row.add_or_blank(reading.distance_sigma);
    text += '\n';
  }
  return text;
}

std::string length_table(const Measurements& measurements) {
  if (measurements.lengths.size() != 1) {
    throw InvalidArgument(fmt::format("expected lengths of one setup, got {}", measurements.lengths.size()));
  }
  check_names(measurements.stations);
  const LengthSeries& series = measurements.lengths.front();
  const bool sigma = std::ranges::any_of(series.readings, [](const auto& one) { return one.sigma.has_value(); });
  const LengthWords& kind = words(series.kind);
  const auto& [x, y, z] = kind.at_columns;
  const bool at = series.at && !x.empty();
  std::string text =
      fmt::format("pose,{}{}{}\n", kind.column, sigma ? ",sigma_mm" : "", at ? fmt::format(",{},{},{}", x, y, z) : "");
  for (const LengthReading& reading : series.readings) {
    text += quoted(measurements.stations[reading.station].name);
    RowWriter row(text);
    row.add(reading.length);
    if (sigma) row.add_or_blank(reading.sigma);
    if (at) row.add(*series.at);
    text += '\n';
  }
  return text;
}

std::string station_table(const std::vector<Station>& stations) {
  check_names(stations);
  const bool tilts = any_tilted(stations);
  std::string text = commanded_header(tilts) + '\n';
  for (const Station& station : stations) {
    text += quoted(station.name);
    RowWriter row(text);
    row.add(station.commanded, tilts);
    text += '\n';
  }
  return text;
}

}  // namespace paracal::io
