#include "component_candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "components.hpp"
#include "numerics/variance_score.hpp"

namespace paracal::detail {
namespace {

/// What a component came to, in words of its size.
using Sentence = std::function<std::string(const StageFit&, double)>;

/// What the joints' standard deviation does to a coordinate of the plate, root mean square over the stations, mm.
double pose_disagreement(const StageFit& fit) {
  const auto states = fit.observation().stations(fit.fit().parameters);
  double squares = 0.0;
  StationMotions fresh;
  for (std::size_t s = 0; s < states->size(); ++s) {
    const PlateMotions& by_joint = fit.observation().motions_of(s, (*states)[s], fresh).by_joint;
    squares += by_joint.topRows<3>().squaredNorm() / 3.0;
  }
  return fit.observation().components().joint * std::sqrt(squares / static_cast<double>(states->size()));
}

/// Standard deviation that moves a row by as much as its noise.
double first_joint_std(const StageFit& fit) {
  const Observation& observation = fit.observation();
  const auto states = observation.stations(fit.fit().parameters);
  double squares = 0.0, rows = 0.0;
  Eigen::MatrixXd block, by_joint;
  for (const Group& group : observation.groups()) {
    if (!group.active) continue;
    observation.rows(group, *states, fit.fit().parameters, block, &by_joint);
    squares += by_joint.squaredNorm();
    rows += static_cast<double>(by_joint.rows());
  }
  return std::sqrt(rows / std::max(squares, 1e-300));
}

std::string joint_sentence(const StageFit& fit, bool repeated) {
  return fmt::format(
      "the poses differ from the model by {:.3f} mm more than the noise explains ({} {:.3f} mm). Possible causes: "
      "backlash, friction{}",
      pose_disagreement(fit), repeated ? "repeatability" : "stated noise", reading_noise(fit.observation()),
      repeated ? " or load" : ", load or larger noise");
}

ComponentCandidate joint_candidate(double promised, Sentence say) {
  return {.promised = promised,
          .begin = [](StageFit& fit) { fit.seek_joint(first_joint_std(fit)); },
          .size = [](const StageFit& fit) { return fit.observation().components().joint; },
          .say = std::move(say)};
}

/// By how much -2 log likelihood promises to drop when joints are let stand elsewhere beside noise of any size.
double drop_by_joints(const StageFit& fit) {
  const Observation& observation = fit.observation();
  const Eigen::VectorXd& unknowns = fit.fit().parameters;
  const Eigen::MatrixXd covariance = fit.covariance();
  const auto states = observation.stations(unknowns);
  VarianceScore variances;
  Eigen::MatrixXd block, by_joint;
  for (const Group& group : observation.groups()) {
    const Eigen::Index turns = observation.orientation_rows(group);
    if (!group.active || group.is_relative() || turns == 0) continue;
    observation.rows(group, *states, unknowns, block, &by_joint);
    const Eigen::MatrixXd J = block.leftCols(observation.unknown_count());
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(block.rows(), block.rows());
    std::array<Eigen::MatrixXd, 3> A{by_joint * by_joint.transpose(), one, one};
    A[1].diagonal().segment(3, turns).setZero();
    A[2].diagonal().head(3).setZero();
    variances.add(A, one - J * covariance * J.transpose(), block.rightCols<1>());
  }
  return variances.drop_of_first();
}

/// Noise that nobody states and no repeat shows is told from joints by what a pose shows of both: joints turn a plate
/// as they shift it, noise does not.
void add_joint_beside_noise(const StageFit& fit, std::vector<ComponentCandidate>& all) {
  const Observation& observation = fit.observation();
  const bool turns = std::ranges::any_of(observation.groups(), [&](const Group& group) {
    return group.active && observation.orientation_rows(group) > 0;
  });
  if (!turns) return;
  all.push_back(joint_candidate(drop_by_joints(fit), [](const StageFit& at, double) {
    return fmt::format(
        "the poses differ from the model by {:.3f} mm more than the noise ({:.3f} mm) explains, as joint errors would. "
        "Possible causes: backlash, friction, load or uneven drives",
        pose_disagreement(at), reading_noise(at.observation()));
  }));
}

void add_joint(const StageFit& fit, std::vector<ComponentCandidate>& all) {
  const auto& groups = fit.observation().groups();
  const bool stated = std::ranges::any_of(groups, &Group::stated);
  const FitScatter scatter = fit_scatter(fit);
  if (fit.components().joint) return;
  if (!stated && scatter.visits.redundancy < 3.0) return add_joint_beside_noise(fit, all);
  const double visits = scatter.visits.redundancy >= 3.0 ? scatter.visits.sum / scatter.visits.redundancy : 1.0;
  if (!(scatter.poses.redundancy >= 3.0) || !(visits > 0.0)) return;
  const double ratio = scatter.poses.sum / scatter.poses.redundancy / visits;
  const bool repeated = scatter.visits.redundancy >= 3.0;
  all.push_back(joint_candidate(promised_drop(ratio, scatter.poses.redundancy),
                                [repeated](const StageFit& at, double) { return joint_sentence(at, repeated); }));
}

void add_stated_noise(const StageFit& fit, std::vector<ComponentCandidate>& all) {
  if (fit.components().stated_noise) return;
  const auto& groups = fit.observation().groups();
  if (std::ranges::none_of(groups, &Group::stated)) return;
  const Scatter stated = detail::scatter(fit.observation(), fit.fit().parameters, fit.fit().at_answer.root(),
                                         [](const Group& group) { return group.stated; });
  if (stated.redundancy < 1.0) return;
  const double ratio = stated.sum / stated.redundancy;
  all.push_back({.promised = promised_drop(ratio, stated.redundancy),
                 .begin = [ratio](StageFit& at) { at.seek_stated_noise(std::sqrt(ratio)); },
                 .size = [](const StageFit& at) { return at.observation().components().stated_noise; },
                 .say =
                     [](const StageFit&, double size) {
                       return fmt::format("the readings scatter {:.2g} times as much as their stated sigmas", size);
                     }});
}

}  // namespace

double promised_drop(double ratio, double freedom) {
  return ratio > 1.0 && freedom > 0.0 ? freedom * (ratio - 1.0 - std::log(ratio)) : 0.0;
}

void add_noise_candidates(const StageFit& fit, std::vector<ComponentCandidate>& all) {
  add_joint(fit, all);
  add_stated_noise(fit, all);
}

std::vector<ComponentCandidate> worth_trying(std::vector<ComponentCandidate> all) {
  constexpr double kAlike = 10.0;
  constexpr std::size_t kMost = 3, kMostParts = 5;
  std::erase_if(all, [](const ComponentCandidate& one) { return one.worth() < kWorthTrying; });
  std::ranges::stable_sort(all, std::greater{}, &ComponentCandidate::worth);
  const auto best_part = std::ranges::find_if(all, &ComponentCandidate::names_part);
  const double alike = best_part == all.end() ? 0.0 : best_part->worth() - kAlike;
  std::vector<ComponentCandidate> tried;
  std::size_t parts = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool first = std::ranges::find(tried, all[k].family, &ComponentCandidate::family) == tried.end();
    const bool alike_part = all[k].names_part() && parts < kMostParts && all[k].worth() > alike;
    if (k >= kMost && !first && !alike_part) continue;
    parts += all[k].names_part() ? 1 : 0;
    tried.push_back(std::move(all[k]));
  }
  return tried;
}

}  // namespace paracal::detail
