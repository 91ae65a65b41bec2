#include "stage_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
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
  if (fit_.parameters.size() == 0) return;
  // Where a body sits and how the plate tilts show together alone, and are found in turns.
  LeastSquaresOptions options{.max_iterations = 500};
  // With priors: a thousandth of a percent of a standard deviation, far below what anyone states.
  if (has_priors(observation_)) options.step_tolerance = 1e-5;
  observation_.hold_joint_rows(fit_.parameters);
  fit_ = solve_least_squares(with_priors(observation_), fit_.parameters, options);
  observation_.release_joint_rows();
  iterations_ += fit_.iterations;
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
  if (fit_.at_answer.row_count() == 0) return {};
  if (has_priors(observation_)) {
    return detail::scatter(observation_, fit_.parameters, fit_.at_answer.root(), [](const Group&) { return true; });
  }
  const Eigen::Index rank = analyse(fit_.at_answer.root(), kRankTolerance).rank;
  return {fit_.at_answer.squared_residuals(), static_cast<double>(fit_.at_answer.row_count() - rank)};
}

void StageFit::settle() {
  constexpr int kRounds = 30;
  constexpr double kSettled = 0.01;
  solve();
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
    if (change < kSettled) return;
    solve();
  }
}

double StageFit::update_noise(double& factor, bool stated) {
  constexpr double kSmallest = 0.01;
  const Scatter of_kind = detail::scatter(observation_, fit_.parameters, fit_.at_answer.root(),
                                          [stated](const Group& group) { return group.stated == stated; });
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
  Scatter squares;
  for (const std::size_t place : places) {
    const Eigen::Index at = observation_.nuisance_count() + static_cast<Eigen::Index>(place);
    const double prior = *observation_.sought()[place].prior_std;
    squares.sum += std::pow(fit_.parameters(at) / prior, 2);
    squares.redundancy += 1.0 - covariance(at, at) / (prior * prior);
  }
  return squares;
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
  const double factor = std::clamp(std::sqrt(squares.sum / squares.redundancy), kSmallest, kLargest);
  observation_.widen_priors(widened.places, factor);
  widened.factor *= factor;
  return factor;
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
  observation_.widen_priors(places, start);
  sought_.priors.push_back({std::move(places), start});
}

void StageFit::restore(State state) {
  for (const WidenedPriors& now : sought_.priors) observation_.widen_priors(now.places, 1.0 / now.factor);
  for (const WidenedPriors& before : state.sought.priors) observation_.widen_priors(before.places, before.factor);
  observation_.components() = state.components;
  sought_ = std::move(state.sought);
  fit_ = std::move(state.fit);
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

void StageFit::exclude_outliers(double outlier_chance) {
  if (converged() && is_suspicious()) mark_by_robust_loss(outlier_chance);
  exclude_one_by_one(outlier_chance);
  if (!converged() || !readmit(outlier_chance)) return;  // a reading that a worse one had made look bad
  settle();
  exclude_one_by_one(outlier_chance);
}

void StageFit::exclude_one_by_one(double outlier_chance) {
  while (converged() && may_exclude()) {
    const auto worst = most_contradicting();
    if (!worst || worst->chance > outlier_chance) return;
    observation_.groups()[worst->group].active = false;
    settle();
  }
}

std::vector<Contradiction> StageFit::suspects() const {
  return contradictions(observation_, fit_.parameters, covariance(), scatter());
}

/// At most every fourth reading.
bool StageFit::may_exclude() const {
  const auto excluded = std::ranges::count(observation_.groups(), false, &Group::active);
  return 4 * static_cast<std::size_t>(excluded) < observation_.groups().size();
}

std::optional<Contradiction> StageFit::most_contradicting() const {
  for (const Contradiction& one : suspects()) {
    if (observation_.groups()[one.group].active) return one;
  }
  return std::nullopt;
}

/// One residual stands out, or all are larger than anyone thought.
bool StageFit::is_suspicious() const {
  constexpr double kStandsOut = 3.5, kLarge = 1.5;
  const Scatter all = scatter();
  const bool large =
      observation_.components().unstated_noise > kLarge || all.sum > kLarge * kLarge * std::max(all.redundancy, 1.0);
  return large || std::ranges::max(studentised(observation_, fit_.parameters, covariance())) > kStandsOut;
}

/// Cauchy's loss, sum log(1 + (t / c)^2) with t the studentised size over the median, by reweighting. Readings that
/// it all but ignores are left out; those that do not contradict the rest then come back.
void StageFit::mark_by_robust_loss(double outlier_chance) {
  constexpr int kRounds = 20;
  constexpr double kCauchy = 2.0, kIgnored = 6.0;
  std::vector<double> sizes;
  for (int round = 0; round < kRounds; ++round) {
    sizes = studentised(observation_, fit_.parameters, covariance());
    for (std::size_t g = 0; g < sizes.size(); ++g) {
      observation_.groups()[g].weight = 1.0 / (1.0 + std::pow(sizes[g] / kCauchy, 2));
    }
    solve();
  }
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, std::greater{}, [&](std::size_t g) { return sizes[g]; });
  for (Group& group : observation_.groups()) group.weight = 1.0;
  for (const std::size_t g : order) {
    if (sizes[g] < kIgnored || !may_exclude()) break;
    observation_.groups()[g].active = false;
  }
  settle();
  for (bool some = true; some && converged(); settle()) some = readmit(outlier_chance);
}

/// What comes back tells the noise better, by which more may come back.
bool StageFit::readmit(double outlier_chance) {
  bool some = false;
  for (const Contradiction& one : suspects()) {
    bool& active = observation_.groups()[one.group].active;
    if (active || one.chance <= outlier_chance) continue;
    some = active = true;
  }
  return some;
}

}  // namespace paracal::detail
