#include "explanation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "facts.hpp"
#include "numerics/distributions.hpp"

namespace paracal::detail {
namespace {

class Explainer {
 public:
  Explainer(StageFit& fit, const Measurements& measurements, const CalibrationOptions& options)
      : fit_(fit),
        measurements_(measurements),
        options_(options),
        drives_(drive_splines(fit.observation().robot(), measurements.stations, options.discrepancies.length)) {}

  std::optional<Explanation> explain() {
    constexpr int kMostFacts = 8;
    for (int facts = 0; fit_.converged(); ++facts) {
      const ReadingPlaces places(fit_.observation());
      if (places.count() == 0) return std::nullopt;
      const std::size_t stride = stride_of(places);
      const LinearReadings readings = linear_readings(fit_, places, stride, drives_);
      std::vector<WeighedTable> tables{weighed(VarianceTable(fit_, readings, drives_, options_.discrepancies))};
      if (!std::isfinite(tables.front().mode.log_evidence)) return std::nullopt;  // something is left open
      std::vector<SuspectedFact> suspected = trials(tables);
      if (facts < kMostFacts && adopt(suspected, tables)) continue;
      leave_out_improbable(suspected, tables);
      log_evidence_ = stride == 1 ? of_every_reading(readings, tables.front().mode.log_evidence)
                                  : std::numeric_limits<double>::quiet_NaN();
      return described(stride == 1 ? averaged(tables) : of_all(fit_, places, drives_, tables.front()), suspected,
                       tables);
    }
    return std::nullopt;
  }

 private:
  static std::size_t stride_of(const ReadingPlaces& places) {
    constexpr std::size_t kMostRows = 240;  // of a table: more tell variances no better, and cost their cube
    constexpr std::size_t kRows = 3;        // of a place, about
    return (places.count() * kRows + kMostRows - 1) / kMostRows;
  }

  static WeighedTable weighed(VarianceTable table) {
    VarianceTable::Mode mode = table.mode();
    return {std::move(table), std::move(mode)};
  }

  /// The evidence of the means and the scatter of the readings in use as one of every reading, in units of its standard
  /// deviation before any factor: n visits of r rows have a density smaller by n^(r / 2). Those that are left out are
  /// gross: one in 1000, and anywhere within 10 mm.
  double of_every_reading(const LinearReadings& readings, double log_evidence) const {
    constexpr double kGrossShare = 1e-3, kGrossRange = 20.0;  // mm
    const Observation& observation = fit_.observation();
    for (const ReadingBlock& one : readings.blocks) {
      log_evidence -= 0.5 * static_cast<double>(one.by_joint.rows()) * std::log(one.visits);
    }
    observation.check_each(fit_.fit().parameters, [&](std::size_t g, const Eigen::MatrixXd& rows) {
      const Group& group = observation.groups()[g];
      const auto count = static_cast<double>(rows.rows());
      if (!group.active) {
        log_evidence += std::log(kGrossShare) - count * std::log(kGrossRange / observation.sigma_of(group));
        return;
      }
      log_evidence -= count * (0.5 * std::log(2.0 * std::numbers::pi) + std::log(observation.noise_factor(group)));
      log_evidence -=
          static_cast<double>(observation.orientation_rows(group)) * std::log(observation.orientation_factor(group));
    });
    return log_evidence;
  }

  /// Adds tables of the likeliest facts behind that of none, with their probabilities.
  /// @returns the facts of these tables.
  std::vector<SuspectedFact> trials(std::vector<WeighedTable>& tables) const {
    constexpr std::size_t kMost = 6;
    const VarianceTable none = tables.front().table;
    std::vector<SuspectedFact> facts =
        suspected_facts(fit_, measurements_.stations, none, none.at(tables.front().mode.u, false));
    if (!options_.exclude_outliers)
      std::erase_if(facts, [](const SuspectedFact& one) { return one.fact.pose.has_value(); });
    facts.resize(std::min(facts.size(), kMost));
    std::vector<double> log_odds{0.0};
    for (const SuspectedFact& one : facts) {
      tables.push_back(weighed(none.with(one.fact)));
      log_odds.push_back(tables.back().mode.log_evidence - tables.front().mode.log_evidence + std::log(one.odds));
    }
    const double largest = std::ranges::max(log_odds);
    double sum = 0.0;
    for (double& one : log_odds) sum += one = std::exp(one - largest);
    for (std::size_t k = 0; k < tables.size(); ++k) tables[k].probability = log_odds[k] / sum;
    return facts;
  }

