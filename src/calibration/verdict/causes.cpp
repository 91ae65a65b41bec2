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

std::string subjects_of(const FoundOrder& found) {
  std::string subjects = found.effect.subject;
  for (const std::string& other : found.others) subjects += " or " + other;
  return subjects;
}

/// The half-width of each joint's play by the direction of its motion.
std::string text_of_backlash(const FoundOrder& found, const Observation& observation) {
  const Unit unit = joint_unit(observation.robot().actuator());
  const Eigen::VectorXd halves = found.half_widths(static_cast<Eigen::Index>(observation.robot().limb_count()));
  std::vector<std::string> widths;
  for (const OrderEffect::Direction& one : found.effect.directions) {
    widths.push_back(fmt::format("{:.2g}", to_file_unit(unit, 2.0 * halves(one.front().first))));
  }
  return fmt::format(
      "{} stops elsewhere by the direction of its motion: backlash {} {}. The calibrated machine is the mean of both "
      "directions, and U of a single visit includes the rest. Approach every pose from the same side",
      found.effect.subject, fmt::join(widths, ", "), file_unit(unit));
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
        noise_of_series_(posterior.noise_of_series(table)),
        noise_(reading_noise(fit.observation(), noise_of_series_)) {}

  /// Sets of facts, of which one is so: what each is, and which reading would decide.
  void add_open_facts(const Trials& trials) {
    if (trials.sets.empty()) return;
    std::vector<std::size_t> order(trials.sets.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, std::greater{}, [&](std::size_t k) { return trials.tables[k + 1].probability; });
    std::vector<std::string> each;
    bool parts = false, others = false;
    for (const std::size_t k : order) {
      std::vector<std::string> subjects;
      for (const std::size_t fact : trials.sets[k].facts) {
        subjects.push_back(trials.facts[fact].subject);
        (trials.facts[fact].fact.errors.empty() ? others : parts) = true;
      }
      each.push_back(
          fmt::format("{} ({:.0f} %)", fmt::join(subjects, " and "), 100.0 * trials.tables[k + 1].probability));
    }
    add(parts ? Cause::parts : cause_of(trials.facts[trials.sets[order.front()].facts.front()].fact),
        1.0 - trials.tables.front().probability,
        fmt::format("{} is {}. The readings cannot tell which: measure {}", fmt::join(each, " or "),
                    !others  ? "far outside its tolerance"
                    : !parts ? "not as stated"
                             : "far outside its tolerance, or wrong",
                    !others  ? "the parts"
                    : !parts ? "these again"
                             : "the parts, and these poses again"));
  }

  void add_visits() {
    const std::vector<std::size_t> terms = table_.terms_of(Spreads::visits);
    if (!repeats_) return;
    add(Cause::visits,
        posterior_.probability_above(terms, std::max({options_.causes.visits * options_.discrepancies.visits,
                                                      options_.discrepancies.drives, noise_})),
        fmt::format("the machine does not repeat: {} stops elsewhere at each visit, {:.2g} mm at the plate. Possible "
                    "causes: play, friction, a loose joint",
                    joint(largest(terms)), of_joints(terms)));
  }

  /// Noise or joints: a single visit of each pose shows their sum.
  void add_ambiguous_noise() {
    if (table_.tells_noise()) return;
    double probability = 0.0;
    for (const std::size_t term : table_.terms_of(Spreads::noise)) {
      const double entered = table_.entered()[static_cast<std::size_t>(table_.terms()[term].joint)].unstated;
      probability = std::max(probability, posterior_.probability_above({term}, options_.noise_to_tell / entered));
    }
    add(Cause::noise, probability,
        fmt::format("the readings scatter {:.2g} mm, {:.1f} times what was expected of them. This is noise, or joints "
                    "stop elsewhere at each visit: U includes both. Visit each pose twice to tell",
                    noise_, largest_unstated(noise_of_series_)));
  }

  void add_poses() {
    if (!table_.tells_noise()) return;
    std::vector<std::size_t> terms = table_.terms_of(Spreads::poses);
    // Where no pose was visited twice, nothing tells the one from the other.
    if (!repeats_) std::ranges::copy(table_.terms_of(Spreads::visits), std::back_inserter(terms));
    add(Cause::motion,
        posterior_.probability_above(terms, std::max(options_.discrepancies.drives, options_.causes.poses * noise_)),
        fmt::format("the poses differ from the model by {:.2g} mm more than the noise explains ({} {:.3f} mm), most by "
                    "{}. Possible causes: backlash, friction{}",
                    of_joints(terms),
                    repeats_                         ? "repeatability"
                    : all_stated(fit_.observation()) ? "stated noise"
                                                     : "estimated noise",
                    noise_, joint(largest(terms)), repeats_ ? " or load" : ", load or larger noise"));
  }

  /// Less than that beside the noise of one visit, a sound machine shows now and then.
  void add_drives() {
    const std::vector<std::size_t> terms = table_.terms_of(Spreads::drives);
    add(Cause::motion,
        posterior_.probability_above(terms, std::max(options_.causes.drives * options_.discrepancies.drives,
                                                     options_.causes.drives_over_noise * noise_)),
        fmt::format("the drives are uneven along their stroke by {:.2g} mm at the plate. Possible causes: encoder, "
                    "belt, load or temperature",
                    posterior_.size(terms.front())));
  }

  /// Errors that are far outside their tolerances, whatever else is; not where a cause names parts.
  void add_far_errors() {
    if (std::ranges::find(all_, Cause::parts, &Component::cause) != all_.end()) return;
    const Observation& observation = fit_.observation();
    for (Eigen::Index k = 0; k < observation.source_count(); ++k) {
      const SoughtSource& one = observation.sought()[static_cast<std::size_t>(k)];
      if (!one.prior_std) continue;
      const double value = std::abs(fit_.fit().parameters(observation.nuisance_count() + k));
      const double beyond = value - options_.causes.error * *one.prior_std;
      add(Cause::parts, normal_probability(beyond / std::sqrt(posterior_.covariance(k, k))),
          far_text(fmt::format("{} of limb {}", name(one.source), one.limb + 1), value / *one.prior_std));
    }
  }

  void add_tolerances(Spreads what) {
    for (const std::size_t term : table_.terms_of(what)) {
      add(Cause::parts, posterior_.probability_above({term}, options_.causes.tolerances),
          text_of_group(what, posterior_.size(term)));
    }
  }

  void add_stated_noise() {
    for (const std::size_t term : table_.terms_of(Spreads::stated_noise)) {
      add(Cause::noise, posterior_.probability_above({term}, options_.causes.stated_noise),
          fmt::format("the readings scatter {:.2g} times as much as their stated sigmas", posterior_.size(term)));
    }
  }

 private:
  void add(Cause cause, double probability, std::string text) {
    if (probability < 0.5) return;
    all_.push_back({cause, std::move(text), probability, probability > 1.0 - options_.largest_doubt});
  }

  std::size_t largest(const std::vector<std::size_t>& terms) const {
    return *std::ranges::max_element(terms, {}, [&](std::size_t k) { return posterior_.size(k); });
  }

  /// Root mean square of what joints do at the plate, mm: a term of all alike, or of one of them.
  double of_joints(const std::vector<std::size_t>& terms) const {
    const auto joints = static_cast<double>(fit_.observation().robot().limb_count());
    double squares = 0.0;
    for (const std::size_t term : terms) {
      squares += std::pow(posterior_.size(term), 2) / (table_.terms()[term].joint < 0 ? 1.0 : joints);
    }
    return std::sqrt(squares);
  }

  /// "the joint of limb 2 (standard deviation 0.02 deg)"
  std::string joint(std::size_t term) const {
    const Unit unit = joint_unit(fit_.observation().robot().actuator());
    const Eigen::Index limb = table_.terms()[term].joint;
    return fmt::format("{} (standard deviation {:.2g} {})",
                       limb < 0 ? "each joint" : fmt::format("the joint of limb {}", limb + 1),
                       to_file_unit(unit, table_.readings().joint_per_mm * posterior_.size(term)), file_unit(unit));
  }

  const StageFit& fit_;
  const CalibrationOptions& options_;
  const VarianceTable& table_;
  const VariancePosterior& posterior_;
  std::vector<Component>& all_;
  bool repeats_;
  NoiseOfSeries noise_of_series_;
  double noise_;  ///< of the readings, mm
};

}  // namespace

