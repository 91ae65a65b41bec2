#include "evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/fit/null_space.hpp"
#include "considered.hpp"
#include "guided_scatter.hpp"
#include "numerics/distributions.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "spread.hpp"
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

/// The readings at one machine: unknowns and stations.
struct Snapshot {
  const Observation* observation = nullptr;
  Eigen::VectorXd unknowns;
  std::shared_ptr<const std::vector<StationState>> stations = {};

  Placed placed() const { return {*stations, unknowns}; }
  /// Of the active readings.
  InformationRoot information() const {
    InformationRoot root(observation->unknown_count());
    (void)(*observation)(unknowns, root);  // closes, as there are stations
    return root;
  }
};

std::optional<Snapshot> snapshot(const Observation& observation, Eigen::VectorXd unknowns) {
  auto stations = observation.stations(unknowns);
  if (!stations) return std::nullopt;
  return Snapshot{&observation, std::move(unknowns), std::move(stations)};
}

/// The same readings, with the same weights, for the nominal machine: frames and the like are all that is sought.
std::optional<Eigen::VectorXd> fit_nominal(Observation& nominal, const Observation& fitted) {
  nominal.components() = fitted.components();
  nominal.groups() = fitted.groups();
  nominal.let_joints_err(fitted.joint_std());
  auto unknowns = nominal.start({});
  if (!unknowns || nominal.unknown_count() == 0) return unknowns;
  return solve_least_squares(with_priors(nominal), *unknowns).parameters;
}

/// Nobody reads the residuals of a hundred thousand pairs of points, and their names would take more room than all
/// else.
constexpr std::size_t kLongestList = 20000;

void add_residuals(const Measurements& measurements, const Snapshot& before, const Snapshot& after,
                   Calibration& calibration) {
  if (after.observation->groups().size() > kLongestList) {
    calibration.notes.push_back(
        fmt::format("{} readings are too many to list: JSON and report show only statistics of their residuals",
                    after.observation->groups().size()));
    return;
  }
  for (const Group& group : after.observation->groups()) {
    const auto residual = [&](const Snapshot& at) { return at.observation->residual(group, at.placed()).reversed(); };
    after.observation->series_of(group).list(group, measurements.stations, residual(before), residual(after),
                                             calibration);
  }
}

/// Places in a plane, mirrored there, are places in a plane seen from its other side.
void state_turned_over(const Robot& robot, Calibration& calibration) {
  if (!robot.nominal().has_guides || !robot.freedoms().holds_z()) return;
  for (const SeriesFrame& one : calibration.frames) {
    if (one.frame.rotation(2, 2) >= 0.0) continue;
    calibration.assumed.push_back(
        fmt::format("the instrument of {} views the plane from the other side (z reversed), or one of x and y has the "
                    "wrong sign. Points in a plane cannot distinguish these",
                    one.name));
  }
}

CalibratedRegion region_of(const Measurements& measurements, const Observation& observation) {
  CalibratedRegion region;
  for (const Group& group : observation.groups()) {
    if (group.active) region.add(measurements.stations[group.station].commanded.position);
  }
  return region;
}

/// Readings that were left out one by one are taken for mistakes of the measurement.
void assume_mistakes(const Observation& observation, Calibration& calibration) {
  const auto left_out =
      std::ranges::count_if(observation.groups(), [](const Group& one) { return !one.active && !one.at_wrong_pose; });
  if (left_out == 0) return;
  calibration.assumed.push_back(
      fmt::format("{} excluded: the machine did not really stand there. U does not cover it if it did",
                  left_out == 1 ? "one reading is" : fmt::format("{} readings are", left_out)));
}