  /// Takes a fact to be so that is certain enough.
  bool adopt(const std::vector<SuspectedFact>& facts, const std::vector<WeighedTable>& tables) {
    for (std::size_t k = 0; k < facts.size(); ++k) {
      if (tables[k + 1].probability < 1.0 - options_.largest_doubt) continue;
      const Fact& fact = facts[k].fact;
      causes_.push_back({fact.pose ? Cause::pose : Cause::parts, text_of(facts[k]), tables[k + 1].probability, true});
      if (!fact.pose) fit_.widen_priors(fact.errors, fact.factor);
      for (Group& group : fit_.observation_to_change().groups()) {
        if (fact.pose && (group.station == *fact.pose || group.from == *fact.pose)) group.active = false;
      }
      fit_.settle();
      return true;
    }
    return false;
  }

  static void leave_out_improbable(std::vector<SuspectedFact>& facts, std::vector<WeighedTable>& tables) {
    constexpr double kImprobable = 0.01;
    for (std::size_t k = facts.size(); k-- > 0;) {
      if (tables[k + 1].probability > kImprobable) continue;
      facts.erase(facts.begin() + static_cast<std::ptrdiff_t>(k));
      tables.erase(tables.begin() + static_cast<std::ptrdiff_t>(k) + 1);
    }
    double sum = 0.0;
    for (const WeighedTable& one : tables) sum += one.probability;
    for (WeighedTable& one : tables) one.probability /= sum;
  }

  std::string text_of(const SuspectedFact& one) const {
    if (one.fact.pose) {
      return fmt::format(
          "all readings of {} are off by about {:.2g} mm and are excluded. Check what was commanded and written there",
          one.subject, one.off * reading_noise(fit_.observation()));
    }
    if (one.fact.errors.size() == 1) {
      return fmt::format(
          "{} is {:.1f} standard deviations of its tolerance away from nominal: check the part and the tolerance",
          one.subject, one.fact.factor);
    }
    return fmt::format("{} are {:.1f} times as large as the tolerances: check them", one.subject, one.fact.factor);
  }

  /// Of facts of which one is so, and nobody can say which.
  void add_open_facts(const std::vector<SuspectedFact>& facts, const std::vector<WeighedTable>& tables) {
    const double any = 1.0 - tables.front().probability;
    if (facts.empty() || any < 0.5) return;
    std::vector<std::size_t> order(facts.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, std::greater{}, [&](std::size_t k) { return tables[k + 1].probability; });
    std::vector<std::string> each;
    for (const std::size_t k : order) {
      each.push_back(fmt::format("{} ({:.0f} %)", facts[k].subject, 100.0 * tables[k + 1].probability));
    }
    causes_.push_back({Cause::parts,
                       fmt::format("{} is far outside its tolerance, or wrong. The readings cannot tell which: measure "
                                   "the parts",
                                   fmt::join(each, " or ")),
                       any, any > 1.0 - options_.largest_doubt});
  }

  Explanation described(VariancePosterior posterior, const std::vector<SuspectedFact>& facts,
                        const std::vector<WeighedTable>& tables) {
    const VarianceTable& table = tables.front().table;
    const double joint = table.readings().joint_per_mm;
    const auto limbs = static_cast<Eigen::Index>(fit_.observation().robot().limb_count());
    Explanation all{.means = std::move(posterior.errors),
                    .covariance = std::move(posterior.covariance),
                    .noise = std::move(posterior.noise),
                    .drives = drives_.knots,
                    .joint_std = Eigen::VectorXd::Zero(limbs),
                    .visit_std = Eigen::VectorXd::Zero(limbs),
                    .repeats = table.noise_of_visits().has_value(),
                    .log_evidence = log_evidence_};
    for (std::size_t k = 0; k < table.terms().size(); ++k) {
      const VarianceTerm& term = table.terms()[k];
      const double size = posterior.size(k);
      if (term.what == Spreads::noise) all.unstated_noise = std::max(all.unstated_noise, size);
      if (term.what == Spreads::stated_noise) all.stated_noise = size;
      if (term.what != Spreads::visits && term.what != Spreads::poses) continue;
      Eigen::VectorXd& squares = term.what == Spreads::visits ? all.visit_std : all.joint_std;
      const double square = std::pow(joint * size, 2);
      const Eigen::Index first = std::max<Eigen::Index>(term.joint, 0), count = term.joint < 0 ? limbs : 1;
      squares.segment(first, count).array() += square;
    }
    all.visit_std = all.visit_std.cwiseSqrt().eval();
    all.joint_std = all.joint_std.cwiseSqrt().eval();
    if (!all.repeats) {  // nothing tells the one from the other: what stays at each visit is the worse
      all.joint_std = (all.joint_std.cwiseAbs2() + all.visit_std.cwiseAbs2()).cwiseSqrt().eval();
      all.visit_std.setZero();
    }
    add_open_facts(facts, tables);
    add_discrepancies(table, posterior, all);
    std::ranges::stable_sort(causes_, std::greater{}, &Component::probability);
    all.causes = std::move(causes_);
    return all;
  }

