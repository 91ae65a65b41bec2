#include "components.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "component_candidates.hpp"
#include "numerics/distributions.hpp"

namespace paracal::detail {
namespace {

/// A component that was admitted.
struct Admitted {
  ComponentCandidate what;
  double drop = 0.0;                     ///< of -2 log likelihood, less the price
  std::vector<std::string> equals = {};  ///< other parts that explain the readings about as well
};

/// A candidate that was tried, and what it left of the fit.
struct Trial {
  const ComponentCandidate* candidate;
  double drop;
  StageFit::State state;
};

class Finder {
 public:
  Finder(StageFit& fit, const CalibrationOptions& options) : fit_(fit), options_(options) {}

  std::vector<Component> find() {
    constexpr int kMost = 8;
    for (int round = 0; round < kMost && fit_.converged(); ++round) {
      std::vector<ComponentCandidate> candidates;
      add_noise_candidates(fit_, candidates);
      add_prior_candidates(fit_, candidates);
      if (!admit_most_telling(worth_trying(std::move(candidates)))) break;
    }
    std::vector<Component> found;
    for (const Admitted& one : admitted_) found.push_back(described(one));
    return found;
  }

 private:
  /// Tries candidates; the fit is left with the best of those that are admitted.
  bool admit_most_telling(const std::vector<ComponentCandidate>& candidates) {
    const StageFit::State before = fit_.state();
    const double likelihood = fit_.minus_twice_log_likelihood();
    std::vector<Trial> trials;
    for (const ComponentCandidate& candidate : candidates) {
      candidate.begin(fit_);
      fit_.settle();
      const double drop = likelihood - fit_.minus_twice_log_likelihood() - candidate.price;
      if (fit_.converged() && drop > options_.admit_drop) trials.push_back({&candidate, drop, fit_.state()});
      fit_.restore(before);
    }
    if (trials.empty()) return false;
    const auto best = std::ranges::max_element(trials, {}, &Trial::drop);
    fit_.restore(best->state);
    admitted_.push_back({*best->candidate, best->drop, equals_of(*best, trials)});
    return true;
  }

  /// Of two parts of which one is less probable by a factor of 20 nobody can say that it is the other.
  static std::vector<std::string> equals_of(const Trial& best, const std::vector<Trial>& trials) {
    constexpr double kEqual = 6.0;  // 2 log 20
    std::vector<std::string> equals;
    if (!best.candidate->names_part()) return equals;
    for (const Trial& one : trials) {
      const bool other = one.candidate != best.candidate && one.candidate->names_part();
      if (other && one.drop > best.drop - kEqual) equals.push_back(one.candidate->subject);
    }
    return equals;
  }

  /// A variance that may only grow: half the probability that a chi-square of one degree of freedom is larger
  /// [self-liang1987].
  Component described(const Admitted& one) const {
    const double chance = normal_probability(-std::sqrt(one.drop));
    const double size = one.what.size(fit_);
    std::string text = one.what.say(fit_, size);
    if (!one.equals.empty()) {
      text +=
          fmt::format(". {} would explain the readings equally well: measure the parts", fmt::join(one.equals, " or "));
    }
    return {std::move(text), size, one.drop, chance, chance < options_.tell_chance};
  }

  StageFit& fit_;
  const CalibrationOptions& options_;
  std::vector<Admitted> admitted_ = {};
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
