#include "paracal/calibration/identification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>

#include "distance_geometry.hpp"
#include "evidence.hpp"
#include "observation.hpp"
#include "outliers.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "paracal/calibration/least_squares.hpp"
#include "paracal/error.hpp"
#include "scatter.hpp"
#include "sought.hpp"

namespace paracal {
namespace {

using detail::Group;
using detail::Observation;

constexpr double kRankTolerance = 1e-7;

/// One stage: seeks some source errors from a machine that already has `errors`.
class StageFit {
 public:
  StageFit(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
           std::vector<SoughtSource> sought, const SourceErrors& errors)
      : observation_(robot, measurements, options, std::move(sought)) {
    const auto start = observation_.start(errors);
    if (!start) return;
    fit_.parameters = *start;
    detail::leave_out_gross_points(observation_, *start);
  }

  Observation& observation() { return observation_; }
  const LeastSquaresResult& fit() const { return fit_; }
  int iterations() const { return iterations_; }

  void solve() {
    if (fit_.parameters.size() == 0) return;
    LeastSquaresOptions options;
    // With priors: a thousandth of a percent of a standard deviation, far below what anyone states.
    if (detail::has_priors(observation_)) options.step_tolerance = 1e-5;
    fit_ = solve_least_squares(detail::with_priors(observation_), fit_.parameters, options);
    iterations_ += fit_.iterations;
  }

  /// Eq. (19) with the derivative at the nominal machine, p <- p - H^+ (predicted - measured), until p settles. (Plain
  /// repetition: the fixed derivative makes no descent directions that a damped method could rely on.)
  void solve_by_pseudo_inverse() {
    constexpr int kRounds = 30;
    constexpr double kSettled = 1e-6;  // of the residuals' change, relative to 1 + |r|
    if (fit_.parameters.size() == 0) return;
    observation_.keep_nominal_derivative();
    fit_.status = LeastSquaresStatus::not_converged;
    for (; iterations_ < kRounds; ++iterations_) {
      fit_.at_answer = InformationRoot(observation_.unknown_count());
      if (!observation_(fit_.parameters, fit_.at_answer)) return;
      const Eigen::MatrixXd root = fit_.at_answer.root();
      const Eigen::VectorXd gradient = root.transpose() * fit_.at_answer.reachable();
      const Eigen::VectorXd step = -(analyse(root, kRankTolerance).covariance * gradient);
      if ((root * step).norm() < kSettled * (1.0 + std::sqrt(fit_.at_answer.squared_residuals()))) {
        fit_.status = LeastSquaresStatus::converged;
        fit_.iterations = iterations_;
        return;
      }
      fit_.parameters += step;
    }
  }

  /// Of the active readings. Without priors: residual sum, and rows less unknowns.
  detail::Scatter scatter() const {
    if (fit_.at_answer.row_count() == 0) return {};
    if (detail::has_priors(observation_)) {
      return detail::scatter(observation_, fit_.parameters, fit_.at_answer.root(), [](const Group&) { return true; });
    }
    const Eigen::Index rank = analyse(fit_.at_answer.root(), kRankTolerance).rank;
    return {fit_.at_answer.squared_residuals(), static_cast<double>(fit_.at_answer.row_count() - rank)};
  }

  /// Solves again with the noise that the residuals show, until it settles: the weighted residual sum of the
  /// readings without a stated sigma must equal their redundancy.
  void solve_with_noise_of_residuals() {
    constexpr int kRounds = 12;
    constexpr double kSettled = 0.01, kSmallest = 0.01;
    solve();
    if (std::ranges::all_of(observation_.groups(), &Group::stated)) return;
    for (int round = 0; round < kRounds && fit_.status == LeastSquaresStatus::converged; ++round) {
      double& noise = observation_.components().unstated_noise;
      const double scale = std::max(noise * unstated_scatter(), kSmallest);
      if (std::abs(scale / noise - 1.0) < kSettled) return;
      noise = scale;
      solve();
    }
  }

