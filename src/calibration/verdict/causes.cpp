#include "causes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <utility>

#include "numerics/distributions.hpp"
#include "paracal/units.hpp"

namespace paracal::detail {
namespace {

std::string far_text(std::string_view subject, double deviations) {
  return fmt::format(
      "{} is {:.1f} standard deviations of its tolerance away from nominal: check the part and the tolerance", subject,
      deviations);
}

class Causes {
 public:
  Causes(const StageFit& fit, const CalibrationOptions& options, const VarianceTable& table,
         const VariancePosterior& posterior, std::vector<Component>& all)
      : fit_(fit),
        options_(options),
        table_(table),
        posterior_(posterior),
        all_(all),
        repeats_(table.noise_of_visits().has_value()),
        noise_(reading_noise(fit.observation()) * posterior.noise_factor(table)) {}

  void add_open_facts(const std::vector<SuspectedFact>& facts, const std::vector<WeighedTable>& tables) {
    if (facts.empty()) return;
    std::vector<std::size_t> order(facts.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, std::greater{}, [&](std::size_t k) { return tables[k + 1].probability; });
    std::vector<std::string> each;
    each.reserve(order.size());
    for (const std::size_t k : order) {
      each.push_back(fmt::format("{} ({:.0f} %)", facts[k].subject, 100.0 * tables[k + 1].probability));
    }
    add(Cause::parts, 1.0 - tables.front().probability,
        fmt::format("{} is far outside its tolerance, or wrong. The readings cannot tell which: measure the parts",
                    fmt::join(each, " or ")));
  }

  void add_visits() {
    const std::vector<std::size_t> terms = table_.terms_of(Spreads::visits);
    if (!repeats_) return;
    add(Cause::visits, posterior_.probability_above(terms, large(options_.discrepancies.visits)),
        fmt::format("the machine does not repeat: {} stops elsewhere at each visit. Possible causes: play, friction, a "
                    "loose joint",
                    joint(largest(terms))));
  }

  /// Noise or joints: a single visit of each pose shows their sum.
  void add_ambiguous_noise() {
    if (table_.tells_noise()) return;
    const double entered = fit_.observation().components().unstated_noise;
    double probability = 0.0;
    for (const std::size_t term : table_.terms_of(Spreads::noise)) {
      probability = std::max(probability, posterior_.probability_above({term}, options_.noise_to_tell / entered));
    }
    add(Cause::noise, probability,
        fmt::format("the readings scatter {:.2g} mm, {:.1f} times what was expected of them. This is noise, or joints "
                    "stop elsewhere at each visit: U includes both. Visit each pose twice to tell",
                    noise_, entered * posterior_.largest(table_.terms_of(Spreads::noise))));
  }

  void add_poses() {
    if (!table_.tells_noise()) return;
    std::vector<std::size_t> terms = table_.terms_of(Spreads::poses);
    const auto joints = static_cast<double>(terms.size());
    double squares = 0.0;
    for (const std::size_t term : terms) squares += std::pow(posterior_.size(term), 2);
    // Where no pose was visited twice, nothing tells the one from the other.
    if (!repeats_) std::ranges::copy(table_.terms_of(Spreads::visits), std::back_inserter(terms));
    add(Cause::motion, posterior_.probability_above(terms, std::max(options_.discrepancies.drives, 0.5 * noise_)),
        fmt::format("the poses differ from the model by {:.3f} mm more than the noise explains ({} {:.3f} mm), most by "
                    "{}. Possible causes: backlash, friction{}",
                    std::sqrt(squares / joints),
                    repeats_                                  ? "repeatability"
                    : table_.terms_of(Spreads::noise).empty() ? "stated noise"
                                                              : "estimated noise",
                    noise_, joint(largest(terms)), repeats_ ? " or load" : ", load or larger noise"));
  }

  void add_drives() {
    const std::vector<std::size_t> terms = table_.terms_of(Spreads::drives);
    add(Cause::motion, posterior_.probability_above(terms, large(options_.discrepancies.drives)),
        fmt::format("the drives are uneven along their stroke by {:.2g} mm at the plate. Possible causes: encoder, "
                    "belt, load or temperature",
                    posterior_.size(terms.front())));
  }

