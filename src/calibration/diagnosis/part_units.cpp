#include "part_units.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace paracal::detail {
namespace {

constexpr double kAlike = 0.1;  // of a logarithm: machines are built better than that, and units are farther apart

/// Unit of each reading of a series: place among kOtherUnits, or mm behind them.
using Units = std::vector<std::size_t>;
constexpr std::size_t kMm = kOtherUnits.size();

double mm_of(std::size_t unit) { return unit == kMm ? 1.0 : kOtherUnits[unit].mm; }

/// The unit in which `read` is `expected` mm; nothing where none is.
std::optional<std::size_t> unit_of(double expected, double read) {
  for (std::size_t unit = 0; unit <= kMm; ++unit) {
    if (std::abs(std::log(expected / (read * mm_of(unit)))) < kAlike) return unit;
  }
  return std::nullopt;
}

/// Each point by a vote of the others: two in the same unit are as far apart as their commands, times that unit.
Units units_of(const PointSeries& series, const std::vector<Station>& stations) {
  constexpr std::size_t kMostOthers = 200;
  constexpr double kFarthestShare = 0.02;  // of the longest distance: nearer ones are mostly errors
  const std::vector<PointReading>& all = series.readings;
  const auto place = [&](std::size_t k) -> const Eigen::Vector3d& {
    return stations[all[k].station].commanded.position;
  };
  const std::size_t stride = (all.size() + kMostOthers - 1) / std::max<std::size_t>(kMostOthers, 1);
  double longest = 0.0;
  for (std::size_t k = 0; k < all.size(); ++k) longest = std::max(longest, (place(k) - place(0)).norm());
  Units units(all.size(), kMm);
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::array<std::size_t, kMm + 1> votes{};
    for (std::size_t other = 0; other < all.size(); other += stride) {
      const double expected = (place(k) - place(other)).norm(), read = (all[k].point - all[other].point).norm();
      if (!(expected > kFarthestShare * longest)) continue;
      if (const auto unit = unit_of(expected, read)) ++votes[*unit];
    }
    const auto most = std::ranges::max_element(votes);
    if (*most > votes[kMm]) units[k] = static_cast<std::size_t>(most - votes.begin());
  }
  return units;
}

Units units_of(const std::vector<DistanceReading>& distances, const std::vector<Station>& stations) {
  Units units;
  units.reserve(distances.size());
  for (const DistanceReading& one : distances) {
    const double expected = (stations[one.from].commanded.position - stations[one.to].commanded.position).norm();
    units.push_back(unit_of(expected, one.distance).value_or(kMm));
  }
  return units;
}

/// Of lengths that are all about the same in one unit or another, as a ball bar's are; else they are what they are.
Units units_of(const LengthSeries& series) {
  double longest = 0.0;
  for (const LengthReading& one : series.readings) longest = std::max(longest, std::abs(one.length));
  Units units;
  for (const LengthReading& one : series.readings) {
    const auto unit = unit_of(longest, std::abs(one.length));
    if (!unit) return Units(series.readings.size(), kMm);
    units.push_back(*unit);
  }
  return units;
}

/// Readings that are alike, which a sentence can name.
bool is_part(const Units& units) {
  constexpr std::ptrdiff_t kFewest = 3;  // of each: fewer are single wrong readings
  const std::ptrdiff_t in_mm = std::ranges::count(units, kMm);
  return in_mm >= kFewest && std::ssize(units) - in_mm >= kFewest;
}

/// "readings 25 to 48", or "24 of 48 readings".
std::string rows_of(const Units& units, std::size_t unit) {
  constexpr std::size_t kMostRuns = 3;
  std::vector<std::string> runs;
  for (std::size_t k = 0; k < units.size(); ++k) {
    if (units[k] != unit) continue;
    std::size_t last = k;
    while (last + 1 < units.size() && units[last + 1] == unit) ++last;
    runs.push_back(last == k ? fmt::format("{}", k + 1) : fmt::format("{} to {}", k + 1, last + 1));
    k = last;
  }
  if (runs.size() <= kMostRuns) return fmt::format("readings {}", fmt::join(runs, " and "));
  return fmt::format("{} of {} readings", std::ranges::count(units, unit), units.size());
}

std::string text_of(const Units& units, const std::string& of) {
  std::vector<std::string> parts;
  for (std::size_t unit = 0; unit < kMm; ++unit) {
    if (std::ranges::find(units, unit) == units.end()) continue;
    parts.push_back(fmt::format("{}{} are in {}", rows_of(units, unit), of, kOtherUnits[unit].name));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// Series that have such a part, each with what brings it into one unit.
class Parts {
 public:
  void add(Units units, const std::string& name, std::function<void(Measurements&, std::size_t, double)> scale) {
    if (!is_part(units)) return;
    texts_.push_back(text_of(units, name.empty() ? "" : " of " + name));
    undo_.push_back([units = std::move(units), scale = std::move(scale)](Measurements& m) {
      for (std::size_t k = 0; k < units.size(); ++k) scale(m, k, mm_of(units[k]));
    });
  }

  std::optional<Mistake> mistake() && {
    if (texts_.empty()) return std::nullopt;
    return mistake_of_measurements("unit", fmt::format("{}", fmt::join(texts_, ", ")),
                                   [undo = std::move(undo_)](Measurements& m) {
                                     for (const auto& one : undo) one(m);
                                   });
  }

 private:
  std::vector<std::string> texts_;
  std::vector<std::function<void(Measurements&)>> undo_;
};

void scale_point(PointReading& reading, double factor) {
  reading.point *= factor;
  if (reading.second) *reading.second *= factor;
}

}  // namespace

std::optional<Mistake> part_in_another_unit(const Measurements& measurements) {
  Parts parts;
  const std::size_t series = measurements.series.size() + measurements.lengths.size();
  const auto named = [&](const std::string& name) { return series > 1 ? name : std::string(); };
  for (std::size_t s = 0; s < measurements.series.size(); ++s) {
    const PointSeries& one = measurements.series[s];
    parts.add(units_of(one, measurements.stations), named(one.name),
              [s](Measurements& m, std::size_t k, double factor) { scale_point(m.series[s].readings[k], factor); });
  }
  parts.add(units_of(measurements.distances, measurements.stations), series > 0 ? "the distances" : "",
            [](Measurements& m, std::size_t k, double factor) { m.distances[k].distance *= factor; });
  for (std::size_t s = 0; s < measurements.lengths.size(); ++s) {
    parts.add(units_of(measurements.lengths[s]), named(measurements.lengths[s].name),
              [s](Measurements& m, std::size_t k, double factor) { m.lengths[s].readings[k].length *= factor; });
  }
  return std::move(parts).mistake();
}

}  // namespace paracal::detail
