#include "evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "calibration/fit/null_space.hpp"
#include "guided_scatter.hpp"
#include "numerics/distributions.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "posterior.hpp"
#include "verdict.hpp"

namespace paracal::detail {
namespace {

/// Root that the readings alone leave to the sought errors once frames and the like are found.
Eigen::MatrixXd projected_root(const InformationRoot& root, Eigen::Index sources) {
  return root.root().bottomRightCorner(sources, sources);
}

/// Largest errors over all series; rms and largest residual of the distances where no points were read.
PoseErrorSummary summarize_fit(const Observation& observation, const Placed& at) {
  ErrorTally tally;
  for (std::size_t s = 0; s < observation.series().size(); ++s) {
    observation.series()[s]->add_to(tally, observation.groups_of(s), at);
  }
  return tally.finished();
}

/// The same readings, with the same weights, for the nominal machine: frames and the like are all that is sought.
std::optional<Eigen::VectorXd> fit_nominal(Observation& nominal, const Observation& fitted) {
  nominal.noise() = fitted.noise();
  nominal.groups() = fitted.groups();
  nominal.let_joints_err(fitted.joint_std());
  auto unknowns = nominal.start({});
  if (!unknowns || nominal.unknown_count() == 0) return unknowns;
  return solve_least_squares(with_priors(nominal), *unknowns).parameters;
}

/// Nobody reads the residuals of a hundred thousand pairs of points, and their names would take more room than all
/// else.
constexpr std::size_t kLongestList = 20000;

/// The readings at one machine.
struct Snapshot {
  const Observation& observation;
  Placed at;
};

/// Residuals of each reading.
void list_residuals(const Finished& of, const Snapshot& before, const Snapshot& after, FitResiduals& all,
                    Remarks& remarks) {
  const std::vector<Group>& groups = of.observation().groups();
  if (groups.size() > kLongestList) {
    remarks.notes.push_back(fmt::format(
        "{} readings are too many to list: JSON and report show only statistics of their residuals", groups.size()));
    return;
  }
  for (const Group& group : groups) {
    const auto residual = [&](const Snapshot& one) { return one.observation.residual(group, one.at).reversed(); };
    of.observation().series_of(group).list(group, of.measurements.stations, residual(before), residual(after), all);
  }
}

/// All readings; of more than are listed one by one those that were left out, and the worst of the others.
void list_suspects(const Finished& of, const Placed& at, FitResiduals& all, Remarks& remarks) {
  constexpr std::size_t kWorst = 100;
  const Observation& observation = of.observation();
  const std::vector<Station>& stations = of.measurements.stations;
  const std::vector<Contradiction>& contradictions = of.fit.suspects();
  const std::size_t count = observation.groups().size();
  for (std::size_t place = 0; place < contradictions.size(); ++place) {
    const Contradiction& one = contradictions[place];
    const Group& group = observation.groups()[one.group];
    if (count > kLongestList && place >= kWorst && group.active) continue;
    const ReadingSeries& series = observation.series_of(group);
    std::string text = series.label(group.index, stations);
    if (!group.active && !group.at_wrong_pose) {  // else the note of the pose says so
      const std::string why = series.explanation(group.index, at, stations);
      if (!why.empty()) text += ": " + why;
      const double size = std::sqrt(std::max(one.statistic, 0.0));  // no number where the reading overflows
      remarks.notes.push_back(std::isfinite(size)
                                  ? fmt::format("outlier excluded: {} (residual {:.0f} times the noise)", text, size)
                                  : fmt::format("outlier excluded: {}", text));
    }
    all.suspects.push_back({std::move(text), one.statistic, one.chance(count), !group.active});
  }
}

/// Readings that were left out one by one are taken for mistakes of the measurement.
void assume_mistakes(const Observation& observation, Remarks& remarks) {
  const auto left_out =
      std::ranges::count_if(observation.groups(), [](const Group& one) { return !one.active && !one.at_wrong_pose; });
  if (left_out == 0) return;
  remarks.assumed.push_back(
      fmt::format("{} excluded: the machine did not really stand there. U does not cover it if it did",
                  left_out == 1 ? "one reading is" : fmt::format("{} readings are", left_out)));
}

/// Where the readings are against both machines, without what chance would say of it.
FitResiduals residuals_of(const Finished& of, const Snapshot& before, const Snapshot& after, const FitSummary& fit,
                          Remarks& remarks) {
  const Observation& observation = of.observation();
  FitResiduals all{.before = summarize_fit(before.observation, before.at),
                   .after = summarize_fit(observation, after.at)};
  list_residuals(of, before, after, all, remarks);
  const bool lists = of.options.method == Method::best && fit.stages.back().name == kFineStage;
  if (lists) list_suspects(of, after.at, all, remarks);
  assume_mistakes(observation, remarks);
  const bool noise_is_scatter = !has_priors(observation) && !all_stated(observation);
  const bool visits_tell = of.explanation != nullptr && of.explanation->repeats && !all_stated(observation);
  all.noise = reading_noise(observation, visits_tell ? of.explanation->noise : observation.noise()) *
              (noise_is_scatter ? fit.unit_weight_std.value_or(1.0) : 1.0);
  all.orientation_noise = orientation_noise(observation);
  return all;
}

/// Rank and null space: of the fit itself, or with priors, whose fit always has full rank, of the readings at the
/// nominal machine.
void state_rank(const Finished& of, FitSummary& fit) {
  const Observation& observation = of.observation();
  if (!has_priors(observation)) {
    const Spectrum spectrum =
        analyse(projected_root(of.fit.fit().at_answer, observation.source_count()), kRankTolerance);
    fit.rank = spectrum.rank;
    fit.null_space = in_words(of.robot, spectrum.null_space, observation.sought());
    return;
  }
  const Identifiability seen = identifiability(of.robot, of.measurements, of.options);
  fit.stages.back().rank = fit.rank = seen.rank;
  fit.stages.back().condition = 1.0 / seen.indices.O2;
  for (const NullDirection& one : seen.null_space) {
    fit.null_space.push_back({one.text, among(one.direction, seen.parameters, observation.sought()), one.gauge});
  }
}

FitSummary summary_of(const Finished& of, std::vector<StageReport> stages, const Scatter& scatter, bool ranks) {
  const Observation& observation = of.observation();
  FitSummary fit{.stages = std::move(stages),
                 .readings = observation.groups().size(),
                 .degrees_of_freedom = static_cast<int>(std::lround(scatter.redundancy)),
                 .unit_weight_std = unit_weight_std(scatter)};
  if (ranks || !has_priors(observation)) state_rank(of, fit);
  double freedom = scatter.redundancy;
  if (visits_tell_noise(of, scatter)) {
    fit.unit_weight_std = of.explanation->stated_noise;
    freedom = fit.degrees_of_freedom;
  }
  if (fit.unit_weight_std && all_stated(observation)) {
    fit.fit_probability = chi_square_tail(freedom * std::pow(*fit.unit_weight_std, 2), freedom);
  }
  return fit;
}

/// Where the instruments stood.
FoundSetUps set_ups_of(const Finished& of, const Spread& spread, double noise_dof, Remarks& remarks) {
  const Observation& observation = of.observation();
  Eigen::MatrixXd expanded = spread.covariance;  // Student's k multiplies what comes of the noise, so that U = 2 std
  const double wider = std::pow(coverage_factor(noise_dof) / kCoverageFactor, 2) - 1.0;
  if (expanded.size() > 0) expanded += wider * spread.noise;
  FoundSetUps all;
  for (const auto& series : observation.series()) {
    series->add_set_up({of.fit.fit().parameters, expanded, observation.source_count()}, all, remarks);
  }
  if (!of.robot.nominal().has_guides || !of.robot.freedoms().holds_z()) return all;
  for (const SeriesFrame& one : all.frames) {  // places in a plane, mirrored there, are seen from its other side
    if (one.frame.rotation(2, 2) >= 0.0) continue;
    remarks.assumed.push_back(
        fmt::format("the instrument of {} views the plane from the other side (z reversed), or one of x and y has the "
                    "wrong sign. Points in a plane cannot distinguish these",
                    one.name));
  }
  return all;
}

/// What a fit shows before anyone judges it.
struct Findings {
  FitSummary fit = {};
  FoundSetUps set_ups = {};
  FitResiduals residuals = {};
  Posterior posterior = {};
  Remarks remarks = {};
  CalibrationOptions options = {};  ///< with what readings say of the controller
  double found_parameters = 0.0;
  bool are_complete = false;  ///< the nominal machine reaches every reading, too
};

/// What is said of everything that was found so far.
void add_remarks(const Finished& of, const Placed& at, Findings& all) {
  if (auto note = scatter_across_guides(of.observation(), at, all.found_parameters, of.options.tell_chance)) {
    all.remarks.notes.push_back(std::move(*note));
  }
  add_causes(all.posterior, all.fit, of.options, all.remarks);
  all.options.controller = with_readings(std::move(all.options.controller), of.measurements);
  for (auto& more : {assumptions(of, all.posterior), controller_assumptions(all.options.controller, of.robot)}) {
    std::ranges::copy(more, std::back_inserter(all.remarks.assumed));
  }
}

Findings findings_of(const Finished& of, std::vector<StageReport> stages, std::vector<Component> components,
                     Told told) {
  const Observation& observation = of.observation();
  const LeastSquaresResult& answer = of.fit.fit();
  Findings all{.remarks = {.notes = of.measurements.notes}, .options = of.options};
  if (told == Told::errors || answer.status == LeastSquaresStatus::not_evaluable) {
    all.fit.stages = std::move(stages);
    all.posterior = errors_alone(of, std::move(components));
    return all;
  }
  const bool everything = told == Told::everything;
  const Scatter scatter = of.fit.scatter();
  all.fit = summary_of(of, std::move(stages), scatter, everything);
  const Spread spread = spread_of(of, all.fit, scatter, everything || of.explanation == nullptr);
  all.posterior = posterior_of(of, all.fit, scatter, spread, std::move(components));
  if (everything) all.set_ups = set_ups_of(of, spread, all.posterior.noise_dof, all.remarks);
  Observation nominal(of.robot, of.measurements, of.options, {});
  nominal.take_off_as(observation);
  const auto nominal_unknowns = fit_nominal(nominal, observation);
  const auto stations = observation.stations(answer.parameters);
  const auto nominal_stations = nominal_unknowns ? nominal.stations(*nominal_unknowns) : nullptr;
  if (!stations || !nominal_stations) return all;
  all.are_complete = true;
  const Eigen::Index rows = has_priors(observation) ? 0 : observation.information(answer.parameters).row_count();
  all.found_parameters = found_parameters(of.fit, rows, scatter);
  if (everything) {
    const Placed after{*stations, answer.parameters};
    all.residuals =
        residuals_of(of, {nominal, {*nominal_stations, *nominal_unknowns}}, {observation, after}, all.fit, all.remarks);
    add_remarks(of, after, all);
  }
  all.residuals.chance =
      chance_of(nominal.information(*nominal_unknowns).squared_residuals() - answer.at_answer.squared_residuals(),
                all.found_parameters, scatter, all_stated(observation));
  return all;
}

}  // namespace

std::optional<double> chance_of(double gain, double found, const Scatter& scatter, bool sigmas_known) {
  const bool overflows = !std::isfinite(gain + found + scatter.sum + scatter.redundancy);  // of a fit that diverged
  if (overflows) return std::nullopt;
  gain = std::max(gain, 0.0);
  if (found < 1e-6) return 1.0;
  if (sigmas_known) return chi_square_tail(gain, found);
  if (scatter.redundancy < 1e-6) return std::nullopt;
  if (scatter.sum <= 0.0) return gain > 0.0 ? 0.0 : 1.0;
  return fisher_tail((gain / found) / (scatter.sum / scatter.redundancy), found, scatter.redundancy);
}

StageReport stage_report(std::string name, const StageFit& of) {
  const Observation& observation = of.observation();
  const LeastSquaresResult& fit = of.fit();
  StageReport stage{.name = std::move(name), .iterations = of.iterations(), .converged = of.converged()};
  const auto stations =
      fit.status == LeastSquaresStatus::not_evaluable ? nullptr : observation.stations(fit.parameters);
  if (!stations) return stage;
  stage.rms_distance = summarize_fit(observation, {*stations, fit.parameters}).rms_distance;
  if (has_priors(observation)) return stage;
  const Spectrum spectrum = analyse(projected_root(fit.at_answer, observation.source_count()), kRankTolerance);
  stage.rank = spectrum.rank;
  const bool full = spectrum.rank == observation.source_count();
  stage.condition = full && spectrum.rank > 0
                        ? spectrum.singular_values(0) / spectrum.singular_values(spectrum.rank - 1)
                        : std::numeric_limits<double>::infinity();
  return stage;
}

Evidence evidence_of(const Finished& of, std::vector<StageReport> stages, std::vector<Component> components,
                     Told told) {
  Findings all = findings_of(of, std::move(stages), std::move(components), told);
  StatedUse stated;
  Compared compared;
  if (all.are_complete) {
    stated = use_of(of, all.fit, all.posterior);
    if (stated.note) all.remarks.notes.push_back(std::move(*stated.note));
    compared = compared_with_expected(of, all.fit, all.posterior);
    compared.combinations = all.found_parameters;
    compared.noise = all.residuals.noise;
    compared.use = stated.use.use;
    compared.uncalibrated = stated.uncalibrated;
  }
  const bool determined = all.are_complete && is_determined(of, all.fit);
  Outcome outcome = outcome_of(of, all.fit, determined, all.residuals.chance, compared);
  return {{std::move(all.fit), std::move(all.set_ups), std::move(all.residuals), std::move(all.posterior), stated.use,
           std::move(outcome), std::move(all.remarks), of.robot, std::move(all.options), of.measurements.files},
          is_better_known(compared, of.options)};
}

}  // namespace paracal::detail
