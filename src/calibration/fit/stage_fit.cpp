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
  observation_.hold_joint_rows(fit_.parameters);
  fit_ = solve_least_squares(with_priors(observation_), fit_.parameters, options);
  observation_.release_joint_rows();
  iterations_ += fit_.iterations;
  solved_with_ = observation_.components();
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
  const VarianceComponents& now = observation_.components();
  if (groups.empty() || !has_priors(observation_) || !sought_.priors.empty() || now.joint > 0.0 ||
      now != solved_with_) {
    return std::nullopt;
  }
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
  VarianceComponents& now = observation_.components();
  for (int round = 0; round < kRounds && converged(); ++round) {
    double change = 0.0;
    const auto note = [&](double factor) { change = std::max(change, std::abs(factor - 1.0)); };
    if (any_unstated && seeks_orientation_noise(observation_)) note(update_orientation_noise());
    if (any_unstated) note(update_noise(now.unstated_noise, false));
    if (sought_.stated_noise) note(update_noise(now.stated_noise, true));
    if (sought_.joint) note(update_joint());
    for (WidenedPriors& one : sought_.priors) note(update_priors(one));
    known_ = {};
    if (change < kSettled) break;
    solve_roughly();
  }
  if (converged()) solve();
}

double StageFit::update_noise(double& factor, bool stated) {
  constexpr double kSmallest = 0.01;
  const bool all = std::ranges::all_of(observation_.groups(), [&](const Group& one) { return one.stated == stated; });
  const auto at_answer = all ? scatter_at_answer() : std::nullopt;
  const Scatter of_kind = at_answer ? *at_answer
                                    : detail::scatter(observation_, fit_.parameters, fit_.at_answer.root(),
                                                      [&](const Group& group) { return group.stated == stated; });
  if (of_kind.redundancy < 0.5) return 1.0;
  const double before = factor;
  factor = std::max(factor * std::sqrt(of_kind.sum / of_kind.redundancy), kSmallest);
  return factor / before;
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
  double& factor = observation_.components().orientation_noise;
  const double ratio = orientations.sum / orientations.redundancy / (positions.sum / positions.redundancy);
  const double before = std::exchange(factor, std::clamp(factor * std::sqrt(ratio), kSmallest, kLargest));
  return factor / before;
}

StageFit::JointSquares StageFit::joint_squares() const {
  JointSquares squares;
  const auto states = observation_.stations(fit_.parameters);
  const double joint = observation_.components().joint;
  if (!states || joint <= 0.0) return squares;
  const Eigen::MatrixXd covariance = this->covariance();
  const Eigen::Index n = observation_.unknown_count();
  for (std::size_t s = 0; s < states->size(); ++s) {
    const StationRows at = observation_.station_rows(s, *states, fit_.parameters);
    if (at.groups.empty()) continue;
    const Eigen::MatrixXd by_unknowns = at.smoother * at.rows.leftCols(n);
    squares.sum += (at.smoother * at.rows.col(n)).squaredNorm();
    squares.freedom +=
        static_cast<double>(at.by_joint.cols()) -
        (at.spread.trace() + (by_unknowns * covariance).cwiseProduct(by_unknowns).sum()) / (joint * joint);
  }
  return squares;
}

double StageFit::joint_freedom() const { return joint_squares().freedom; }

double StageFit::update_joint() {
  double& joint = observation_.components().joint;
  const JointSquares squares = joint_squares();
  if (squares.freedom < 0.1 || joint <= 0.0) return 1.0;
  const double before = joint;
  joint = std::max(std::sqrt(squares.sum / squares.freedom), 0.1 * before);
  return joint / before;
}

Scatter StageFit::prior_squares(const std::vector<std::size_t>& places, const Eigen::MatrixXd& covariance) const {
  std::vector<Eigen::Index> at(places.begin(), places.end()), column(at);
  for (Eigen::Index& one : column) one += observation_.nuisance_count();
  const Eigen::LLT<Eigen::MatrixXd> root(observation_.prior_covariance()(at, at));
  const Eigen::VectorXd errors = fit_.parameters(column);
  return {errors.dot(root.solve(errors)),
          static_cast<double>(places.size()) - root.solve(covariance(column, column)).trace()};
}

std::optional<double> StageFit::prior_freedom() const {
  std::optional<double> fewest;
  const Eigen::MatrixXd covariance = this->covariance();
  for (const WidenedPriors& one : sought_.priors) {
    if (one.places.size() < 2) continue;  // an error by itself: its prior no longer matters
    const double freedom = prior_squares(one.places, covariance).redundancy;
    fewest = std::min(freedom, fewest.value_or(freedom));
  }
  return fewest;
}

double StageFit::update_priors(WidenedPriors& widened) {
  constexpr double kNothing = 1e-3, kSmallest = 0.5, kLargest = 1e3;
  const Scatter squares = prior_squares(widened.places, covariance());
  if (squares.redundancy < kNothing) return 1.0;
  const double change = std::clamp(std::sqrt(squares.sum / squares.redundancy), kSmallest, kLargest);
  const double before = std::exchange(widened.factor, std::max(widened.factor * change, 1.0));
  widen_priors();
  return widened.factor / before;
}

void StageFit::seek_joint(double start) {
  sought_.joint = true;
  observation_.components().joint = start;
}

void StageFit::seek_stated_noise(double start) {
  sought_.stated_noise = true;
  observation_.components().stated_noise = start;
}

void StageFit::seek_wider_priors(std::vector<std::size_t> places, double start) {
  sought_.priors.push_back({std::move(places), start});
  widen_priors();
}

void StageFit::widen_priors() {
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(observation_.source_count());
  for (const WidenedPriors& one : sought_.priors) {
    for (const std::size_t place : one.places) factors(static_cast<Eigen::Index>(place)) *= one.factor;
  }
  observation_.widen_priors(factors);
}

std::optional<double> StageFit::widened(const std::vector<std::size_t>& places) const {
  const auto at = std::ranges::find(sought_.priors, places, &WidenedPriors::places);
  return at == sought_.priors.end() ? std::nullopt : std::optional(at->factor);
}

void StageFit::restore(State state) {
  observation_.components() = state.components;
  solved_with_ = state.solved_with;
  sought_ = std::move(state.sought);
  widen_priors();
  fit_ = std::move(state.fit);
  known_ = {};
}

double StageFit::minus_twice_log_likelihood() const {
  const Eigen::MatrixXd root = fit_.at_answer.root();
  double priors = 0.0;
  for (const WidenedPriors& one : sought_.priors) {
    priors += 2.0 * static_cast<double>(one.places.size()) * std::log(one.factor);
  }
  return fit_.at_answer.squared_residuals() + 2.0 * root.diagonal().cwiseAbs().array().log().sum() + priors +
         observation_.log_determinant(fit_.parameters);
}

double StageFit::minus_twice_log_likelihood_of_all() const {
  constexpr double kGrossShare = 1e-3, kGrossRange = 20.0;  // mm
  double sum = minus_twice_log_likelihood();
  const double each = std::log(2.0 * std::numbers::pi);
  observation_.check_each(fit_.parameters, [&](std::size_t g, const Eigen::MatrixXd& rows, const Eigen::MatrixXd&) {
    const Group& group = observation_.groups()[g];
    const auto count = static_cast<double>(rows.rows());
    sum += group.active
               ? count * each
               : 2.0 * count * std::log(kGrossRange / observation_.sigma_of(group)) - 2.0 * std::log(kGrossShare);
  });
  return sum;
}

}  // namespace paracal::detail