  /// Names and leaves out gross errors. Where the readings scatter suspiciously, a robust loss first finds those that
  /// hide behind each other; then, one at a time, the reading that contradicts the others most, if chance does not
  /// explain it (data snooping  [baarda1968]).
  void exclude_outliers(double outlier_chance) {
    if (fit_.status == LeastSquaresStatus::converged && is_suspicious()) mark_by_robust_loss(outlier_chance);
    while (fit_.status == LeastSquaresStatus::converged && may_exclude()) {
      const auto worst = most_contradicting();
      if (!worst || worst->chance > outlier_chance) return;
      observation_.groups()[worst->group].active = false;
      solve_with_noise_of_residuals();
    }
  }

  std::vector<detail::Contradiction> suspects() const {
    return detail::contradictions(observation_, fit_.parameters, inverse_information(fit_.at_answer.root()), scatter());
  }

 private:
  Eigen::MatrixXd covariance() const { return inverse_information(fit_.at_answer.root()); }

  /// At most every fourth reading.
  bool may_exclude() const {
    const auto excluded = std::ranges::count(observation_.groups(), false, &Group::active);
    return 4 * static_cast<std::size_t>(excluded) < observation_.groups().size();
  }

  std::optional<detail::Contradiction> most_contradicting() const {
    for (const detail::Contradiction& one : suspects()) {
      if (observation_.groups()[one.group].active) return one;
    }
    return std::nullopt;
  }

  /// One residual stands out, or all are larger than anyone thought.
  bool is_suspicious() const {
    constexpr double kStandsOut = 3.5, kLarge = 1.5;
    const detail::Scatter all = scatter();
    const bool large =
        observation_.components().unstated_noise > kLarge || all.sum > kLarge * kLarge * std::max(all.redundancy, 1.0);
    return large || std::ranges::max(detail::studentised(observation_, fit_.parameters, covariance())) > kStandsOut;
  }

  /// Cauchy's loss, sum log(1 + (t / c)^2) with t the studentised size over the median, by reweighting. Readings that
  /// it all but ignores are left out; those that do not contradict the rest then come back.
  void mark_by_robust_loss(double outlier_chance) {
    constexpr int kRounds = 20;
    constexpr double kCauchy = 2.0, kIgnored = 6.0;
    std::vector<double> sizes;
    for (int round = 0; round < kRounds; ++round) {
      sizes = detail::studentised(observation_, fit_.parameters, covariance());
      for (std::size_t g = 0; g < sizes.size(); ++g) {
        observation_.groups()[g].weight = 1.0 / (1.0 + std::pow(sizes[g] / kCauchy, 2));
      }
      solve();
    }
    std::vector<std::size_t> order(sizes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, std::greater{}, [&](std::size_t g) { return sizes[g]; });
    std::vector<std::size_t> ignored;
    for (Group& group : observation_.groups()) group.weight = 1.0;
    for (const std::size_t g : order) {
      if (sizes[g] < kIgnored || !may_exclude()) break;
      observation_.groups()[g].active = false;
      ignored.push_back(g);
    }
    solve_with_noise_of_residuals();
    if (fit_.status != LeastSquaresStatus::converged) return;
    for (const detail::Contradiction& one : suspects()) {
      if (std::ranges::find(ignored, one.group) == ignored.end() || one.chance <= outlier_chance) continue;
      observation_.groups()[one.group].active = true;
    }
    solve_with_noise_of_residuals();
  }

  double unstated_scatter() const {
    const detail::Scatter unstated = detail::scatter(observation_, fit_.parameters, fit_.at_answer.root(),
                                                     [](const Group& group) { return !group.stated; });
    return unstated.redundancy < 0.5 ? 1.0 : std::sqrt(unstated.sum / unstated.redundancy);
  }

