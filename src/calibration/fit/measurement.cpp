#include "paracal/calibration/measurement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

void check_station(const Station& station, std::size_t limb_count) {
  if (!station.commanded.position.allFinite() || !std::isfinite(station.commanded.rotation) ||
      !station.commanded.tilt.allFinite()) {
    throw InvalidArgument(named(station) + ": expected a finite commanded pose");
  }
  if (!station.believed) return;
  if (static_cast<std::size_t>(station.believed->size()) != limb_count || !station.believed->allFinite()) {
    throw InvalidArgument(fmt::format("{}: expected {} finite joint coordinates", named(station), limb_count));
  }
}

void check_reading(const DistanceReading& reading, std::size_t number, std::size_t stations) {
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (reading.from >= stations || reading.to >= stations || reading.from == reading.to) {
    throw InvalidArgument(fmt::format("distance {}: expected two different stations of {}, got {} and {}", number,
                                      stations, reading.from, reading.to));
  }
  if (!positive(reading.distance)) {
    throw InvalidArgument(fmt::format("distance {}: expected a length above 0 mm, got {}", number, reading.distance));
  }
  if (reading.distance_sigma && !positive(*reading.distance_sigma)) {
    throw InvalidArgument(
        fmt::format("distance {}: expected a sigma above 0 mm, got {}", number, *reading.distance_sigma));
  }
  if (reading.rotation && !std::isfinite(*reading.rotation)) {
    throw InvalidArgument(fmt::format("distance {}: expected a finite rotation", number));
  }
}

/// A body's poses stand alone: a series of points without orientations is of a reflector at the plate centre.
void check_orientation(const PointReading& reading, bool of_body, const auto& refuse) {
  if (!of_body) return;
  if (!reading.orientation) refuse("an orientation, as other readings of the series have one");
  if (reading.second) refuse("an orientation or a second point, got both");
  const double length = reading.orientation->norm();
  if (!(std::abs(length - 1.0) <= PointReading::kUnitLength)) {
    refuse(fmt::format("a quaternion of length 1, got one of {:.6g}", length));
  }
  if (const auto& sigma = reading.orientation_sigma; sigma && !(*sigma > 0.0 && std::isfinite(*sigma))) {
    refuse("a sigma of the orientation above 0");
  }
}

/// @param of_body  what the series says: asking it again for every reading would take the square of their number.
void check_point(const PointSeries& series, bool of_body, const PointReading& reading, std::size_t number,
                 std::size_t stations) {
  const auto refuse = [&](std::string_view expected) {
    throw InvalidArgument(fmt::format("{}, reading {}: expected {}", series.name, number, expected));
  };
  if (reading.station >= stations) refuse("a station of the list");
  if (!reading.point.allFinite()) refuse("a finite point");
  if (reading.second && !reading.second->allFinite()) refuse("a finite second point");
  if (reading.rotation && !std::isfinite(*reading.rotation)) refuse("a finite rotation");
  if (reading.sigma && !(*reading.sigma > 0.0 && std::isfinite(*reading.sigma))) refuse("a sigma above 0 mm");
  check_orientation(reading, of_body, refuse);
}

void check_length(const LengthSeries& series, const LengthReading& reading, std::size_t number, std::size_t stations) {
  const auto refuse = [&](std::string_view expected) {
    throw InvalidArgument(fmt::format("{}, reading {}: expected {}", series.name, number, expected));
  };
  if (reading.station >= stations) refuse("a station of the list");
  if (words(series.kind).positive && !(reading.length > 0.0)) refuse("a length above 0 mm");
  if (!std::isfinite(reading.length)) refuse(fmt::format("a finite {}", words(series.kind).noun));
  if (reading.sigma && !(*reading.sigma > 0.0 && std::isfinite(*reading.sigma))) refuse("a sigma above 0 mm");
}

void check_at(const LengthSeries& series) {
  const LengthWords& kind = words(series.kind);
  const bool says = series.at && series.at->allFinite() && (!kind.needs_at || series.at->norm() > 0.0);
  if (says || (!series.at && !kind.needs_at)) return;
  throw InvalidArgument(fmt::format("{}: expected {}, as three finite numbers", series.name, kind.at));
}

/// A pair of stations whichever is named first, and its place among the readings.
using NumberedPair = std::pair<std::pair<std::size_t, std::size_t>, std::size_t>;

