#include "visits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "kinematics/turns.hpp"
#include "numerics/distributions.hpp"
#include "paracal/calibration/prediction.hpp"

namespace paracal::detail {
namespace {

/// What was read at a visit, and how well, as it is taken.
struct Visit {
  Eigen::VectorXd value;
  double sigma = 0.0;
  bool stated = false;
};

using Stations = std::map<std::size_t, std::vector<Visit>>;

Stations only(const Stations& all, bool stated) {
  Stations chosen;
  for (const auto& [station, visits] : all) {
    for (const Visit& one : visits) {
      if (one.stated == stated) chosen[station].push_back(one);
    }
  }
  return chosen;
}

Scatter scatter_of(const Stations& stations) {
  Scatter scatter;
  for (const auto& [station, visits] : stations) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(visits.front().value.size());
    for (const Visit& one : visits) mean += one.value / static_cast<double>(visits.size());
    for (const Visit& one : visits) scatter.sum += ((one.value - mean) / one.sigma).squaredNorm();
    scatter.redundancy += static_cast<double>((visits.size() - 1) * static_cast<std::size_t>(mean.size()));
  }
  return scatter;
}

double largest_of_means(const Stations& stations) {
  double largest = 0.0;
  for (const auto& [station, visits] : stations) {
    const double sigma = std::ranges::max(visits, {}, &Visit::sigma).sigma;
    largest = std::max(largest, sigma / std::sqrt(static_cast<double>(visits.size())));
  }
  return largest;
}

/// Adds the visits of one series to the largest of all.
/// @returns that nothing tells their noise.
bool widen(const Stations& visits, bool stated, Uncertainty& largest) {
  if (visits.empty()) return false;
  const auto noise = noise_of_visits(scatter_of(visits), stated);
  const NoiseOfVisits taken = noise.value_or(NoiseOfVisits{});
  largest = larger(largest, {taken.factor * largest_of_means(visits), taken.dof});
  return !noise;
}

double sigma_across(const TrackerModel& tracker, const Eigen::Vector3d& point) {
  return tracker.transverse + 1e-3 * point.norm() * tracker.transverse_per_m;
}

Stations points_of(const PointSeries& series, const ValidationOptions& options) {
  Stations stations;
  for (const PointReading& one : series.readings) {
    const double instrument = options.noise.tracker ? sigma_across(*options.noise.tracker, one.point)
                              : one.orientation     ? options.noise.body
                                                    : options.noise.point;
    stations[one.station].push_back({one.point, one.sigma.value_or(instrument), one.sigma || options.noise_is_known});
  }
  return stations;
}

/// Orientations as they are turned from the first of their station, phi as it was read.
Stations rotations_of(const PointSeries& series, const ValidationOptions& options) {
  Stations stations;
  std::map<std::size_t, Quaternion> first;
  for (const PointReading& one : series.readings) {
    if (!one.orientation && !one.rotation) continue;
    Eigen::VectorXd value = Eigen::VectorXd::Constant(1, one.rotation.value_or(0.0));
    if (one.orientation) {
      const Quaternion& from = first.try_emplace(one.station, *one.orientation).first->second;
      value = turn_of((from.conjugate() * *one.orientation).normalized().toRotationMatrix());
    }
    stations[one.station].push_back({value, one.orientation_sigma.value_or(options.noise.rotation),
                                     one.orientation_sigma || options.rotation_noise_is_known});
  }
  return stations;
}

}  // namespace

double Uncertainty::expanded_of_all(std::size_t count, double coordinates) const {
  constexpr double kBeyondTwo = 0.0455;  // of a standard normal variable, both tails
  if (count == 0) return 0.0;
  const double tail = -std::expm1(std::log1p(-kBeyondTwo) / static_cast<double>(count));
  const double square = std::isfinite(dof) ? coordinates * fisher_quantile(tail, coordinates, dof)
                                           : chi_square_quantile(tail, coordinates);
  return standard * std::sqrt(square);
}

Uncertainty Uncertainty::with(double other) const {
  const double all = std::hypot(standard, other);
  return {all, standard > 0.0 ? dof * std::pow(all / standard, 4) : std::numeric_limits<double>::infinity()};
}

std::optional<NoiseOfVisits> noise_of_visits(const Scatter& visits, bool stated) {
  constexpr double kFewest = 3.0, kContradiction = 1e-3;
  const auto as_stated = stated ? std::optional(NoiseOfVisits{}) : std::nullopt;
  if (visits.redundancy < kFewest || !std::isfinite(visits.sum)) return as_stated;
  if (stated && chi_square_tail(visits.sum, visits.redundancy) > kContradiction) return as_stated;
  return NoiseOfVisits{std::sqrt(visits.sum / visits.redundancy), visits.redundancy};
}

MeansOfVisits means_of_visits(const Measurements& measurements, const ValidationOptions& options) {
  MeansOfVisits means;
  bool assumes_points = false, assumes_rotations = false;
  for (const PointSeries& series : measurements.series) {
    for (const bool stated : {false, true}) {
      assumes_points |= widen(only(points_of(series, options), stated), stated, means.point);
      assumes_rotations |= widen(only(rotations_of(series, options), stated), stated, means.rotation);
    }
  }
  const auto note = [&](std::string_view what, double U, std::string_view unit) {
    means.notes.push_back(fmt::format(
        "U of measured {} is a typical {:.3g} {}, not that of this instrument: state the noise, or visit poses twice",
        what, U, unit));
  };
  if (assumes_points) note("points", means.point.expanded(), "mm");
  if (assumes_rotations && options.limits.rotation) note("rotations", to_degrees(means.rotation.expanded()), "deg");
  return means;
}

}  // namespace paracal::detail