Cause cause_of(const Fact& fact) {
  if (fact.pose) return Cause::pose;
  if (fact.mount) return Cause::reflector;
  return fact.series ? Cause::noise : Cause::parts;
}

std::string text_of(const Trials& trials, std::size_t fact, double noise) {
  const SuspectedFact& one = trials.facts[fact];
  const double size = trials.size(fact);
  if (one.fact.pose) {
    return fmt::format(
        "all readings of {} are off by about {:.2g} mm and are excluded. Check what was commanded and written there",
        one.subject, trials.off(fact) * noise);
  }
  if (one.fact.mount) {
    return fmt::format("{}, by about {:.2g} mm: its place is estimated. Centre it", one.subject, trials.off(fact));
  }
  if (one.fact.series) {
    return fmt::format(
        "{} scatter {:.2g} times as much as their stated sigmas, and count as much less: check the "
        "instrument",
        one.subject, std::hypot(1.0, size));
  }
  if (one.fact.errors.size() == 1) return far_text(one.subject, size);
  return fmt::format("{} are {:.1f} times as large as the tolerances: check them", one.subject, size);
}

Cause cause_of(const FoundOrder& found) { return found.effect.by == OrderedBy::sides ? Cause::backlash : Cause::drift; }

std::string text_of_open(const FoundOrder& found) {
  return fmt::format("{} {}. U includes it with this probability: visit every pose once, then again, to tell",
                     subjects_of(found),
                     found.effect.by == OrderedBy::sides ? "stops elsewhere by the direction of its motion"
                                                         : "drifts along the order of the readings");
}

std::string text_of(const FoundOrder& found, const Observation& observation) {
  const OrderEffect& effect = found.effect;
  if (effect.by == OrderedBy::sides) return text_of_backlash(found, observation);
  const std::string drifts =
      fmt::format("{} drifts along the order of the readings and moves them by up to {:.2g} mm from their mean",
                  subjects_of(found), found.largest);
  if (effect.by == OrderedBy::set_up) {
    return drifts + ". The readings are corrected. Fix the instrument, and read home now and then";
  }
  return drifts +
         ". The calibrated machine is that of the mean time, and U includes the drift. Possible cause: temperature. "
         "Warm up the machine before the measurement";
}

std::string text_of_group(Spreads what, double factor) {
  return fmt::format("the errors of the {} group are {:.1f} times as large as the tolerances: check them",
                     what == Spreads::positions ? "position" : "tilt", factor);
}

void add_causes(const StageFit& fit, const CalibrationOptions& options, const Trials& trials,
                const VariancePosterior& posterior, std::vector<Component>& causes) {
  Causes all(fit, options, trials.tables.front().table, posterior, causes);
  all.add_open_facts(trials);
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