/// Sorted, for a million pairs would fill a tree of 70 MB.
void check_pairs(const std::vector<DistanceReading>& distances) {
  std::vector<NumberedPair> pairs;
  pairs.reserve(distances.size());
  for (const DistanceReading& one : distances) pairs.emplace_back(std::minmax(one.from, one.to), pairs.size() + 1);
  std::ranges::sort(pairs);
  const auto again = std::ranges::adjacent_find(pairs, {}, &NumberedPair::first);
  if (again == pairs.end()) return;
  throw InvalidArgument(
      fmt::format("distance {}: the same two stations as distance {}", std::next(again)->second, again->second));
}

/// Readings of one station as their mean.
struct StationMean {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  int count = 0;
};

}  // namespace

bool PointSeries::is_of_body() const {
  return std::ranges::any_of(readings, [](const PointReading& one) { return one.orientation.has_value(); });
}

std::string named(const Station& station) {
  const std::string place = station.stated_in.empty() ? "" : station.stated_in + ": ";
  return fmt::format("{}station \"{}\"", place, station.name);
}

void check(const Measurements& measurements, std::size_t limb_count) {
  for (const Station& station : measurements.stations) check_station(station, limb_count);
  for (std::size_t k = 0; k < measurements.distances.size(); ++k) {
    check_reading(measurements.distances[k], k + 1, measurements.stations.size());
  }
  check_pairs(measurements.distances);
  for (const PointSeries& series : measurements.series) {
    const bool of_body = series.is_of_body();
    for (std::size_t k = 0; k < series.readings.size(); ++k) {
      check_point(series, of_body, series.readings[k], k + 1, measurements.stations.size());
    }
  }
  for (const LengthSeries& series : measurements.lengths) {
    check_at(series);
    for (std::size_t k = 0; k < series.readings.size(); ++k) {
      check_length(series, series.readings[k], k + 1, measurements.stations.size());
    }
  }
}

Measurements at_reference_temperature(Measurements measurements, double expansion) {
  const double factor = 1.0 / (1.0 + expansion);
  for (DistanceReading& reading : measurements.distances) reading.distance *= factor;
  for (PointSeries& series : measurements.series) {
    for (PointReading& reading : series.readings) {
      reading.point *= factor;
      if (reading.second) *reading.second *= factor;
    }
  }
  for (LengthSeries& series : measurements.lengths) {
    for (LengthReading& reading : series.readings) reading.length *= factor;
  }
  return measurements;
}

Measurements with_commands(const Robot& robot, Measurements measurements) {
  for (Station& station : measurements.stations) {
    if (station.commanded.position.allFinite() || !station.believed) continue;
    const ForwardResult nominal = forward(robot.nominal(), *station.believed);
    if (!nominal.ok()) {
      throw Unreachable(
          fmt::format("{}: no solution for robot {} with the joints of the table: expected joints in the order of its "
                      "limbs, with the zeros of the robot file",
                      named(station), robot.name()));
    }
    station.commanded = pose_of(robot.nominal(), nominal.plate);
  }
  return measurements;
}

Joints believed_joints(const Robot& robot, const Station& station) {
  if (station.believed) return *station.believed;
  const InverseResult nominal = inverse(robot.nominal(), station.commanded);
  if (nominal.ok()) return nominal.joints;
  const Eigen::Vector3d& r = station.commanded.position;
  throw Unreachable(fmt::format("{}: robot {} cannot reach ({:g}, {:g}, {:g}) mm at {:g} deg", named(station),
                                robot.name(), r.x(), r.y(), r.z(), to_degrees(station.commanded.rotation)));
}

std::vector<DistanceReading> all_distances(const PointSeries& series) {
  std::map<std::size_t, StationMean> means;
  for (const PointReading& reading : series.readings) {
    StationMean& mean = means[reading.station];
    mean.point += (reading.point - mean.point) / ++mean.count;
  }
  std::vector<DistanceReading> distances;
  distances.reserve(means.size() * (means.size() - 1) / 2);
  for (auto from = means.begin(); from != means.end(); ++from) {
    for (auto to = std::next(from); to != means.end(); ++to) {
      DistanceReading reading{.from = from->first, .to = to->first};
      reading.distance = (to->second.point - from->second.point).norm();
      distances.push_back(reading);
    }
  }
  return distances;
}

}  // namespace paracal
