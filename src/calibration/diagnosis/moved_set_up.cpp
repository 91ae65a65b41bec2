#include "mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

namespace paracal::detail {
namespace {

constexpr std::size_t kFewest = 6;  // readings of a part: fewer tell next to nothing beside a set-up of their own

/// Readings from `row` on become a series of their own.
template <typename Series>
void split(std::vector<Series>& all, std::size_t place, std::size_t row) {
  Series later = all[place];
  const auto at = static_cast<std::ptrdiff_t>(row);
  later.readings.erase(later.readings.begin(), later.readings.begin() + at);
  all[place].readings.resize(row);
  all.insert(std::next(all.begin(), static_cast<std::ptrdiff_t>(place) + 1), std::move(later));
}

/// A series that may have to be split.
struct Splittable {
  std::size_t count;  ///< of its readings
  std::function<void(Measurements&, std::size_t row)> split;
  std::string what;  ///< that moved
  std::string name;
};

std::vector<Splittable> series_of(const Measurements& measurements) {
  std::vector<Splittable> all;
  for (std::size_t k = 0; k < measurements.series.size(); ++k) {
    const PointSeries& one = measurements.series[k];
    all.push_back({one.readings.size(), [k](Measurements& m, std::size_t row) { split(m.series, k, row); },
                   one.is_of_body() ? "the instrument, or the body on the plate," : "the instrument", one.name});
  }
  for (std::size_t k = 0; k < measurements.lengths.size(); ++k) {
    const LengthSeries& one = measurements.lengths[k];
    all.push_back({one.readings.size(), [k](Measurements& m, std::size_t row) { split(m.lengths, k, row); },
                   fmt::format("the setup of the {}", words(one.kind).plural), one.name});
  }
  std::erase_if(all, [](const Splittable& one) { return one.count < 2 * kFewest; });
  return all;
}

/// The objective of a fit as a function of where a series is split.
class Splits {
 public:
  Splits(const Input& given, const Splittable& series) : given_(given), series_(series) {}

  double objective(std::size_t row) {
    const auto [known, is_new] = objectives_.try_emplace(row, std::numeric_limits<double>::infinity());
    if (!is_new) return known->second;
    Input trial = given_;
    series_.split(trial.measurements, row);
    if (const auto fit = fit_robustly(trial)) known->second = fit->objective;
    return known->second;
  }

  /// A handful of places, then about the best in smaller and smaller steps.
  std::size_t best() {
    constexpr std::size_t kHandful = 6;
    std::size_t best = allowed(series_.count / kHandful);
    for (std::size_t k = 2; k < kHandful; ++k) best = better(best, allowed(k * series_.count / kHandful));
    for (std::size_t step = series_.count / kHandful; step > 0; step /= 2) {
      const std::size_t middle = best;
      best = better(best, allowed(middle + step));
      best = better(best, allowed(middle > step ? middle - step : 0));
    }
    return best;
  }

  /// Some readings before and after the place it is worse by far.
  bool is_sharp(std::size_t row) {
    constexpr double kWorse = 10.0;  // nats
    const std::size_t away = std::max<std::size_t>(3, series_.count / 8);
    const double least = objective(row) + kWorse;
    return objective(allowed(row + away)) > least && objective(allowed(row > away ? row - away : 0)) > least;
  }

 private:
  std::size_t allowed(std::size_t row) const { return std::clamp(row, kFewest, series_.count - kFewest); }
  std::size_t better(std::size_t one, std::size_t other) { return objective(other) < objective(one) ? other : one; }

  const Input& given_;
  const Splittable& series_;
  std::map<std::size_t, double> objectives_;
};

}  // namespace

std::vector<Mistake> moved_set_ups(const Input& given) {
  std::vector<Mistake> all;
  for (const Splittable& series : series_of(given.measurements)) {
    Splits splits(given, series);
    const std::size_t row = splits.best();
    if (!splits.is_sharp(row)) continue;
    const std::string of = series.name.empty() ? "" : fmt::format(" of {}", series.name);
    all.push_back(mistake_of_measurements(
        "moved", fmt::format("{} moved between readings {} and {}{}", series.what, row, row + 1, of),
        [split = series.split, row](Measurements& m) { split(m, row); }));
  }
  return all;
}

}  // namespace paracal::detail
