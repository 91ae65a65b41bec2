#include "readings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "numerics/median.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/plausible.hpp"

namespace paracal::io {
namespace {

Coordinates coordinates(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

/// Of q and -q, which turn alike, the one whose first number that is not 0 is positive.
std::array<double, 4> one_of_two(std::array<double, 4> quaternion) {
  const auto first = std::ranges::find_if(quaternion, [](double number) { return number != 0.0; });
  if (first == quaternion.end() || *first > 0.0) return quaternion;
  for (double& number : quaternion) number = -number + 0.0;
  return quaternion;
}

/// There is nothing to fit at a station without a reading, and the robot may not even reach it.
void leave_out_unread_stations(Measurements& measurements) {
  std::vector<PointReading>& readings = measurements.series.front().readings;
  std::vector<bool> is_read(measurements.stations.size());
  for (const PointReading& reading : readings) is_read[reading.station] = true;
  std::vector<std::size_t> places(measurements.stations.size());
  std::vector<Station>& stations = measurements.stations;
  const std::string home = stations.front().name;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < stations.size(); ++k) {
    if (!is_read[k]) continue;
    places[k] = kept;
    if (k != kept) stations[kept] = std::move(stations[k]);
    ++kept;
  }
  stations.resize(kept);
  if (!is_read.front()) {
    measurements.notes.push_back(
        fmt::format("pose {} is used as home, because {} has no point", stations.front().name, home));
  }
  for (PointReading& reading : readings) reading.station = places[reading.station];
}

}  // namespace

ReadingKey key_of(const PointReading& reading) {
  std::optional<Coordinates> second;
  if (reading.second) second = coordinates(*reading.second);
  std::optional<std::array<double, 4>> turn;
  if (const auto& q = reading.orientation) turn = one_of_two({q->w(), q->x(), q->y(), q->z()});
  return {reading.station, coordinates(reading.point), second, reading.rotation, turn};
}

ReadingKey key_of(const LengthReading& reading) { return {reading.station, {0.0, 0.0, reading.length}, {}, {}, {}}; }

ReadingKey key_of(const DistanceReading& reading) {
  const auto [first, second] = std::minmax(reading.from, reading.to);
  std::optional<double> rotation = reading.rotation;
  if (rotation && second == reading.from) rotation = -*rotation;
  return {first, {static_cast<double>(second), reading.distance, 0.0}, {}, rotation, {}};
}

bool is_same(const Pose& a, const Pose& b) {
  const bool neither_states = !a.position.allFinite() && !b.position.allFinite();
  return (neither_states || a.position == b.position) && a.rotation == b.rotation && a.tilt == b.tilt;
}

bool is_same(const std::optional<Joints>& a, const std::optional<Joints>& b) {
  if (!a || !b) return !a && !b;
  return a->size() == b->size() && *a == *b;
}

std::string title_of(const std::string& file) {
  const std::size_t start = file.find_last_of('/') + 1;  // 0 where there is no folder
  return start == file.size() ? file : file.substr(start);
}

SeriesBuilder::SeriesBuilder(const TextFile& file, double reach) : reach_(reach) {
  measurements_.series = {{title_of(file.name), {}}};
  measurements_.files = {{file.name, sha256(file)}};
}

void SeriesBuilder::note(int line, std::string_view text) { note(fmt::format("line {}: {}", line, text)); }

void SeriesBuilder::add(int line, const std::string& pose, const PointReading& reading) {
  const auto [copied, is_new] = readings_.try_emplace(key_of(reading), line);
  if (!is_new) {
    note(line, fmt::format("pose {} repeats the reading of line {} and counts once", pose, copied->second));
    return;
  }
  const auto [twin, is_new_point] = points_.try_emplace(coordinates(reading.point), line, pose);
  if (!is_new_point) {
    const auto& [other_line, other_pose] = twin->second;
    note(line, fmt::format("pose {} has exactly the same point as pose {} in line {}: check both", pose, other_pose,
                           other_line));
  }
  measurements_.series.front().readings.push_back(reading);
  lines_.push_back(line);
}

/// The instrument may stand anywhere, and one wrong point moves the mean of all: the medians say where the others are.
void SeriesBuilder::check_spread() const {
  constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  const std::vector<PointReading>& readings = measurements_.series.front().readings;
  const auto refuse = [&](std::size_t k, std::string_view axis, std::string_view from, double apart) {
    throw InputFileError(measurements_.files.front().name, lines_[k],
                         fmt::format("expected {} within {:g} mm of {} (ten times the reach of the robot), got {:g} mm "
                                     "from it: check the number and the unit",
                                     axis, plausible::length(reach_).most, from, apart));
  };
  std::vector<Eigen::Vector3d> points(readings.size());
  std::ranges::transform(readings, points.begin(), &PointReading::point);
  const Eigen::Vector3d middle = detail::median(points);
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const Eigen::Vector3d apart = (points[k] - middle).cwiseAbs();
    const Eigen::Vector3d beside = (readings[k].second.value_or(points[k]) - points[k]).cwiseAbs();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const std::string_view name = kAxes[static_cast<std::size_t>(axis)];
      if (!plausible::length(reach_).contains(apart(axis))) refuse(k, name, "the middle of the points", apart(axis));
      if (!plausible::length(reach_).contains(beside(axis))) refuse(k, name, "the first reflector", beside(axis));
    }
  }
}

Measurements SeriesBuilder::finish(std::vector<Station> stations) && {
  check_spread();
  measurements_.stations = std::move(stations);
  leave_out_unread_stations(measurements_);
  return std::move(measurements_);
}

}  // namespace paracal::io
