#include "components.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <functional>
#include <utility>

#include "variance_score.hpp"

namespace paracal::detail {
namespace {

/// By how much -2 log likelihood can drop at best when the variance of `freedom` squares, `ratio` times what was
/// expected, is sought: freedom (ratio - 1 - log ratio), none for squares that are too small.
double promised_drop(double ratio, double freedom) {
  return ratio > 1.0 && freedom > 0.0 ? freedom * (ratio - 1.0 - std::log(ratio)) : 0.0;
}

/// What a component came to, in words of its size.
using Sentence = std::function<std::string(const StageFit&, double)>;

/// A component that may be there.
struct Candidate {
  double promised = 0.0;  ///< drop of -2 log likelihood
  double price = 0.0;     ///< what trying as many alike takes from that drop: 2 log of their number
  std::function<void(StageFit&)> begin;
  std::function<double(const StageFit&)> size;  ///< what it came to
  Sentence say;
};

class Finder {
 public:
  Finder(StageFit& fit, const CalibrationOptions& options) : fit_(fit), options_(options) {}

  std::vector<Component> find() {
    constexpr int kMost = 8, kTries = 3;
    std::vector<Component> found;
    while (fit_.converged() && std::ssize(found) < kMost) {
      std::vector<Candidate> candidates = this->candidates();
      std::ranges::sort(candidates, std::greater{}, [](const Candidate& one) { return one.promised - one.price; });
      if (candidates.size() > kTries) candidates.resize(kTries);
      std::optional<Component> best = most_telling(candidates);
      if (!best) break;
      found.push_back(std::move(*best));
    }
    return found;
  }

 private:
  /// Tries candidates; the fit is left with the best of those that are admitted.
  std::optional<Component> most_telling(const std::vector<Candidate>& candidates) {
    const StageFit::State before = fit_.state();
    const double likelihood = fit_.minus_twice_log_likelihood();
    std::optional<Component> best;
    std::optional<StageFit::State> best_state;
    for (const Candidate& candidate : candidates) {
      candidate.begin(fit_);
      fit_.settle();
      const double drop = likelihood - fit_.minus_twice_log_likelihood() - candidate.price;
      if (fit_.converged() && drop > options_.admit_drop && (!best || drop > best->drop)) {
        best = described(candidate, drop);
        best_state = fit_.state();
      }
      fit_.restore(before);
    }
    if (best_state) fit_.restore(std::move(*best_state));
    return best;
  }

  /// A variance that may only grow: half the probability that a chi-square of one degree of freedom is larger
  /// [self-liang1987].
  Component described(const Candidate& candidate, double drop) const {
    const double chance =
        boost::math::cdf(boost::math::complement(boost::math::normal_distribution<>(), std::sqrt(drop)));
    const double size = candidate.size(fit_);
    return {candidate.say(fit_, size), size, drop, chance, chance < options_.tell_chance};
  }

  std::vector<Candidate> candidates() const {
    constexpr double kWorthTrying = 2.0;
    std::vector<Candidate> all;
    add_joint(all);
    add_stated_noise(all);
    add_priors(all);
    std::erase_if(all, [](const Candidate& one) { return one.promised - one.price < kWorthTrying; });
    return all;
  }

  void add_joint(std::vector<Candidate>& all) const {
    const auto& groups = fit_.observation().groups();
    const bool stated = std::ranges::any_of(groups, &Group::stated);
    const FitScatter scatter = fit_scatter(fit_);
    if (fit_.components().joint) return;
    if (!stated && scatter.visits.redundancy < 3.0) return add_joint_beside_noise(all);
    const double visits = scatter.visits.redundancy >= 3.0 ? scatter.visits.sum / scatter.visits.redundancy : 1.0;
    if (!(scatter.poses.redundancy >= 3.0) || !(visits > 0.0)) return;
    const double ratio = scatter.poses.sum / scatter.poses.redundancy / visits;
    const bool repeated = scatter.visits.redundancy >= 3.0;
    all.push_back(joint_candidate(promised_drop(ratio, scatter.poses.redundancy),
                                  [repeated](const StageFit& fit, double) { return joint_sentence(fit, repeated); }));
  }

  static Candidate joint_candidate(double promised, Sentence say) {
    return {.promised = promised,
            .begin = [](StageFit& fit) { fit.seek_joint(first_joint_std(fit)); },
            .size = [](const StageFit& fit) { return fit.observation().components().joint; },
            .say = std::move(say)};
  }