/// All readings; of more than are listed one by one those that were left out, and the worst of the others.
void add_suspects(const Measurements& measurements, const Observation& observation, const Placed& at,
                  const std::vector<Contradiction>& contradictions, Calibration& calibration) {
  constexpr std::size_t kWorst = 100;
  const std::size_t count = observation.groups().size();
  for (std::size_t place = 0; place < contradictions.size(); ++place) {
    const Contradiction& one = contradictions[place];
    const Group& group = observation.groups()[one.group];
    if (count > kLongestList && place >= kWorst && group.active) continue;
    const ReadingSeries& series = observation.series_of(group);
    std::string text = series.label(group.index, measurements.stations);
    if (!group.active && !group.at_wrong_pose) {  // else the note of the pose says so
      const std::string why = series.explanation(group.index, at, measurements.stations);
      if (!why.empty()) text += ": " + why;
      const double size = std::sqrt(std::max(one.statistic, 0.0));  // no number where the reading overflows
      calibration.notes.push_back(
          std::isfinite(size) ? fmt::format("outlier excluded: {} (residual {:.0f} times the noise)", text, size)
                              : fmt::format("outlier excluded: {}", text));
    }
    calibration.suspects.push_back({std::move(text), one.statistic, one.chance(count), !group.active});
  }
}

/// Values, standard deviations, their degrees of freedom and shares of information: the sought errors, then those held.
/// @param with_drives  of the sought errors; empty: the machine is rigid.
void add_parameters(const StageFit& fit, const std::vector<SoughtSource>& held, const Eigen::VectorXd& with_drives,
                    Calibration& calibration) {
  const Observation& observation = fit.observation();
  const Eigen::MatrixXd &covariance = calibration.covariance, &noise = calibration.noise_covariance;
  std::vector<SoughtSource> all = observation.sought();
  all.insert(all.end(), held.begin(), held.end());
  for (Eigen::Index k = 0; k < std::ssize(all); ++k) {
    const SoughtSource& one = all[static_cast<std::size_t>(k)];
    ParameterEstimate parameter{.limb = one.limb, .source = one.source, .held = k >= observation.source_count()};
    if (calibration.options.expected) parameter.expected = (*calibration.options.expected)(one.limb, one.source);
    parameter.value = parameter.expected;
    if (k < with_drives.size()) parameter.with_drives = parameter.expected + with_drives(k);
    if (!parameter.held) parameter.value += fit.fit().parameters(observation.nuisance_count() + k);
    parameter.prior_std = one.prior_std;
    if (k < covariance.rows()) {
      parameter.std = std::sqrt(covariance(k, k));
      parameter.dof = calibration.noise_dof * std::pow(covariance(k, k) / std::max(noise(k, k), 1e-300), 2);
    }
    if (one.prior_std && parameter.std) {
      parameter.data_share = 1.0 - std::min(1.0, std::pow(*parameter.std / *one.prior_std, 2));
    }
    calibration.parameters.push_back(parameter);
  }
}

/// Rank and null space: of the fit itself, or with priors, whose fit always has full rank, of the readings at the
/// nominal machine.
void state_rank(const Measurements& measurements, const Observation& observation, const LeastSquaresResult& fit,
                Calibration& calibration) {
  StageReport& stage = calibration.stages.back();
  if (!has_priors(observation)) {
    const Spectrum spectrum = analyse(projected_root(fit.at_answer, observation.source_count()), kRankTolerance);
    calibration.rank = spectrum.rank;
    calibration.null_space = in_words(calibration.robot, spectrum.null_space, observation.sought());
    return;
  }
  const Identifiability seen = identifiability(calibration.robot, measurements, calibration.options);
  stage.rank = calibration.rank = seen.rank;
  stage.condition = 1.0 / seen.indices.O2;
  for (const NullDirection& one : seen.null_space) {
    calibration.null_space.push_back(
        {one.text, among(one.direction, seen.parameters, observation.sought()), one.gauge});
  }
}

/// Where the instruments stood.
void describe_set_up(const StageFit& fit, const Spread& spread, Calibration& calibration) {
  const Observation& observation = fit.observation();
  const Eigen::MatrixXd expanded = spread.expanded(calibration.noise_dof);
  for (const auto& series : observation.series()) series->state_setup(fit.fit().parameters, expanded, calibration);
  state_turned_over(observation.robot(), calibration);
}