  /// Names what is large beside the noise, and far larger than expected.
  void add_discrepancies(const VarianceTable& table, const VariancePosterior& posterior, const Explanation& all) {
    const Discrepancies& expected = options_.discrepancies;
    const double noise =
        reading_noise(fit_.observation()) * (all.unstated_noise > 0.0 ? all.unstated_noise : 1.0) * all.stated_noise;
    const auto large = [&](double scale) { return std::max({10.0 * scale, expected.drives, noise}); };
    // That all joints together exceed it, and the one that varies most.
    const auto largest = [&](const std::vector<std::size_t>& terms, double least) {
      const auto most = std::ranges::max_element(terms, {}, [&](std::size_t k) { return posterior.size(k); });
      return terms.empty() ? std::pair<double, std::size_t>()
                           : std::pair(posterior.probability_above(terms, least), *most);
    };
    const auto add = [&](Cause cause, double probability, std::string text) {
      if (probability < 0.5) return;
      causes_.push_back({cause, std::move(text), probability, probability > 1.0 - options_.largest_doubt});
    };
    const Unit unit = joint_unit(fit_.observation().robot().actuator());
    const auto joint = [&](std::size_t term) {
      const double size = table.readings().joint_per_mm * posterior.size(term);
      const Eigen::Index limb = table.terms()[term].joint;
      return fmt::format("{} (standard deviation {:.2g} {}, {:.2g} mm at the plate)",
                         limb < 0 ? "each joint" : fmt::format("the joint of limb {}", limb + 1),
                         to_file_unit(unit, size), file_unit(unit), posterior.size(term));
    };
    const bool repeats = table.noise_of_visits().has_value();
    std::vector<std::size_t> poses = table.terms_of(Spreads::poses);
    if (!repeats) std::ranges::copy(table.terms_of(Spreads::visits), std::back_inserter(poses));  // which are alike
    if (const auto [probability, term] = largest(table.terms_of(Spreads::visits), large(expected.visits)); repeats) {
      add(Cause::visits, probability,
          fmt::format(
              "the machine does not repeat: {} stops elsewhere at each visit. Possible causes: play, friction, a "
              "loose joint",
              joint(term)));
    }
    if (const auto [probability, term] = largest(poses, std::max(expected.drives, 0.5 * noise)); probability > 0.0) {
      add(Cause::motion, probability,
          fmt::format(
              "the poses differ from the model by {:.3f} mm more than the noise explains ({} {:.3f} mm), most by "
              "{}. Possible causes: backlash, friction{}",
              disagreement(table, posterior), repeats ? "repeatability" : "stated noise", noise, joint(term),
              repeats ? " or load" : ", load or larger noise"));
    }
    if (const auto [probability, term] = largest(table.terms_of(Spreads::drives), large(expected.drives));
        probability > 0.0) {
      add(Cause::motion, probability,
          fmt::format(
              "the drives are uneven along their stroke by {:.2g} mm at the plate. Possible causes: encoder, belt, "
              "load or temperature",
              posterior.size(term)));
    }
    if (std::ranges::find(causes_, Cause::parts, &Component::cause) == causes_.end()) add_far_errors(all);
    add_tolerances(table, posterior);
    add_noise(table, posterior);
  }

