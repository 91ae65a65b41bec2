#include "explanation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "calibration/variances/drive_choice.hpp"
#include "calibration/variances/order_effects.hpp"
#include "causes.hpp"
#include "numerics/distributions.hpp"
#include "sticking.hpp"

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
      WeighedTable none = weighed(table_of(readings));
      const double evidence = none.mode.log_evidence;
      if (!std::isfinite(evidence)) return std::nullopt;  // something is left open
      if (facts < kMostFacts && weigh_series(none)) continue;
      SuspectedFacts suspected = suspected_facts(fit_, measurements_, options_, none.table, none.mode.u);
      const std::optional<FoundOrder> order = best_order(fit_, none);
      Trials trials = trials_of(std::move(none), std::move(suspected));
      if (facts < kMostFacts && order && order->log_odds > trials.log_odds() && adopt(*order)) continue;
      open_order_ = order && order->probability() >= 0.5 ? order : std::nullopt;
      if (facts < kMostFacts && (adopt(trials) || (!mount_ && widen_group(trials.tables.front())))) continue;
      if (mount_) {
        return Explanation{.known = {.components = std::move(causes_)},
                           .log_evidence = of_every_reading(readings, evidence),
                           .mount = mount_};
      }
      trials.omit_improbable();
      if (stride > 1) {
        constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
        return described(of_all(fit_, places, drives_, trials.tables.front()), trials, kUnknown);
      }
      return described(averaged(trials.tables), trials, of_every_reading(readings, evidence));
    }
    return std::nullopt;
  }

 private:
  static std::size_t stride_of(const ReadingPlaces& places) {
    constexpr std::size_t kMostRows = 240;  // of a table: more tell variances no better, and cost their cube
    constexpr std::size_t kRows = 3;        // of a place, about
    return (places.count() * kRows + kMostRows - 1) / kMostRows;
  }

  /// The sizes of what was taken off the readings are not exact.
  VarianceTable table_of(const LinearReadings& readings) const {
    VarianceTable table(fit_, readings, drives_, options_.discrepancies);
    for (const FoundOrder& one : orders_) table.add_effect(on_means(one.effect, readings), one.size());
    return table;
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

  /// Series whose noise nobody stated enter by what each of them scatters: by one factor for all the better ones would
  /// count too little.
  bool weigh_series(const WeighedTable& none) {
    constexpr double kAlike = 1.25;
    const std::vector<std::size_t> terms = none.table.terms_of(Spreads::noise);
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    const auto factor = [&](std::size_t term) { return std::exp(none.mode.u(static_cast<Eigen::Index>(term))); };
    for (const std::size_t term : terms) {
      least = std::min(least, factor(term));
      most = std::max(most, factor(term));
    }
    if (!(most > kAlike * least)) return false;
    for (const std::size_t term : terms) noise_of(none.table.terms()[term].joint).unstated *= factor(term) / least;
    fit_.settle();
    return true;
  }

  SeriesNoise& noise_of(Eigen::Index series) {
    return fit_.observation_to_change().noise()[static_cast<std::size_t>(series)];
  }

  /// Takes what goes with the order off the readings, where it is certain enough.
  bool adopt(const FoundOrder& found) {
    if (found.probability() < 1.0 - options_.largest_doubt) return false;
    causes_.push_back({cause_of(found), text_of(found, fit_.observation()), found.probability(), true});
    take_off(found, fit_);
    orders_.push_back(found);
    fit_.settle();
    return true;
  }

  /// Takes facts to be so that are certain enough.
  bool adopt(const Trials& trials) {
    bool any = false;
    const double noise = reading_noise(fit_.observation());
    for (const std::size_t k : trials.certain(1.0 - options_.largest_doubt)) {
      const Fact& fact = trials.facts[k].fact;
      Component cause{cause_of(fact), text_of(trials, k, noise), trials.probability(k), true};
      if (fact.mount) {  // its place is one more unknown of another fit, which explains the rest
        causes_ = {std::move(cause)};
        mount_ = fact.mount;
        return false;
      }
      causes_.push_back(std::move(cause));
      adopt(fact, trials.size(k));
      any = true;
    }
    if (any) fit_.settle();
    return any;
  }

  void adopt(const Fact& fact, double size) {
    Observation& observation = fit_.observation_to_change();
    if (fact.series) {
      noise_of(static_cast<Eigen::Index>(*fact.series)).stated *= std::hypot(1.0, size);
    } else if (fact.pose) {
      for (Group& group : observation.groups()) {
        if (group.station != *fact.pose && group.from != *fact.pose) continue;
        group.active = false;
        group.at_wrong_pose = true;
      }
    } else {
      fit_.widen_priors(fact.errors, size);
    }
  }

  /// Takes the tolerances of a group for as many times larger as the readings show, where they are far too small: a fit
  /// that keeps to them explains nothing. Below that the readings outweigh them.
  bool widen_group(const WeighedTable& none) {
    if (none.probability < options_.largest_doubt) return false;  // single facts explain more
    for (const Spreads what : {Spreads::positions, Spreads::tilts}) {
      for (const std::size_t term : none.table.terms_of(what)) {
        const auto at = static_cast<Eigen::Index>(term);
        const double factor = std::exp(none.mode.u(at));
        const double probability = normal_probability(std::log(factor) * std::sqrt(none.mode.curvature(at, at)));
        const bool is_so = factor >= options_.causes.far_too_small && factor <= options_.causes.other_machine &&
                           probability >= 1.0 - options_.largest_doubt;
        if (!is_so) continue;
        causes_.push_back({Cause::parts, text_of_group(what, factor), probability, true});
        const std::vector<Eigen::Index>& places = none.table.terms()[term].places;
        fit_.widen_priors(std::vector<std::size_t>(places.begin(), places.end()), factor);
        fit_.settle();
        return true;
      }
    }
    return false;
  }

  /// Standard deviation of each joint by its own term and that of all alike.
  Eigen::VectorXd of_joints(Spreads what, const VarianceTable& table, const VariancePosterior& posterior) const {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit_.observation().robot().limb_count()));
    for (const std::size_t term : table.terms_of(what)) {
      const Eigen::Index joint = table.terms()[term].joint;
      const double square = std::pow(table.readings().joint_per_mm * posterior.size(term), 2);
      squares.segment(std::max<Eigen::Index>(joint, 0), joint < 0 ? squares.size() : 1).array() += square;
    }
    return squares.cwiseSqrt();
  }

  /// Root mean square of what these terms do to a reading at any single visit, mm.
  double at_plate(const std::vector<Spreads>& kinds, const VarianceTable& table,
                  const std::function<double(std::size_t)>& std) const {
    double squares = 0.0;
    for (const Spreads what : kinds) {
      for (const std::size_t term : table.terms_of(what)) {
        squares += std::pow(std(term), 2) * table.terms()[term].trace();
      }
    }
    return reading_noise(fit_.observation()) * std::sqrt(squares / static_cast<double>(table.readings().y.size()));
  }

  Eigen::VectorXd noise_as_joints(const VarianceTable& table, const NoiseOfSeries& noise) const {
    const double mm = reading_noise(fit_.observation(), noise);
    const auto joints = static_cast<Eigen::Index>(fit_.observation().robot().limb_count());
    // One joint alone may be what scatters, and nobody knows which.
    const double alone = table.readings().joint_per_mm * std::sqrt(static_cast<double>(joints));
    return Eigen::VectorXd::Constant(joints, alone * mm);
  }

  Explanation described(VariancePosterior posterior, const Trials& trials, double log_evidence) {
    const VarianceTable& table = trials.tables.front().table;
    add_causes(fit_, options_, trials, posterior, causes_);
    if (open_order_ && open_order_->effect.by != OrderedBy::set_up) {
      causes_.push_back({cause_of(*open_order_), text_of_open(*open_order_), open_order_->probability(), false});
    }
    const NoiseOfSeries noise = posterior.noise_of_series(table);
    Explanation all{
        .known = {.noise_covariance = std::move(posterior.noise),
                  .joint_std = of_joints(Spreads::poses, table, posterior),
                  .visit_std = of_joints(Spreads::visits, table, posterior),
                  .drives = drives_.knots,
                  .omitted_poses = omitted_poses(table, trials.tables.front().mode, reading_noise(fit_.observation())),
                  .components = std::move(causes_)},
        .means = std::move(posterior.errors),
        .covariance = std::move(posterior.covariance),
        .noise = noise,
        .stated_noise = posterior.largest(table.terms_of(Spreads::stated_noise)),
        .absorbed = at_plate({Spreads::visits, Spreads::poses, Spreads::drives}, table,
                             [&](std::size_t term) { return posterior.size(term); }),
        .allowed = at_plate({Spreads::positions, Spreads::tilts}, table, [](std::size_t) { return 1.0; }),
        .repeats = table.noise_of_visits().has_value(),
        .is_ambiguous = !table.tells_noise(),
        .noise_as_joints = noise_as_joints(table, noise),
        .log_evidence = log_evidence,
        .mount = mount_};
    if (!all.repeats) {  // nothing tells the one from the other: what stays at each visit is the worse
      all.known.joint_std = (all.known.joint_std.cwiseAbs2() + all.known.visit_std.cwiseAbs2()).cwiseSqrt().eval();
      all.known.visit_std.setZero();
    }
    for (const FoundOrder& one : orders_) add_order(one, 1.0, all);
    if (open_order_) add_order(*open_order_, open_order_->probability(), all);
    return all;
  }

  /// What goes with the order, with its probability. A machine that drifts may be what it was at either end; a joint
  /// stops on either side of its mean.
  void add_order(const FoundOrder& found, double probability, Explanation& all) const {
    const Observation& observation = fit_.observation();
    Eigen::VectorXd& std = all.known.visit_std;
    std = (std.cwiseAbs2() + probability * found.half_widths(std.size()).cwiseAbs2()).cwiseSqrt().eval();
    if (found.effect.by != OrderedBy::machine) return;
    const Eigen::Index n = observation.source_count();
    const Eigen::VectorXd off = found.farthest(observation).tail(n);
    all.covariance.topLeftCorner(n, n) += probability * off * off.transpose();
  }

  StageFit& fit_;
  const Measurements& measurements_;
  const CalibrationOptions& options_;
  DriveSplines drives_;
  std::vector<Component> causes_;
  std::vector<FoundOrder> orders_;
  std::optional<FoundOrder> open_order_;  ///< more probable than not, and not certain
  std::optional<ReflectorMount> mount_;
};

