#include "mistakes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "numerics/dense.hpp"

namespace paracal::detail {
namespace {

constexpr double kAlike = 0.1;  // of a logarithm: machines are built better than that, and units are farther apart
constexpr std::ptrdiff_t kFewestOfPart = 3;  // readings of a part: fewer are single wrong readings

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

/// Of lengths that are all about the same in one unit or another, as a ball bar's may be; else they are what they are.
Units units_of_equal(const LengthSeries& series) {
  double longest = 0.0;
  for (const LengthReading& one : series.readings) longest = std::max(longest, std::abs(one.length));
  Units units;
  for (const LengthReading& one : series.readings) {
    const auto unit = unit_of(longest, std::abs(one.length));
    if (!unit) {
      units.assign(series.readings.size(), kMm);
      return units;
    }
    units.push_back(*unit);
  }
  return units;
}

/// Readings that are alike, which a sentence can name.
bool is_part(const Units& units) {
  const std::ptrdiff_t in_mm = std::ranges::count(units, kMm);
  return in_mm >= kFewestOfPart && std::ssize(units) - in_mm >= kFewestOfPart;
}

/// Numbers at places, as sums over the places.
struct Sums {
  Eigen::Vector4d along = Eigen::Vector4d::Zero();  ///< of the numbers times (x, y, z, 1)
  double squares = 0.0;                             ///< of the numbers

  Sums operator+(const Sums& other) const { return {along + other.along, squares + other.squares}; }
};

/// Lengths by where they were read. A height and a reading of a dial are a linear function of the commanded place. So
/// is the square of a ball bar's length, less that of the place. Readings in two units are far from any such function.
class LengthsByPlace {
 public:
  LengthsByPlace(const LengthSeries& series, const std::vector<Station>& stations)
      : series_(series), places_(4, std::ssize(series.readings)) {
    for (std::size_t k = 0; k < series.readings.size(); ++k) {
      places_.col(static_cast<Eigen::Index>(k)) << stations[series.readings[k].station].commanded.position, 0.0;
    }
    places_.colwise() -= places_.rowwise().mean().eval();
    places_.row(3).setConstant(std::max(places_.cwiseAbs().maxCoeff(), 1.0));  // as large as the others
    explained_ = pseudo_inverse(places_ * places_.transpose(), kFlat);
  }

  /// From a row on, or up to it, another unit. All in mm, where this does not leave far less.
  Units units() const {
    constexpr double kFarLess = 0.01;  // of the squares: a unit changes these by 100 at least
    const std::ptrdiff_t count = std::ssize(series_.readings);
    const std::vector<Sums> mm_before = sums_before(kMm), mm_from = sums_from(kMm);
    Units best(series_.readings.size(), kMm);
    double least = kFarLess * left(mm_before.back());
    for (std::size_t unit = 0; unit < kMm; ++unit) {
      const std::vector<Sums> before = sums_before(unit), from = sums_from(unit);
      for (std::ptrdiff_t row = kFewestOfPart; row <= count - kFewestOfPart; ++row) {
        const auto at = static_cast<std::size_t>(row);
        for (const bool is_last : {true, false}) {
          const double rest = left(is_last ? mm_before[at] + from[at] : before[at] + mm_from[at]);
          if (!(rest < least)) continue;
          least = rest;
          std::ranges::fill(best, is_last ? unit : kMm);
          std::fill_n(best.begin(), row, is_last ? kMm : unit);
        }
      }
    }
    return best;
  }

 private:
  Sums sums_of(std::size_t reading, std::size_t unit) const {
    const Eigen::Vector4d place = places_.col(static_cast<Eigen::Index>(reading));
    double number = series_.readings[reading].length * mm_of(unit);
    if (series_.kind == LengthKind::ball_bar) number = number * number - place.head<3>().squaredNorm();
    return {number * place, number * number};
  }
  /// Of the readings before each row, and one more of all, were they in this unit.
  std::vector<Sums> sums_before(std::size_t unit) const {
    std::vector<Sums> sums(1);
    for (std::size_t k = 0; k < series_.readings.size(); ++k) sums.push_back(sums.back() + sums_of(k, unit));
    return sums;
  }
  /// Of the readings from each row on: a difference of sums would lose all digits to readings that are too large.
  std::vector<Sums> sums_from(std::size_t unit) const {
    std::vector<Sums> sums(series_.readings.size() + 1);
    for (std::size_t k = series_.readings.size(); k > 0; --k) sums[k - 1] = sums[k] + sums_of(k - 1, unit);
    return sums;
  }

  /// Squares that no linear function of the place explains.
  double left(const Sums& sums) const { return sums.squares - sums.along.dot(explained_ * sums.along); }

  static constexpr double kFlat = 1e-10;  // of the largest: all places are in a plane, or on a line
  const LengthSeries& series_;
  Eigen::Matrix4Xd places_;  ///< relative to their mean, and a constant
  Eigen::Matrix4d explained_;
};

Units units_of(const LengthSeries& series, const std::vector<Station>& stations) {
  Units units = units_of_equal(series);
  if (std::ssize(units) < 2 * kFewestOfPart) return units;
  return is_part(units) ? units : LengthsByPlace(series, stations).units();
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
    undo_.emplace_back([units = std::move(units), scale = std::move(scale)](Measurements& m) {
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
    parts.add(units_of(measurements.lengths[s], measurements.stations), named(measurements.lengths[s].name),
              [s](Measurements& m, std::size_t k, double factor) { m.lengths[s].readings[k].length *= factor; });
  }
  return std::move(parts).mistake();
}

}  // namespace paracal::detail