  /// Errors that are certainly far outside their tolerances, whatever else is.
  void add_far_errors(const Explanation& all) {
    constexpr double kFar = 4.0;  // standard deviations of a tolerance
    const Observation& observation = fit_.observation();
    for (Eigen::Index k = 0; k < observation.source_count(); ++k) {
      const SoughtSource& one = observation.sought()[static_cast<std::size_t>(k)];
      if (!one.prior_std) continue;
      const double value = std::abs(fit_.fit().parameters(observation.nuisance_count() + k));
      const double probability = normal_probability((value - kFar * *one.prior_std) / std::sqrt(all.covariance(k, k)));
      if (probability < 0.5) continue;
      causes_.push_back({Cause::parts,
                         fmt::format("{} of limb {} is {:.1f} standard deviations of its tolerance away from nominal: "
                                     "check the part and the tolerance",
                                     name(one.source), one.limb + 1, value / *one.prior_std),
                         probability, probability > 1.0 - options_.largest_doubt});
    }
  }

  /// Of joints at each pose together, mm.
  static double disagreement(const VarianceTable& table, const VariancePosterior& posterior) {
    double squares = 0.0, joints = 0.0;
    for (std::size_t k = 0; k < table.terms().size(); ++k) {
      if (table.terms()[k].what != Spreads::poses) continue;
      squares += std::pow(posterior.size(k), 2);
      ++joints;
    }
    return std::sqrt(squares / std::max(joints, 1.0));
  }

  void add_tolerances(const VarianceTable& table, const VariancePosterior& posterior) {
    constexpr double kLarger = 1.5;  // a tolerance that is larger by less is hardly another
    const auto add = [&](Spreads what, const char* whose) {
      for (std::size_t k = 0; k < table.terms().size(); ++k) {
        const double probability = table.terms()[k].what == what ? posterior.probability_above({k}, kLarger) : 0.0;
        if (probability < 0.5) continue;
        causes_.push_back(
            {Cause::parts,
             fmt::format("the errors of the {} group are {:.1f} times as large as the tolerances: check them", whose,
                         posterior.size(k)),
             probability, probability > 1.0 - options_.largest_doubt});
      }
    };
    add(Spreads::positions, "position");
    add(Spreads::tilts, "tilt");
  }

  void add_noise(const VarianceTable& table, const VariancePosterior& posterior) {
    constexpr double kLarger = 1.2;
    for (std::size_t k = 0; k < table.terms().size(); ++k) {
      if (table.terms()[k].what != Spreads::stated_noise) continue;
      const double probability = posterior.probability_above({k}, kLarger);
      if (probability < 0.5) return;
      causes_.push_back(
          {Cause::noise,
           fmt::format("the readings scatter {:.2g} times as much as their stated sigmas", posterior.size(k)),
           probability, probability > 1.0 - options_.largest_doubt});
    }
  }

  StageFit& fit_;
  const Measurements& measurements_;
  const CalibrationOptions& options_;
  DriveSplines drives_;
  std::vector<Component> causes_;
  double log_evidence_ = 0.0;
};

}  // namespace

namespace {

/// Where joints stand elsewhere at each pose by more than the noise, the fit weighs its readings by both.
void weigh_joints(StageFit& fit, const Explanation& found) {
  const bool told =
      std::ranges::any_of(found.causes, [](const Component& one) { return one.told && one.cause == Cause::motion; });
  if (!told) return;
  Observation& observation = fit.observation_to_change();
  const double before = observation.components().unstated_noise;
  observation.let_joints_err(found.joint_std);
  if (found.unstated_noise > 0.0) observation.components().unstated_noise *= found.unstated_noise;
  fit.solve();
  if (fit.converged()) return;
  observation.let_joints_err({});
  observation.components().unstated_noise = before;
  fit.solve();
}

}  // namespace

FitScatter fit_scatter(const StageFit& fit) {
  const Scatter all = fit.scatter(), visits = scatter_of_visits(fit.observation(), fit.fit().parameters);
  return {visits, {std::max(all.sum - visits.sum, 0.0), all.redundancy - visits.redundancy}};
}

std::optional<Explanation> explained(StageFit& fit, const Measurements& measurements,
                                     const CalibrationOptions& options) {
  std::optional<Explanation> found = Explainer(fit, measurements, options).explain();
  if (!found) return found;
  weigh_joints(fit, *found);
  const Eigen::Index n = found->noise.rows();
  Eigen::VectorXd off = found->means;
  off.head(n) -= fit.fit().parameters.tail(n);
  found->covariance += off * off.transpose();
  return found;
}

}  // namespace paracal::detail