  /// Errors that are far outside their tolerances, whatever else is; not where a cause names parts.
  void add_far_errors() {
    constexpr double kFar = 4.0;  // standard deviations of a tolerance
    if (std::ranges::find(all_, Cause::parts, &Component::cause) != all_.end()) return;
    const Observation& observation = fit_.observation();
    for (Eigen::Index k = 0; k < observation.source_count(); ++k) {
      const SoughtSource& one = observation.sought()[static_cast<std::size_t>(k)];
      if (!one.prior_std) continue;
      const double value = std::abs(fit_.fit().parameters(observation.nuisance_count() + k));
      const double beyond = value - kFar * *one.prior_std;
      add(Cause::parts, normal_probability(beyond / std::sqrt(posterior_.covariance(k, k))),
          far_text(fmt::format("{} of limb {}", name(one.source), one.limb + 1), value / *one.prior_std));
    }
  }

  void add_tolerances(Spreads what) {
    constexpr double kLarger = 1.5;  // a tolerance that is larger by less is hardly another
    for (const std::size_t term : table_.terms_of(what)) {
      add(Cause::parts, posterior_.probability_above({term}, kLarger), text_of_group(what, posterior_.size(term)));
    }
  }

  void add_stated_noise() {
    constexpr double kLarger = 1.2;
    for (const std::size_t term : table_.terms_of(Spreads::stated_noise)) {
      add(Cause::noise, posterior_.probability_above({term}, kLarger),
          fmt::format("the readings scatter {:.2g} times as much as their stated sigmas", posterior_.size(term)));
    }
  }

 private:
  void add(Cause cause, double probability, std::string text) {
    if (probability < 0.5) return;
    all_.push_back({cause, std::move(text), probability, probability > 1.0 - options_.largest_doubt});
  }

  /// What is worth a name, mm at the plate.
  double large(double expected) const { return std::max({10.0 * expected, options_.discrepancies.drives, noise_}); }

  std::size_t largest(const std::vector<std::size_t>& terms) const {
    return *std::ranges::max_element(terms, {}, [&](std::size_t k) { return posterior_.size(k); });
  }

  /// "the joint of limb 2 (standard deviation 0.02 deg, 0.17 mm at the plate)"
  std::string joint(std::size_t term) const {
    const Unit unit = joint_unit(fit_.observation().robot().actuator());
    const Eigen::Index limb = table_.terms()[term].joint;
    return fmt::format("{} (standard deviation {:.2g} {}, {:.2g} mm at the plate)",
                       limb < 0 ? "each joint" : fmt::format("the joint of limb {}", limb + 1),
                       to_file_unit(unit, table_.readings().joint_per_mm * posterior_.size(term)), file_unit(unit),
                       posterior_.size(term));
  }

  const StageFit& fit_;
  const CalibrationOptions& options_;
  const VarianceTable& table_;
  const VariancePosterior& posterior_;
  std::vector<Component>& all_;
  bool repeats_;
  double noise_;  ///< of the readings, mm
};

}  // namespace

std::string text_of(const SuspectedFact& one, double noise) {
  if (one.fact.pose) {
    return fmt::format(
        "all readings of {} are off by about {:.2g} mm and are excluded. Check what was commanded and written there",
        one.subject, one.off * noise);
  }
  if (one.fact.errors.size() == 1) return far_text(one.subject, one.fact.factor);
  return fmt::format("{} are {:.1f} times as large as the tolerances: check them", one.subject, one.fact.factor);
}

std::string text_of_group(Spreads what, double factor) {
  return fmt::format("the errors of the {} group are {:.1f} times as large as the tolerances: check them",
                     what == Spreads::positions ? "position" : "tilt", factor);
}

void add_causes(const StageFit& fit, const CalibrationOptions& options, const std::vector<SuspectedFact>& facts,
                const std::vector<WeighedTable>& tables, const VariancePosterior& posterior,
                std::vector<Component>& causes) {
  Causes all(fit, options, tables.front().table, posterior, causes);
  all.add_open_facts(facts, tables);
  all.add_visits();
  all.add_ambiguous_noise();
  all.add_poses();
  all.add_drives();
  all.add_far_errors();
  all.add_tolerances(Spreads::positions);
  all.add_tolerances(Spreads::tilts);
  all.add_stated_noise();
  std::ranges::stable_sort(causes, std::greater{}, &Component::probability);
}

}  // namespace paracal::detail
