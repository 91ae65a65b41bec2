#include "trial_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "calibration/fit/observation.hpp"
#include "calibration/fit/scatter.hpp"
#include "calibration/fit/sought.hpp"
#include "paracal/error.hpp"

namespace paracal::detail {
namespace {

constexpr double kFreedom = 5.0;        // nu of Student's t
constexpr std::size_t kReadings = 200;  // as many say what is wrong with a million
constexpr double kSmallestScale = 0.3;  // of the stated sigmas: no instrument is that much better than it says

/// Every n-th of them, so that about kReadings remain of `all`.
template <typename Reading>
void thin(std::vector<Reading>& readings, std::size_t all) {
  const std::size_t step = (all + kReadings - 1) / kReadings;
  if (step < 2) return;
  std::vector<Reading> kept;
  for (std::size_t k = 0; k < readings.size(); k += step) kept.push_back(readings[k]);
  readings = std::move(kept);
}

/// Calls `visit` with every index of a station that a reading holds.
template <typename Visit>
void for_each_station(Measurements& measurements, Visit&& visit) {
  for (PointSeries& series : measurements.series) {
    for (PointReading& reading : series.readings) visit(reading.station);
  }
  for (LengthSeries& series : measurements.lengths) {
    for (LengthReading& reading : series.readings) visit(reading.station);
  }
  for (DistanceReading& reading : measurements.distances) {
    visit(reading.from);
    visit(reading.to);
  }
}

/// Only stations that were measured: nobody waits for the kinematics of the others.
void drop_unread_stations(Measurements& measurements) {
  std::map<std::size_t, std::size_t> place;
  for_each_station(measurements, [&](std::size_t station) { place.emplace(station, 0); });
  std::vector<Station> stations;
  for (auto& [was, is] : place) {
    is = stations.size();
    stations.push_back(measurements.stations[was]);
  }
  for_each_station(measurements, [&](std::size_t& station) { station = place[station]; });
  measurements.stations = std::move(stations);
}

Measurements a_few_of(Measurements measurements) {
  std::size_t all = measurements.distances.size();
  for (const PointSeries& series : measurements.series) all += series.readings.size();
  for (const LengthSeries& series : measurements.lengths) all += series.readings.size();
  thin(measurements.distances, all);
  for (PointSeries& series : measurements.series) thin(series.readings, all);
  for (LengthSeries& series : measurements.lengths) thin(series.readings, all);
  drop_unread_stations(measurements);
  return measurements;
}

/// Squared residuals of a reading in units of its sigma and the noise scale, and its number of rows.
struct Miss {
  double squared = 0.0;
  double rows = 0.0;

  double weight() const { return (kFreedom + rows) / (kFreedom + squared); }
  double each() const { return std::sqrt(squared / rows); }
};

std::vector<Miss> misses_of(const Observation& observation, const Eigen::VectorXd& unknowns) {
  const auto stations = observation.stations(unknowns);
  std::vector<Miss> misses;
  Eigen::MatrixXd block;
  for (const Group& group : observation.groups()) {
    observation.rows(group, *stations, unknowns, block);
    misses.push_back({block.rightCols<1>().squaredNorm() / group.weight, static_cast<double>(block.rows())});
  }
  return misses;
}

double quantile_of(const std::vector<Miss>& misses, double share) {
  std::vector<double> sizes;
  sizes.reserve(misses.size());
  for (const Miss& miss : misses) sizes.push_back(miss.each());
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sizes.size() - 1));
  std::ranges::nth_element(sizes, at);
  return *at;
}

/// All readings under one scale of noise, that at which they lie from the machine.
void begin_at(Observation& observation, const Eigen::VectorXd& start) {
  for (Group& group : observation.groups()) group.stated = false;
  observation.let_noise_be(std::max(quantile_of(misses_of(observation, start), 0.5), kSmallestScale));
}

void reweigh(Observation& observation, const Eigen::VectorXd& unknowns) {
  const std::vector<Miss> misses = misses_of(observation, unknowns);
  for (std::size_t g = 0; g < misses.size(); ++g) observation.groups()[g].weight = misses[g].weight();
}

/// Root mean square of `values` with the weights of their readings.
class WeightedMean {
 public:
  void add(double value, double weight) {
    sum_ += weight * value * value;
    weights_ += weight;
  }
  double root() const { return std::sqrt(sum_ / weights_); }
  bool empty() const { return weights_ == 0.0; }

 private:
  double sum_ = 0.0, weights_ = 0.0;
};

/// @param factor  by which residuals are smaller than noise: the fit took its share.
void state_noise(const Observation& observation, const Eigen::VectorXd& unknowns, double factor, TrialFit& fit) {
  const auto stations = observation.stations(unknowns);
  WeightedMean lengths, rotations;
  for (const Group& group : observation.groups()) {
    const Residual residual = observation.residual(group, {*stations, unknowns});
    lengths.add(residual.size(), group.weight);
    if (residual.rotation) rotations.add(*residual.rotation, group.weight);
  }
  fit.noise = factor * lengths.root();
  if (!rotations.empty()) fit.rotation_noise = factor * rotations.root();
}

