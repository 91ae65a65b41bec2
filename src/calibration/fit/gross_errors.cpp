// Which readings a stage of the fit leaves out as gross errors.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "stage_fit.hpp"

namespace paracal::detail {

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
    if (!worst || worst->chance(observation_.groups().size()) > outlier_chance) return;
    observation_.groups()[worst->group].active = false;
    settle();
  }
}

std::vector<bool> StageFit::kept() const {
  std::vector<bool> kept;
  for (const Group& group : observation_.groups()) kept.push_back(group.active);
  return kept;
}

void StageFit::keep(const std::vector<bool>& kept) {
  for (std::size_t g = 0; g < kept.size(); ++g) observation_.groups()[g].active = kept[g];
}

const std::vector<Contradiction>& StageFit::suspects() const {
  if (!known_.suspects) known_.suspects = contradictions(observation_, fit_.parameters, covariance(), scatter());
  return *known_.suspects;
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
  constexpr double kLarge = 1.5;
  const Scatter all = scatter();
  const bool large =
      observation_.unstated_noise() > kLarge || all.sum > kLarge * kLarge * std::max(all.redundancy, 1.0);
  return large || one_stands_out(observation_, studentised(observation_, fit_.parameters, covariance()));
}

/// Rounds until every unknown stays within a hundredth of its standard deviation, and the size of a residual about as
/// much: the next rounds would mark the same readings.
std::vector<double> StageFit::settle_by_robust_loss() {
  constexpr int kRounds = 20;
  constexpr double kCauchy = 2.0, kSettled = 0.01;
  std::vector<double> sizes;
  for (int round = 0; round < kRounds; ++round, ++robust_rounds_) {
    const Eigen::MatrixXd covariance = this->covariance();
    const Eigen::VectorXd before = fit_.parameters;
    sizes = studentised(observation_, before, covariance);
    for (std::size_t g = 0; g < sizes.size(); ++g) {
      observation_.groups()[g].weight = 1.0 / (1.0 + std::pow(sizes[g] / kCauchy, 2));
    }
    solve_roughly();
    const Eigen::ArrayXd moved = (fit_.parameters - before).array().abs();
    if ((moved <= kSettled * covariance.diagonal().array().sqrt()).all()) break;
  }
  return sizes;
}

/// Cauchy's loss, sum log(1 + (t / c)^2) with t the studentised size over the median, by reweighting. Readings that
/// it all but ignores are left out; those that do not contradict the rest then come back.
void StageFit::mark_by_robust_loss(double outlier_chance) {
  constexpr double kIgnored = 6.0;
  const std::vector<double> sizes = settle_by_robust_loss();
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, std::greater{}, [&](std::size_t g) { return sizes[g]; });
  for (Group& group : observation_.groups()) group.weight = 1.0;
  for (const std::size_t g : order) {
    if (sizes[g] < kIgnored || !may_exclude()) break;
    observation_.groups()[g].active = false;
  }
  settle();
  while (converged() && readmit(outlier_chance)) settle();
}

/// What comes back tells the noise better, by which more may come back.
bool StageFit::readmit(double outlier_chance) {
  bool some = false;
  for (const Contradiction& one : suspects()) {
    bool& active = observation_.groups()[one.group].active;
    if (active || one.chance(observation_.groups().size()) <= outlier_chance) continue;
    some = active = true;
  }
  return some;
}

}  // namespace paracal::detail