  Observation observation_;
  LeastSquaresResult fit_;
  int iterations_ = 0;
};

/// The paper measures points and calibrates from the distances of all pairs, all weighing alike, and nothing else.
Measurements as_distances(const Measurements& measurements) {
  Measurements pairs{.stations = measurements.stations,
                     .distances = measurements.distances,
                     .files = measurements.files,
                     .notes = measurements.notes};
  for (const PointSeries& series : measurements.series) {
    std::vector<DistanceReading> distances = all_distances(series);
    if (pairs.distances.empty()) {
      pairs.distances = std::move(distances);
    } else {
      pairs.distances.insert(pairs.distances.end(), distances.begin(), distances.end());
    }
  }
  for (DistanceReading& reading : pairs.distances) {
    reading.distance_sigma.reset();
    reading.rotation.reset();
  }
  return pairs;
}

/// Do the readings leave nothing open but motions of the whole robot, and are there a quarter more of them than that
/// takes? Distances between N points are worth 3 N - 6 numbers at most; frames and the like cost as many as they have
/// unknowns.
bool enough_for_fine(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options) {
  constexpr double kSpare = 1.25;
  const Identifiability seen = identifiability(robot, measurements, options, detail::position_group(robot, options));
  std::set<std::size_t> joined;
  for (const DistanceReading& reading : measurements.distances) joined.insert({reading.from, reading.to});
  const auto pairs = static_cast<Eigen::Index>(measurements.distances.size());
  const auto worth = std::min(pairs, std::max<Eigen::Index>(3 * static_cast<Eigen::Index>(joined.size()) - 6, 1));
  const Eigen::Index numbers = seen.rows - (pairs - worth) - seen.nuisance;
  return std::ranges::all_of(seen.null_space, &NullDirection::gauge) &&
         static_cast<double>(numbers) >= kSpare * seen.rank;
}

bool goes_fine(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options) {
  if (options.stage != Stage::automatic) return options.stage == Stage::fine;
  return enough_for_fine(robot, measurements, options);
}

}  // namespace

Calibration calibrate(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options) {
  check(measurements, robot.limb_count());
  const bool paper = options.method == Method::paper;
  if (measurements.distances.empty() && measurements.series.empty() && (paper || measurements.planes.empty())) {
    throw InvalidArgument(measurements.planes.empty()
                              ? "measurements: expected at least one reading, got none"
                              : "method paper: expected points or distances, got heights alone");
  }
  const bool fine = goes_fine(robot, measurements, options);
  const std::vector<SoughtSource> sought =
      paper ? detail::paper_columns(robot, options) : detail::all_with_priors(robot, options);
  if (fine && sought.empty()) {
    throw InvalidArgument(
        "calibration: expected a source error to seek, got none that has a tolerance and is not fixed");
  }
  const bool biased = options.noise.distance_bias > 0.0;  // such distances are none between points
  const Measurements used = paper    ? as_distances(measurements)
                            : biased ? measurements
                                     : detail::as_points(measurements).value_or(measurements);
  Calibration calibration{.robot = robot, .notes = used.notes, .options = options, .files = measurements.files};

  // Not from heights: to them offsets alone are hardly more than the height and the tilt of the plane.
  SourceErrors offsets;
  if (!fine || used.planes.empty()) {
    StageFit rough(robot, used, options, detail::encoder_offsets(robot, options), {});
    rough.solve();
    detail::add_stage("rough", rough.observation(), rough.fit(), rough.iterations(), calibration);
    if (!fine || rough.fit().status == LeastSquaresStatus::not_evaluable) {
      detail::state_evidence(used, rough.observation(), rough.fit(), rough.scatter(), {}, calibration);
      return calibration;
    }
    offsets = rough.observation().errors(rough.fit().parameters);
  }
  StageFit stage(robot, used, options, sought, offsets);
  if (paper) {
    stage.solve_by_pseudo_inverse();
  } else {
    stage.solve_with_noise_of_residuals();
    if (options.exclude_outliers) stage.exclude_outliers(options.outlier_chance);
  }
  detail::add_stage("fine", stage.observation(), stage.fit(), stage.iterations(), calibration);
  detail::state_evidence(used, stage.observation(), stage.fit(), stage.scatter(),
                         paper ? std::vector<detail::Contradiction>{} : stage.suspects(), calibration);
  return calibration;
}

}  // namespace paracal
