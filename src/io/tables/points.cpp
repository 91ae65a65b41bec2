#include "paracal/io/points.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
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
constexpr std::array<std::string_view, 4> kQuaternion{"qw", "qx", "qy", "qz"};

bool has_any(const CsvTable& table, std::span<const std::string_view> columns) {
  return std::ranges::any_of(columns, [&](std::string_view column) { return table.has(column); });
}

std::string text_of(const Pose& pose) {
  const std::string place = fmt::format("({}, {}, {}) mm", pose.position.x(), pose.position.y(), pose.position.z());
  if (pose.tilt.isZero(0.0)) return fmt::format("{} and {} deg", place, tidy_degrees(pose.rotation));
  return fmt::format("{} tilted by ({}, {}, {}) deg", place, tidy_degrees(pose.tilt.x()), tidy_degrees(pose.tilt.y()),
                     tidy_degrees(pose.tilt.z()));
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
      Station& first = stations_[index];
      if (!first.believed) first.believed = station.believed;  // one visit's row is enough
      refuse_change(table, row, station, first, line);
    }
    return index;
  }

  std::vector<Station> take() && { return std::move(stations_); }

 private:
  void refuse_change(const CsvTable& table, std::size_t row, const Station& station, const Station& first,
                     int line) const {
    const auto refuse = [&](const std::string& expected, const std::string& got) {
      table.fail(row, fmt::format("expected pose {} at {} as in line {}, got {}; use another name for another pose",
                                  station.name, expected, line, got));
    };
    if (!is_same(station.commanded, first.commanded)) refuse(text_of(first.commanded), text_of(station.commanded));
    if (!station.believed || is_same(station.believed, first.believed)) return;
    refuse(text_of(*first.believed, actuator_), text_of(*station.believed, actuator_));
  }

  Actuator actuator_;
  std::vector<Station> stations_;
  std::unordered_map<std::string, std::pair<std::size_t, int>> places_;  ///< index, line
};

const Pose kNotStated{Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())};

Station station_of(const CsvTable& table, std::size_t row, const JointSpace& joints) {
  const bool joints_alone =
      joints.count > 0 && !has_any(table, std::array{kCommandedPose.x, kCommandedPose.y, kCommandedPose.z});
  Station station{pose_name(table, row),
                  joints_alone ? kNotStated : pose_of(table, row, kCommandedPose, joints),
                  {},
                  table.place(row)};
  const bool states = joints_alone || (joints.count > 0 && states_joints(table, row, joints));
  if (states) station.believed = joints_of(table, row, joints);
  return station;
}

/// False where all of these numbers, which belong together, are blank.
bool is_read(const CsvTable& table, std::size_t row, std::span<const std::string_view> columns) {
  const auto blank =
      std::ranges::count_if(columns, [&](std::string_view column) { return table.text(row, column).empty(); });
  if (blank > 0 && blank < std::ssize(columns)) {
    table.fail(row, fmt::format("expected {} either all filled in or all blank, got {} blank", fmt::join(columns, ", "),
                                blank));
  }
  return blank == 0;
}

std::optional<Eigen::Vector3d> point_of(const CsvTable& table, std::size_t row, const PointColumns& columns) {
  if (!is_read(table, row, columns)) return std::nullopt;
  const auto coordinate = [&](std::size_t k) { return table.number(row, columns[k], plausible::kInstrument); };
  return Eigen::Vector3d(coordinate(0), coordinate(1), coordinate(2));
}

std::optional<Quaternion> orientation_of(const CsvTable& table, std::size_t row) {
  if (!has_any(table, kQuaternion) || !is_read(table, row, kQuaternion)) return std::nullopt;
  const auto [w, x, y, z] = kQuaternion;
  const auto part = [&](std::string_view column) { return table.number(row, column, plausible::kDirection); };
  const Quaternion read(part(w), part(x), part(y), part(z));
  if (std::abs(read.norm() - 1.0) <= PointReading::kUnitLength) return read;
  table.fail(row, fmt::format("expected a unit quaternion qw, qx, qy, qz, got length {:.6g}", read.norm()));
}

/// The number of a repeat is a label for people, but one that is no count shows that columns are mixed up.
void check_repeat(const CsvTable& table, std::size_t row) {
  const std::optional<double> repeat = table.optional_number(row, "repeat", plausible::kCount);
  if (repeat && *repeat != std::floor(*repeat)) {
    table.fail(row, fmt::format("expected a whole number from 1 in column repeat, got {}", *repeat));
  }
}

/// What was read besides the point.
PointReading reading_without_point(const CsvTable& table, std::size_t row, std::size_t station) {
  check_repeat(table, row);
  PointReading reading{.station = station};
  if (has_any(table, kSecondPoint)) reading.second = point_of(table, row, kSecondPoint);
  if (const auto phi = table.optional_number(row, "phi_deg", plausible::kAngle)) reading.rotation = to_radians(*phi);
  reading.sigma = table.optional_number(row, "sigma_mm", plausible::kNoise);
  reading.orientation = orientation_of(table, row);
  if (const auto sigma = table.optional_number(row, "sigma_deg", plausible::kNoise)) {
    reading.orientation_sigma = to_radians(*sigma);
  }
  return reading;
}

void add_row(SeriesBuilder& series, const CsvTable& table, std::size_t row, const std::string& pose,
             std::size_t station) {
  PointReading reading = reading_without_point(table, row, station);
  if (const std::optional<Eigen::Vector3d> point = point_of(table, row, kPoint)) {
    if (has_any(table, kQuaternion) && !reading.orientation) {
      return series.note(table.line(row), fmt::format("pose {} has no orientation: its point is ignored", pose));
    }
    reading.point = *point;
    series.add(table.line(row), pose, reading);
    return;
  }
  const bool has_more = reading.second || reading.rotation || reading.orientation;
  series.note(table.line(row),
              fmt::format("pose {} has no point{}", pose, has_more ? ": its other readings are ignored" : ""));
}

/// A body's poses have no second point: their orientations show what it would.
std::vector<std::string_view> columns_of(const CsvTable& table) {
  std::vector<std::string_view> columns{"pose", "x_cmd_mm", "y_cmd_mm", "z_cmd_mm", "phi_cmd_deg", "x_mm",
                                        "y_mm", "z_mm",     "repeat",   "phi_deg",  "sigma_mm"};
  columns.insert(columns.end(), kCommandedPose.tilt.begin(), kCommandedPose.tilt.end());
  if (!has_any(table, kQuaternion)) {
    columns.insert(columns.end(), kSecondPoint.begin(), kSecondPoint.end());
    return columns;
  }
  columns.insert(columns.end(), kQuaternion.begin(), kQuaternion.end());
  columns.emplace_back("sigma_deg");
  return columns;
}

}  // namespace

Measurements read_points(const TextFile& file, const JointSpace& joints) {
  const CsvTable table(file);
  table.allow_only(with_joint_columns(columns_of(table), joints));
  const JointSpace present = joint_columns(table, joints);
  StationList stations(present.actuator);
  SeriesBuilder series(file, joints.reach);
  for (std::string& note : table.notes()) series.note(std::move(note));
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const Station station = station_of(table, row, present);
    add_row(series, table, row, station.name, stations.index_of(table, row, station));
  }
  if (series.is_empty()) throw InputFileError(file.name, 0, "expected at least one row with a point, got none");
  return std::move(series).finish(std::move(stations).take());
}

}  // namespace paracal::io