void describe_readings(const Measurements& measurements, const Snapshot& before, const Snapshot& after,
                       Calibration& calibration) {
  const Observation& observation = *after.observation;
  add_residuals(measurements, before, after, calibration);
  calibration.before = summarize_fit(*before.observation, before.placed());
  calibration.after = summarize_fit(observation, after.placed());
  const bool noise_is_scatter = !has_priors(observation) && !all_stated(observation);
  calibration.noise = reading_noise(observation) * (noise_is_scatter ? calibration.unit_weight_std.value_or(1.0) : 1.0);
  calibration.orientation_noise = orientation_noise(observation);
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

void add_stage(const char* name, const Observation& observation, const LeastSquaresResult& fit, int iterations,
               Calibration& calibration) {
  StageReport stage{.name = name, .iterations = iterations, .converged = fit.status == LeastSquaresStatus::converged};
  const auto stations =
      fit.status == LeastSquaresStatus::not_evaluable ? nullptr : observation.stations(fit.parameters);
  if (stations) {
    stage.rms_distance = summarize_fit(observation, {*stations, fit.parameters}).rms_distance;
    if (!has_priors(observation)) {
      const Spectrum spectrum = analyse(projected_root(fit.at_answer, observation.source_count()), kRankTolerance);
      stage.rank = spectrum.rank;
      const bool full = spectrum.rank == observation.source_count();
      stage.condition = full && spectrum.rank > 0
                            ? spectrum.singular_values(0) / spectrum.singular_values(spectrum.rank - 1)
                            : std::numeric_limits<double>::infinity();
    }
  }
  calibration.stages.push_back(std::move(stage));
}

void state_errors(const StageFit& fit, Calibration& calibration) {
  if (fit.fit().status != LeastSquaresStatus::not_evaluable) add_parameters(fit, {}, {}, calibration);
}

bool state_evidence(const Measurements& measurements, const StageFit& fit,
                    const std::optional<Explanation>& explanation, const std::vector<Contradiction>& suspects,
                    Told told, Calibration& calibration) {
  const Observation& observation = fit.observation();
  const LeastSquaresResult& answer = fit.fit();
  if (answer.status == LeastSquaresStatus::not_evaluable) {
    judge(answer, false, {}, calibration);
    return true;
  }
  const bool everything = told == Told::everything;
  const Scatter scatter = fit.scatter();
  calibration.readings = observation.groups().size();
  calibration.region = region_of(measurements, observation);
  calibration.degrees_of_freedom = static_cast<int>(std::lround(scatter.redundancy));
  if (everything || !has_priors(observation)) state_rank(measurements, observation, answer, calibration);
  const Spread spread = state_uncertainty(measurements, fit, scatter, everything || !explanation, calibration);
  if (explanation && calibration.covariance.size() > 0) take(*explanation, all_stated(observation), calibration);
  const std::vector<SoughtSource> held = consider_held(measurements, fit, calibration);
  add_parameters(fit, held, explanation ? explanation->with_drives : Eigen::VectorXd(), calibration);
  if (everything) describe_set_up(fit, spread, calibration);
  Observation nominal(calibration.robot, measurements, calibration.options, {});
  nominal.take_off_as(observation);
  const auto nominal_unknowns = fit_nominal(nominal, observation);
  const auto after = snapshot(observation, answer.parameters);
  const auto before = nominal_unknowns ? snapshot(nominal, *nominal_unknowns) : std::nullopt;
  if (!after || !before) {
    judge(answer, false, {}, calibration);
    return true;
  }
  const Eigen::Index rows = has_priors(observation) ? 0 : after->information().row_count();
  const double found = found_parameters(fit, rows, scatter);
  calibration.chance = chance_of(before->information().squared_residuals() - answer.at_answer.squared_residuals(),
                                 found, scatter, all_stated(observation));
  if (everything) {
    describe_readings(measurements, *before, *after, calibration);
    add_suspects(measurements, observation, after->placed(), suspects, calibration);
    assume_mistakes(observation, calibration);
    state_guided_scatter(observation, after->placed(), found, calibration);
    add_components(calibration);
    if (explanation && explanation->repeats && !all_stated(observation)) {
      calibration.noise *= explanation->unstated_noise;
    }
    add_assumptions(fit, explanation, calibration);
    add_controller(measurements, calibration);
  }
  Compared found_beside = compared(fit, explanation, calibration);
  found_beside.combinations = found;
  found_beside.uncalibrated = state_use(fit, calibration);
  add_promise_of_fine(measurements, calibration);
  judge(answer, is_determined(fit, calibration), found_beside, calibration);
  return is_better_known(found_beside, calibration);
}

}  // namespace paracal::detail