  /// By how much -2 log likelihood promises to drop when joints are let stand elsewhere beside noise of any size.
  static double drop_by_joints(const StageFit& fit) {
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
  void add_joint_beside_noise(std::vector<Candidate>& all) const {
    const Observation& observation = fit_.observation();
    const bool turns = std::ranges::any_of(observation.groups(), [&](const Group& group) {
      return group.active && observation.orientation_rows(group) > 0;
    });
    if (!turns) return;
    all.push_back(joint_candidate(drop_by_joints(fit_), [](const StageFit& fit, double) {
      return fmt::format(
          "beside noise of {:.3f} mm, poses disagree with the model by {:.3f} mm, the way that joints move and turn "
          "the plate: backlash, friction, load or uneven drives",
          reading_noise(fit.observation()), pose_disagreement(fit));
    }));
  }

  static std::string joint_sentence(const StageFit& fit, bool repeated) {
    return fmt::format("{} {:.3f} mm, poses disagree with the model by {:.3f} mm: backlash, friction or load{}",
                       repeated ? "visits repeat to" : "the noise is stated as", reading_noise(fit.observation()),
                       pose_disagreement(fit), repeated ? "" : ", or more noise than is stated");
  }

  /// What the joints' standard deviation does to a coordinate of the plate, root mean square over the stations, mm.
  static double pose_disagreement(const StageFit& fit) {
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
  static double first_joint_std(const StageFit& fit) {
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

  void add_stated_noise(std::vector<Candidate>& all) const {
    if (fit_.components().stated_noise) return;
    const auto& groups = fit_.observation().groups();
    if (std::ranges::none_of(groups, &Group::stated)) return;
    const Scatter stated = detail::scatter(fit_.observation(), fit_.fit().parameters, fit_.fit().at_answer.root(),
                                           [](const Group& group) { return group.stated; });
    if (stated.redundancy < 1.0) return;
    const double ratio = stated.sum / stated.redundancy;
    all.push_back({.promised = promised_drop(ratio, stated.redundancy),
                   .begin = [ratio](StageFit& fit) { fit.seek_stated_noise(std::sqrt(ratio)); },
                   .size = [](const StageFit& fit) { return fit.observation().components().stated_noise; },
                   .say =
                       [](const StageFit&, double size) {
                         return fmt::format("the readings scatter {:.2g} times as much as their stated sigmas", size);
                       }});
  }

  void add_priors(std::vector<Candidate>& all) const {
    const std::vector<SoughtSource>& sought = fit_.observation().sought();
    const auto places = [&](const auto& chosen) {
      std::vector<std::size_t> list;
      for (std::size_t k = 0; k < sought.size(); ++k) {
        if (sought[k].prior_std && chosen(sought[k])) list.push_back(k);
      }
      return list;
    };
    const Eigen::MatrixXd covariance = fit_.covariance();
    const auto add = [&](Sentence say, double price, std::vector<std::size_t> list) {
      add_prior(all, covariance, std::move(say), price, std::move(list));
    };
    const double groups = 2.0 * std::log(3.0), kinds = 2.0 * std::log(static_cast<double>(kSourceCount)),
                 ones = 2.0 * std::log(static_cast<double>(std::max<std::size_t>(sought.size(), 1)));
    const auto times = [](std::string whose) {
      return [whose = std::move(whose)](const StageFit&, double size) {
        return fmt::format("{} {:.1f} times as large as the tolerances say", whose, size);
      };
    };
    add(times("all errors are"), groups, places([](const SoughtSource&) { return true; }));
    const Actuator actuator = fit_.observation().robot().actuator();
    add(times("the errors of the position group are"), groups,
        places([actuator](const SoughtSource& one) { return !tilts_plate(one.source, actuator); }));
    add(times("the errors of the tilt group are"), groups,
        places([actuator](const SoughtSource& one) { return tilts_plate(one.source, actuator); }));
    for (const Source source : sources_of(actuator)) {
      add(times(fmt::format("{} of all limbs is", name(source, actuator))), kinds,
          places([source](const SoughtSource& one) { return one.source == source; }));
    }
    for (std::size_t k = 0; k < sought.size(); ++k) {
      if (!sought[k].prior_std) continue;
      const SoughtSource one = sought[k];
      add(
          [one, actuator](const StageFit&, double size) {
            return fmt::format(
                "{} of limb {} is {:.1f} standard deviations of its tolerance away from nominal: a "
                "wrong part, or a wrong tolerance",
                name(one.source, actuator), one.limb + 1, size);
          },
          ones, {k});
    }
  }

  void add_prior(std::vector<Candidate>& all, const Eigen::MatrixXd& covariance, Sentence say, double price,
                 std::vector<std::size_t> places) const {
    const std::vector<WidenedPriors>& known = fit_.components().priors;
    if (places.empty() || std::ranges::any_of(known, [&](const auto& one) { return one.places == places; })) return;
    const Scatter squares = fit_.prior_squares(places, covariance);
    const double ratio = squares.redundancy > 0.0 ? squares.sum / squares.redundancy : 0.0;
    all.push_back({.promised = promised_drop(ratio, squares.redundancy),
                   .price = price,
                   .begin = [places, start = std::sqrt(std::max(ratio, 1.0))](
                                StageFit& fit) { fit.seek_wider_priors(places, start); },
                   .size = [](const StageFit& fit) { return fit.components().priors.back().factor; },
                   .say = std::move(say)});
  }

  StageFit& fit_;
  const CalibrationOptions& options_;
};

}  // namespace

FitScatter fit_scatter(const StageFit& fit) {
  const Scatter all = fit.scatter(), visits = scatter_of_visits(fit.observation(), fit.fit().parameters);
  return {visits, {std::max(all.sum - visits.sum, 0.0), all.redundancy - visits.redundancy}};
}

std::vector<Component> find_components(StageFit& fit, const CalibrationOptions& options) {
  return Finder(fit, options).find();
}

}  // namespace paracal::detail
