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
    append_distances(part.distances, title, places);
    for (const PointSeries& series : part.series) append_points(series, places);
    for (const LengthSeries& series : part.lengths) append_lengths(series, places);
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

  /// A file given twice, or copied into another, would make the readings look better than they are.
  void note_copies(const std::string& title, std::size_t copies, std::size_t readings) {
    if (copies == 0) return;
    merged_.notes.push_back(
        fmt::format("{}, {} of {} readings repeat an earlier series and count once", title, copies, readings));
  }

  void append_distances(const std::vector<DistanceReading>& readings, const std::string& title,
                        const std::vector<std::size_t>& places) {
    std::vector<DistanceReading> kept;
    for (DistanceReading reading : readings) {
      reading.from = place_of(places, reading.from);
      reading.to = place_of(places, reading.to);
      if (!distances_.contains(key_of(reading))) kept.push_back(reading);
    }
    note_copies(title, readings.size() - kept.size(), readings.size());
    for (const DistanceReading& reading : kept) distances_.insert(key_of(reading));
    merged_.distances.insert(merged_.distances.end(), kept.begin(), kept.end());
  }

  void append_points(const PointSeries& series, const std::vector<std::size_t>& places) {
    PointSeries kept{unused_name(series.name, titles_), {}};
    for (PointReading reading : series.readings) {
      reading.station = place_of(places, reading.station);
      if (!points_.contains(key_of(reading))) kept.readings.push_back(std::move(reading));
    }
    note_copies(kept.name, series.readings.size() - kept.readings.size(), series.readings.size());
    for (const PointReading& reading : kept.readings) points_.insert(key_of(reading));
    titles_.insert(kept.name);
    if (!kept.readings.empty() || series.readings.empty()) merged_.series.push_back(std::move(kept));
  }

  /// A dial shows few digits, so that single lengths agree by chance: copies are series that agree as a whole.
  void append_lengths(const LengthSeries& series, const std::vector<std::size_t>& places) {
    LengthSeries kept = series;
    kept.name = unused_name(series.name, titles_);
    std::multiset<ReadingKey> keys;
    for (LengthReading& reading : kept.readings) {
      reading.station = place_of(places, reading.station);
      keys.insert(key_of(reading));
    }
    titles_.insert(kept.name);
    if (lengths_.emplace(kept.kind, std::move(keys)).second) return merged_.lengths.push_back(std::move(kept));
    note_copies(kept.name, kept.readings.size(), kept.readings.size());
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
  std::set<ReadingKey> points_, distances_;                             ///< readings so far
  std::set<std::pair<LengthKind, std::multiset<ReadingKey>>> lengths_;  ///< series so far
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
