#include "paracal/calibration/measurement.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "paracal/error.hpp"

namespace paracal {
namespace {

void check_station(const Station& station, std::size_t limb_count) {
  if (!station.commanded.position.allFinite() || !std::isfinite(station.commanded.rotation)) {
    throw InvalidArgument(fmt::format("station \"{}\": expected a finite commanded pose", station.name));
  }
  if (!station.believed) return;
  if (static_cast<std::size_t>(station.believed->size()) != limb_count || !station.believed->allFinite()) {
    throw InvalidArgument(
        fmt::format("station \"{}\": expected {} finite joint coordinates", station.name, limb_count));
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

}  // namespace

void check(const Measurements& measurements, std::size_t limb_count) {
  for (const Station& station : measurements.stations) check_station(station, limb_count);
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> seen;
  for (std::size_t k = 0; k < measurements.distances.size(); ++k) {
    const DistanceReading& reading = measurements.distances[k];
    check_reading(reading, k + 1, measurements.stations.size());
    const auto [first, inserted] = seen.try_emplace(std::minmax(reading.from, reading.to), k + 1);
    if (!inserted) {
      throw InvalidArgument(fmt::format("distance {}: the same two stations as distance {}", k + 1, first->second));
    }
  }
}

}  // namespace paracal
