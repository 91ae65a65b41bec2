#include "stage_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace paracal::detail {
StageFit::StageFit(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options,
                   std::vector<SoughtSource> sought, const SourceErrors& errors, bool seeks_scale)
    : observation_(robot, measurements, options, std::move(sought), seeks_scale) {
  const auto start = observation_.start(errors);
  if (!start) return;
  fit_.parameters = *start;
  leave_out_gross_points(observation_, *start);
}

void StageFit::solve() {
  // With priors: a thousandth of a percent of a standard deviation, far below what anyone states.
  solve_to(has_priors(observation_) ? 1e-5 : LeastSquaresOptions{}.step_tolerance);
}

void StageFit::solve_roughly() { solve_to(1e-3); }

void StageFit::solve_to(double step_tolerance) {
  if (fit_.parameters.size() == 0) return;
  // Where a body sits and how the plate tilts show together alone, and are found in turns.
  const LeastSquaresOptions options{.max_iterations = 500, .step_tolerance = step_tolerance};
  fit_ = solve_least_squares(with_priors(observation_), fit_.parameters, options);
  iterations_ += fit_.iterations;
  solved_with_ = observation_.noise();
  known_ = {};
}

void StageFit::solve_by_pseudo_inverse() {
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

Scatter StageFit::scatter() const {
  if (!known_.scatter) known_.scatter = found_scatter();
  return *known_.scatter;
}

std::optional<Scatter> StageFit::scatter_at_answer() const {
  const auto& groups = observation_.groups();
  if (groups.empty() || !has_priors(observation_) || observation_.noise() != solved_with_) return std::nullopt;
  const bool stated = groups.front().stated;
  if (!std::ranges::all_of(groups, [stated](const Group& one) { return one.stated == stated; })) return std::nullopt;
  return detail::scatter_at_answer(observation_, fit_.parameters, fit_.at_answer);
}

Scatter StageFit::found_scatter() const {
  if (fit_.at_answer.row_count() == 0) return {};
  if (const auto at_answer = scatter_at_answer()) return *at_answer;
  if (has_priors(observation_)) {
    return detail::scatter(observation_, fit_.parameters, fit_.at_answer.root(), [](const Group&) { return true; });
  }
  const Eigen::Index rank = analyse(fit_.at_answer.root(), kRankTolerance).rank;
  return {fit_.at_answer.squared_residuals(), static_cast<double>(fit_.at_answer.row_count() - rank)};
}

void StageFit::settle() {
  constexpr int kRounds = 30;
  constexpr double kSettled = 0.01;
  solve_roughly();
  const bool any_unstated = !all_stated(observation_);
  for (int round = 0; round < kRounds && converged(); ++round) {
    double change = 0.0;
    const auto note = [&](double factor) { change = std::max(change, std::abs(factor - 1.0)); };
    if (any_unstated && seeks_orientation_noise(observation_)) note(update_orientation_noise());
    if (any_unstated) note(update_noise());
    known_ = {};
    if (change < kSettled) break;
    solve_roughly();
  }
  if (converged()) solve();
}

double StageFit::update_noise() {
  constexpr double kSmallest = 0.01;
  const bool all = std::ranges::none_of(observation_.groups(), &Group::stated);
  const auto at_answer = all ? scatter_at_answer() : std::nullopt;
  const Scatter unstated = at_answer ? *at_answer
                                     : detail::scatter(observation_, fit_.parameters, fit_.at_answer.root(),
                                                       [](const Group& group) { return !group.stated; });
  if (unstated.redundancy < 0.5) return 1.0;
  const double before = observation_.unstated_noise(), factor = std::sqrt(unstated.sum / unstated.redundancy);
  for (SeriesNoise& one : observation_.noise()) one.unstated = std::max(one.unstated * factor, kSmallest);
  return observation_.unstated_noise() / before;
}

double StageFit::update_orientation_noise() {
  constexpr double kFewest = 6.0, kSmallest = 1e-2, kLargest = 1e2;
  const auto part = [&](bool orientations) {
    return scatter_of_rows(observation_, fit_.parameters, fit_.at_answer.root(), [&](const Group& group, Eigen::Index) {
      const bool counts = !group.stated && observation_.orientation_rows(group) > 0;
      return std::pair(Eigen::Index{orientations ? 3 : 0}, Eigen::Index{counts ? 3 : 0});
    });
  };
  const Scatter positions = part(false), orientations = part(true);
  if (positions.redundancy < kFewest || orientations.redundancy < kFewest || !(positions.sum > 0.0)) return 1.0;
  const double ratio = orientations.sum / orientations.redundancy / (positions.sum / positions.redundancy);
  const double before = observation_.noise().front().orientation;
  const double factor = std::clamp(before * std::sqrt(ratio), kSmallest, kLargest);
  for (SeriesNoise& one : observation_.noise()) one.orientation = factor;
  return factor / before;
}

void StageFit::widen_priors(const std::vector<std::size_t>& places, double factor) {
  if (prior_factors_.size() == 0) prior_factors_.setOnes(observation_.source_count());
  for (const std::size_t place : places) prior_factors_(static_cast<Eigen::Index>(place)) *= factor;
  observation_.widen_priors(prior_factors_);
  known_ = {};
}

}  // namespace paracal::detail
