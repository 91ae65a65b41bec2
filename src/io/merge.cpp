#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "paracal/error.hpp"
#include "paracal/io/points.hpp"
#include "readings.hpp"

namespace paracal::io {
namespace {

/// `name`, or where that is taken "name (2)", "name (3)", ...
std::string unused_name(const std::string& name, const auto& taken) {
  std::string candidate = name;
  for (int number = 2; taken.contains(candidate); ++number) candidate = fmt::format("{} ({})", name, number);
  return candidate;
}

/// What a part is called in notes and in the names of its stations.
std::string title_of_part(const Measurements& part) {
  if (!part.series.empty()) return part.series.front().name;
  return part.files.empty() ? "other" : title_of(part.files.front().name);
}

std::size_t place_of(const std::vector<std::size_t>& places, std::size_t station) {
  if (station < places.size()) return places[station];
  throw InvalidArgument(
      fmt::format("expected a reading of one of {} stations, got one of station {}", places.size(), station + 1));
}

class Merger {
 public:
  void append(const Measurements& part) {
    const std::string title = unused_name(title_of_part(part), titles_);
    // A part of several series was merged before, so its notes name their series already.
    for (const std::string& note : part.notes) {
      merged_.notes.push_back(part.series.size() == 1 ? fmt::format("{}, {}", title, note) : note);
    }
    std::vector<std::size_t> places;
    for (const Station& station : part.stations) places.push_back(append_station(station, title));
    for (const DistanceReading& reading : part.distances) append_distance(reading, places);
    for (const PointSeries& series : part.series) append_series(series, places);
    for (HeightSeries plane : part.planes) {
      for (HeightReading& reading : plane.readings) reading.station = place_of(places, reading.station);
      merged_.planes.push_back(std::move(plane));
    }
    for (const InputFile& file : part.files) append_file(file);
  }

  Measurements take() && { return std::move(merged_); }

 private:
  bool is_shared(const Station& station, std::size_t place) const {
    const Station& earlier = merged_.stations[place];
    return is_same(station.commanded, earlier.commanded) && is_same(station.believed, earlier.believed);
  }

  /// Returns its place in the merged list.
  std::size_t append_station(Station station, const std::string& title) {
    std::vector<std::size_t>& namesakes = stations_[station.name];
    for (const std::size_t place : namesakes) {
      if (is_shared(station, place)) return place;
    }
    const std::size_t place = merged_.stations.size();
    if (!namesakes.empty()) {
      station.name = unused_name(fmt::format("{}:{}", title, station.name), stations_);
      stations_[station.name] = {place};
    }
    namesakes.push_back(place);
    merged_.stations.push_back(std::move(station));
    return place;
  }

  void append_distance(DistanceReading reading, const std::vector<std::size_t>& places) {
    reading.from = place_of(places, reading.from);
    reading.to = place_of(places, reading.to);
    merged_.distances.push_back(reading);
  }

  /// A file given twice, or copied into another, would make the readings look better than they are.
  void append_series(const PointSeries& series, const std::vector<std::size_t>& places) {
    PointSeries kept{unused_name(series.name, titles_), {}};
    for (PointReading reading : series.readings) {
      reading.station = place_of(places, reading.station);
      if (!readings_.contains(key_of(reading))) kept.readings.push_back(std::move(reading));
    }
    if (const std::size_t copies = series.readings.size() - kept.readings.size(); copies > 0) {
      merged_.notes.push_back(fmt::format("{}, {} of {} readings stand in an earlier series too: counted once",
                                          kept.name, copies, series.readings.size()));
    }
    for (const PointReading& reading : kept.readings) readings_.insert(key_of(reading));
    titles_.insert(kept.name);
    if (!kept.readings.empty() || series.readings.empty()) merged_.series.push_back(std::move(kept));
  }

  /// Files of distances may share their file of poses.
  void append_file(const InputFile& file) {
    const bool is_known = std::ranges::any_of(
        merged_.files, [&](const InputFile& known) { return known.name == file.name && known.sha256 == file.sha256; });
    if (!is_known) merged_.files.push_back(file);
  }

  Measurements merged_;
  std::map<std::string, std::vector<std::size_t>> stations_;  ///< places of those that have or had a name
  std::set<std::string> titles_;
  std::set<ReadingKey> readings_;
};

}  // namespace

Measurements merge(std::vector<Measurements> parts) {
  if (parts.empty()) throw InvalidArgument("expected at least one set of measurements to merge, got none");
  if (parts.size() == 1) return std::move(parts.front());
  Merger merger;
  for (const Measurements& part : parts) merger.append(part);
  return std::move(merger).take();
}

}  // namespace paracal::io
