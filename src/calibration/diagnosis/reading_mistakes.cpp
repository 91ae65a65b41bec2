#include "reading_mistakes.hpp"

#include <algorithm>
#include <array>
#include <set>

namespace paracal::detail {
namespace {

template <typename Change>
void change_points(PointSeries& series, Change&& change) {
  for (PointReading& reading : series.readings) {
    reading.point = change(reading.point);
    if (reading.second) reading.second = change(*reading.second);
  }
}

template <typename Holds>
bool some_point(const Measurements& measurements, Holds&& holds) {
  return std::ranges::any_of(measurements.series,
                             [&](const PointSeries& series) { return std::ranges::any_of(series.readings, holds); });
}

/// Place `by` further on in a ring of `count`.
std::size_t ring(std::size_t place, int by, std::size_t count) {
  const auto n = static_cast<std::ptrdiff_t>(count);
  return static_cast<std::size_t>((static_cast<std::ptrdiff_t>(place) + by % n + n) % n);
}

template <typename Reading>
void shift_rows_of(std::vector<Reading>& readings, int by) {
  const std::vector<Reading> was = readings;
  for (std::size_t k = 0; k < was.size(); ++k) readings[k].station = was[ring(k, by, was.size())].station;
}

template <typename Reading>
bool repeats_in(const std::vector<Reading>& readings) {
  std::set<std::size_t> seen;
  return std::ranges::any_of(readings, [&](const Reading& reading) { return !seen.insert(reading.station).second; });
}

}  // namespace

bool reads_rotation(const Measurements& measurements) {
  const auto turned = [](const auto& reading) { return reading.rotation.has_value(); };
  return some_point(measurements, turned) || std::ranges::any_of(measurements.distances, turned);
}

bool reads_second(const Measurements& measurements) {
  return some_point(measurements, [](const PointReading& reading) { return reading.second.has_value(); });
}

bool reads_orientation(const Measurements& measurements) {
  return std::ranges::any_of(measurements.series, &PointSeries::is_of_body);
}

bool reads_lengths(const Measurements& measurements, LengthKind kind) {
  return std::ranges::any_of(measurements.lengths, [&](const LengthSeries& series) { return series.kind == kind; });
}

bool has_repeats(const Measurements& measurements) {
  return std::ranges::any_of(measurements.series, [](const auto& one) { return repeats_in(one.readings); }) ||
         std::ranges::any_of(measurements.lengths, [](const auto& one) { return repeats_in(one.readings); });
}

void scale_points(PointSeries& series, double factor) {
  change_points(series, [&](const Eigen::Vector3d& point) { return Eigen::Vector3d(factor * point); });
}

void scale_lengths(LengthSeries& series, double factor) {
  for (LengthReading& reading : series.readings) reading.length *= factor;
}

void scale_distances(Measurements& measurements, double factor) {
  for (DistanceReading& reading : measurements.distances) reading.distance *= factor;
}

void scale_readings(Measurements& measurements, double factor) {
  for (PointSeries& series : measurements.series) scale_points(series, factor);
  for (LengthSeries& series : measurements.lengths) scale_lengths(series, factor);
  scale_distances(measurements, factor);
}

void scale_rotations(Measurements& measurements, double factor) {
  for (DistanceReading& reading : measurements.distances) {
    if (reading.rotation) *reading.rotation *= factor;
  }
  for (PointSeries& series : measurements.series) {
    for (PointReading& reading : series.readings) {
      if (reading.rotation) *reading.rotation *= factor;
    }
  }
}

void change_orientations(Measurements& measurements, const std::function<Quaternion(const Quaternion&)>& change) {
  for (PointSeries& series : measurements.series) {
    for (PointReading& reading : series.readings) {
      if (reading.orientation) reading.orientation = change(*reading.orientation);
    }
  }
}

void negate_lengths(Measurements& measurements, LengthKind kind) {
  for (LengthSeries& series : measurements.lengths) {
    if (series.kind != kind) continue;
    for (LengthReading& reading : series.readings) reading.length = -reading.length;
  }
}

void turn_readings(Measurements& measurements, const Eigen::Matrix3d& turn) {
  for (PointSeries& series : measurements.series) {
    change_points(series, [&](const Eigen::Vector3d& point) { return Eigen::Vector3d(turn * point); });
  }
}

std::vector<Eigen::Matrix3d> exchanges_of_axes() {
  std::vector<Eigen::Matrix3d> all;
  std::array<Eigen::Index, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
      for (Eigen::Index k = 0; k < 3; ++k) {
        axes(order[static_cast<std::size_t>(k)], k) = (signs >> k) % 2 == 0 ? 1.0 : -1.0;
      }
      if (!axes.isIdentity()) all.push_back(axes);
    }
  } while (std::ranges::next_permutation(order).found);
  return all;
}

void shift_rows(Measurements& measurements, int by) {
  for (PointSeries& series : measurements.series) shift_rows_of(series.readings, by);
  for (LengthSeries& series : measurements.lengths) shift_rows_of(series.readings, by);
  const std::vector<DistanceReading> was = measurements.distances;
  for (std::size_t k = 0; k < was.size(); ++k) {
    const DistanceReading& other = was[ring(k, by, was.size())];
    measurements.distances[k].from = other.from;
    measurements.distances[k].to = other.to;
  }
}

void shift_stations(Measurements& measurements, int by) {
  const std::size_t count = measurements.stations.size();
  for (PointSeries& series : measurements.series) {
    for (PointReading& reading : series.readings) reading.station = ring(reading.station, by, count);
  }
  for (LengthSeries& series : measurements.lengths) {
    for (LengthReading& reading : series.readings) reading.station = ring(reading.station, by, count);
  }
}

}  // namespace paracal::detail