/// @param scale  of the noise.
double log_of_residuals(const std::vector<Miss>& misses, double scale) {
  double sum = 0.0;
  for (const Miss& miss : misses) {
    sum += miss.rows * std::log(scale);
    sum += 0.5 * (kFreedom + miss.rows) * std::log1p(miss.squared / kFreedom);
  }
  return sum;
}

void state_errors(const Observation& observation, const Eigen::VectorXd& unknowns, const Eigen::MatrixXd& root,
                  TrialFit& fit) {
  const Eigen::Index n = observation.source_count();
  fit.sought = observation.sought();
  fit.errors = unknowns.tail(n);
  fit.covariance = inverse_information(root).bottomRightCorner(n, n);
}

/// Squares of the errors over their priors and the volume that the priors give them.
void state_objective(const std::vector<Miss>& misses, const Eigen::MatrixXd& root, TrialFit& fit) {
  double squares = 0.0;
  fit.objective = log_of_residuals(misses, fit.scale);
  for (std::size_t k = 0; k < fit.sought.size(); ++k) {
    const std::optional<double> prior = fit.sought[k].prior_std;
    if (!prior) continue;
    squares += std::pow(fit.errors(static_cast<Eigen::Index>(k)) / *prior, 2);
    fit.objective += std::log(*prior);
  }
  fit.objective += 0.5 * squares + root.diagonal().cwiseAbs().array().max(1e-9).log().sum();
  fit.tension = std::sqrt(squares / static_cast<double>(fit.sought.size()));
}

double rows_of(const std::vector<Miss>& misses) {
  double rows = 0.0;
  for (const Miss& miss : misses) rows += miss.rows;
  return rows;
}

Scatter scatter_of_all(const Observation& observation, const Eigen::VectorXd& unknowns,
                       const InformationRoot& at_answer) {
  Scatter all = scatter_at_answer(observation, unknowns, at_answer);
  all.redundancy = std::max(all.redundancy, 1.0);
  return all;
}

/// Gross errors hardly count: rows are weighted as in the fit.
std::optional<double> scale_of_repeats(const Observation& observation, const Eigen::VectorXd& unknowns) {
  constexpr double kEnough = 9.0;  // degrees of freedom
  const Scatter visits = scatter_of_visits(observation, unknowns);
  if (visits.redundancy < kEnough) return std::nullopt;
  return observation.unstated_noise() * std::sqrt(visits.sum / visits.redundancy);
}

TrialFit stated(const Observation& observation, const Eigen::VectorXd& unknowns) {
  InformationRoot information(observation.unknown_count());
  (void)with_priors(observation)(unknowns, information);
  const Eigen::MatrixXd root = information.root();
  TrialFit fit{.scale = observation.unstated_noise()};
  const std::vector<Miss> misses = misses_of(observation, unknowns);
  state_errors(observation, unknowns, root, fit);
  state_noise(observation, unknowns,
              std::sqrt(rows_of(misses) / scatter_of_all(observation, unknowns, information).redundancy), fit);
  state_objective(misses, root, fit);
  fit.repeats = scale_of_repeats(observation, unknowns);
  return fit;
}

/// One step on the noise: the scale at which the weighted residuals equal their redundancy.
double better_scale(const Observation& observation, const LeastSquaresResult& result) {
  const Scatter all = scatter_of_all(observation, result.parameters, result.at_answer);
  const double factor = std::sqrt(all.sum / all.redundancy);
  return std::max(observation.unstated_noise() * factor, kSmallestScale);
}

std::optional<Eigen::VectorXd> settle(Observation& observation, Eigen::VectorXd unknowns) {
  constexpr int kRounds = 25;
  constexpr double kSettled = 0.02;
  for (int round = 0; round < kRounds; ++round) {
    reweigh(observation, unknowns);
    const LeastSquaresResult result =
        solve_least_squares(with_priors(observation), unknowns, {.max_iterations = 5, .step_tolerance = 1e-2});
    if (result.status == LeastSquaresStatus::not_evaluable) return std::nullopt;
    unknowns = result.parameters;
    const double scale = better_scale(observation, result);
    const double change = std::abs(scale / observation.unstated_noise() - 1.0);
    observation.let_noise_be(scale);
    if (change < kSettled) break;
  }
  return unknowns;
}

}  // namespace

std::optional<TrialFit> fit_robustly(const Input& input) {
  const std::vector<SoughtSource> sought = all_with_priors(input.robot, input.options);
  if (sought.empty()) return std::nullopt;
  const Measurements measurements = a_few_of(input.measurements);
  try {
    Observation observation(input.robot, measurements, input.options, sought);
    const auto start = observation.start({});
    if (!start) return std::nullopt;
    const bool is_stated = all_stated(observation);
    begin_at(observation, *start);
    const auto answer = settle(observation, *start);
    if (!answer) return std::nullopt;
    TrialFit fit = stated(observation, *answer);
    fit.is_stated = is_stated;
    return fit;
  } catch (const Unreachable&) {
    return std::nullopt;
  }
}

double nominal_misfit(const Input& input) {
  const Measurements measurements = a_few_of(input.measurements);
  try {
    Observation observation(input.robot, measurements, input.options, {});
    const auto start = observation.start({});
    if (start) return quantile_of(misses_of(observation, *start), 0.75);
  } catch (const Unreachable&) {
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace paracal::detail