/// Where joints stand elsewhere at each pose by more than the noise, the fit weighs its readings by both.
void weigh_joints(StageFit& fit, const Explanation& found) {
  const bool told = std::ranges::any_of(found.known.components,
                                        [](const Component& one) { return one.told && one.cause == Cause::motion; });
  if (!told) return;
  Observation& observation = fit.observation_to_change();
  const NoiseOfSeries before = observation.noise();
  observation.let_joints_err(found.known.joint_std);
  for (std::size_t k = 0; k < before.size(); ++k) observation.noise()[k].unstated = found.noise[k].unstated;
  fit.solve();
  if (fit.converged()) return;
  observation.let_joints_err({});
  observation.noise() = before;
  fit.solve();
}

/// A joint that stops elsewhere at some visits alone scatters less than it then stands off: U is of any visit.
void add_sticking(const StickingJoint& sticking, const Robot& robot, Posterior& known) {
  std::erase_if(known.components, [](const Component& one) { return one.cause == Cause::visits; });
  known.components.push_back({Cause::visits, text_of(sticking, robot), sticking.probability, true});
  if (!sticking.may_be_often()) return;
  double& std = known.visit_std(sticking.joint);
  std = std::max(std, sticking.size / kCoverageFactor);
}

}  // namespace

std::optional<Explanation> explained(StageFit& fit, const Measurements& measurements,
                                     const CalibrationOptions& options) {
  std::optional<Explanation> found = Explainer(fit, measurements, options).explain();
  if (!found || found->mount) return found;
  weigh_joints(fit, *found);
  Posterior& known = found->known;
  if (found->is_ambiguous) {  // not before: readings that are weighed by joints have their noise beside them
    known.joint_std = (known.joint_std.cwiseAbs2() + found->noise_as_joints.cwiseAbs2()).cwiseSqrt().eval();
  }
  if (const auto sticking = sticking_joint(fit)) add_sticking(*sticking, fit.observation().robot(), known);
  const Eigen::Index n = known.noise_covariance.rows(), splines = found->means.size() - n;
  if (known.omitted_poses && known.omitted_poses->gain() > options.discrepancies.least_gain_of_drives &&
      !DriveCurves::complaint(known.drives, found->means.tail(splines))) {
    found->with_drives = found->means.head(n);
    known.drive_sizes = found->means.tail(splines);
  }
  Eigen::VectorXd off = found->means;  // from the machine of the fit, which has no splines
  off.head(n) -= fit.fit().parameters.tail(n);
  found->covariance += off * off.transpose();
  known.covariance = found->covariance.topLeftCorner(n, n);
  known.drive_covariance = found->covariance.bottomRows(splines);
  return found;
}

}  // namespace paracal::detail
