#include "evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <map>

#include "null_space.hpp"
#include "pair_covariance.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "sought.hpp"

namespace paracal::detail {
namespace {

constexpr double kRankTolerance = 1e-7;

bool all_stated(const Observation& observation) { return std::ranges::all_of(observation.groups(), &Group::stated); }

/// Root that the readings alone leave to the sought errors once frames and the like are found.
Eigen::MatrixXd projected_root(const InformationRoot& root, Eigen::Index sources) {
  return root.root().bottomRightCorner(sources, sources);
}

/// Largest errors over all series; rms and largest residual of the distances where no points were read.
PoseErrorSummary summarize_fit(const Observation& observation, const std::vector<StationState>& stations,
                               const Eigen::VectorXd& unknowns) {
  PoseErrorSummary all;
  double sum = 0.0;
  std::size_t count = 0;
  const auto widen = [](double& largest, double value) { largest = std::max(largest, std::abs(value)); };
  const auto widen_rotation = [&](std::optional<double> value) {
    if (value) widen(*(all.max_abs_rotation = all.max_abs_rotation.value_or(0.0)), *value);
  };
  for (std::size_t s = 0; s < observation.series_count(); ++s) {
    const std::vector<PosePair> pairs = station_pairs(observation, stations, unknowns, s);
    const bool rotations = std::ranges::any_of(observation.groups(), [&](const Group& group) {
      return group.is_point() && group.series == s && observation.point(group).rotation;
    });
    const PoseErrorSummary one = summarize(pairs, rotations);
    widen(all.max_abs_distance, one.max_abs_distance);
    widen(all.max_volumetric, one.max_volumetric);
    widen(all.max_volumetric_aligned, one.max_volumetric_aligned);
    widen_rotation(one.max_abs_rotation);
    sum += one.rms_distance * one.rms_distance * static_cast<double>(pairs.size() - 1);
    count += pairs.size() - 1;
  }
  double heights = 0.0;
  std::size_t height_count = 0;
  for (const Group& group : observation.groups()) {
    if (group.is_point() || !group.active) continue;
    if (group.is_height()) {
      heights += std::pow(observation.height_residual(group, stations[group.station], unknowns), 2);
      ++height_count;
      continue;
    }
    const double residual = observation.distance_residual(group, stations, unknowns);
    widen(all.max_abs_distance, residual);
    widen_rotation(observation.rotation_residual(group, stations, unknowns));
    sum += residual * residual;
    ++count;
  }
  if (height_count > 0) all.rms_height = std::sqrt(heights / static_cast<double>(height_count));
  if (count > 0) all.rms_distance = std::sqrt(sum / static_cast<double>(count));
  return all;
}

/// The readings at one machine: unknowns, stations, and the weighted residual sum of the active readings.
struct Snapshot {
  const Observation* observation = nullptr;
  Eigen::VectorXd unknowns;
  std::shared_ptr<const std::vector<StationState>> stations = {};
  double sum = 0.0;
  Eigen::Index rows = 0;
};

std::optional<Snapshot> snapshot(const Observation& observation, Eigen::VectorXd unknowns) {
  auto stations = observation.stations(unknowns);
  InformationRoot root(observation.unknown_count());
  if (!stations || !observation(unknowns, root)) return std::nullopt;
  return Snapshot{&observation, std::move(unknowns), std::move(stations), root.squared_residuals(), root.row_count()};
}

/// The same readings, with the same weights, for the nominal machine: frames and the like are all that is sought.
std::optional<Eigen::VectorXd> fit_nominal(Observation& nominal, const Observation& fitted) {
  nominal.components() = fitted.components();
  nominal.groups() = fitted.groups();
  auto unknowns = nominal.start({});
  if (!unknowns || nominal.unknown_count() == 0) return unknowns;
  return solve_least_squares(std::cref(nominal), *unknowns).parameters;
}

void add_residuals(const Measurements& measurements, const Snapshot& before, const Snapshot& after,
                   Calibration& calibration) {
  const auto turned = [](const Group& group, const Snapshot& at) {
    const auto residual = at.observation->rotation_residual(group, *at.stations, at.unknowns);
    return residual ? std::optional(-*residual) : std::nullopt;
  };
  // Nobody reads the residuals of a hundred thousand pairs of points, and their names would take more room than all
  // else.
  constexpr std::size_t kLongestList = 20000;
  if (after.observation->groups().size() > kLongestList) {
    calibration.notes.push_back(
        fmt::format("{} readings: their residuals are not listed one by one", after.observation->groups().size()));
    return;
  }
  for (const Group& group : after.observation->groups()) {
    const auto rotation_before = turned(group, before), rotation_after = turned(group, after);
    if (group.is_height()) {
      const auto residual = [&](const Snapshot& at) {
        return -at.observation->height_residual(group, (*at.stations)[group.station], at.unknowns);
      };
      calibration.heights.push_back({measurements.planes[group.series].name, measurements.stations[group.station].name,
                                     after.observation->height(group).height, residual(before), residual(after),
                                     !group.active});
      continue;
    }
    if (group.is_point()) {
      const auto residual = [&](const Snapshot& at) {
        return Eigen::Vector3d(-at.observation->point_residual(group, (*at.stations)[group.station], at.unknowns));
      };
      calibration.points.push_back({measurements.series[group.series].name, measurements.stations[group.station].name,
                                    residual(before), residual(after), rotation_before, rotation_after, !group.active});
      continue;
    }
    const DistanceReading& reading = after.observation->distance(group);
    const auto residual = [&](const Snapshot& at) {
      return -at.observation->distance_residual(group, *at.stations, at.unknowns);
    };
    calibration.distances.push_back({measurements.stations[reading.from].name, measurements.stations[reading.to].name,
                                     reading.distance, residual(before), residual(after), reading.rotation,
                                     rotation_before, rotation_after, !group.active});
  }
}

/// Probability that noise alone makes the weighted sum of squares, priors included, shrink by `gain` with `found`
/// parameters: F(gain / found : scatter), or chi-square of the gain where the sigmas are known.
std::optional<double> chance_of(double gain, double found, const Scatter& scatter, bool sigmas_known) {
  gain = std::max(gain, 0.0);
  if (found < 1e-6) return 1.0;
  if (sigmas_known) {
    return boost::math::cdf(boost::math::complement(boost::math::chi_squared_distribution<>(found), gain));
  }
  if (scatter.redundancy < 1e-6) return std::nullopt;
  if (scatter.sum <= 0.0) return gain > 0.0 ? 0.0 : 1.0;
  const double ratio = (gain / found) / (scatter.sum / scatter.redundancy);
  return boost::math::cdf(
      boost::math::complement(boost::math::fisher_f_distribution<>(found, scatter.redundancy), ratio));
}

void add_suspects(const Measurements& measurements, const Observation& observation, const Eigen::VectorXd& unknowns,
                  const std::vector<Contradiction>& contradictions, Calibration& calibration) {
  for (const Contradiction& one : contradictions) {
    const Group& group = observation.groups()[one.group];
    std::string text = label(observation, measurements, group);
    if (!group.active) {
      const std::string why = explanation(observation, measurements, group, unknowns);
      if (!why.empty()) text += ": " + why;
      calibration.notes.push_back(
          fmt::format("left out {} (contradiction {:.0f} times the noise)", text, std::sqrt(one.statistic)));
    }
    calibration.suspects.push_back({std::move(text), one.statistic, one.chance, !group.active});
  }
}

void judge(const LeastSquaresResult& fit, bool determined, Calibration& calibration) {
  const auto say = [&](Verdict verdict, std::string reason) {
    calibration.verdict = verdict;
    calibration.reasons.push_back(std::move(reason));
  };
  if (fit.status == LeastSquaresStatus::not_evaluable) {
    return say(Verdict::not_converged,
               "the nominal machine does not close at every station, or a reading is absurd: are joint angles, "
               "distances and sigmas those of this robot, in deg and mm?");
  }
  if (fit.status == LeastSquaresStatus::not_converged) {
    return say(Verdict::not_converged, fmt::format("the fit did not settle in {} iterations", fit.iterations));
  }
  if (!determined) {
    return say(Verdict::not_identifiable, fmt::format("the readings determine {} of {} parameters: measure more poses",
                                                      calibration.rank, calibration.parameters.size()));
  }
  if (!calibration.chance) {
    return say(Verdict::rejected,
               fmt::format("{} readings for {} parameters leave nothing to check the fit with: measure more poses or "
                           "state their sigma",
                           calibration.readings, calibration.parameters.size()));
  }
  if (*calibration.chance > calibration.options.largest_chance) {
    return say(Verdict::rejected,
               fmt::format("the improvement could be chance (probability {:.2g}, limit {:g}): these errors are not "
                           "shown to be real",
                           *calibration.chance, calibration.options.largest_chance));
  }
  calibration.verdict = Verdict::accepted;
}

/// Root mean square of the standard deviations with which the readings in use entered: of a coordinate, or of a
/// distance where no points were read. Without priors the scatter of the residuals replaces what nobody stated.
double noise_of(const Measurements& measurements, const Observation& observation, const Calibration& calibration) {
  const bool found = !has_priors(observation) && !all_stated(observation);
  const ReadingKind kind = !measurements.series.empty()      ? ReadingKind::point
                           : !measurements.distances.empty() ? ReadingKind::distance
                                                             : ReadingKind::height;
  double sum = 0.0;
  int count = 0;
  for (const Group& group : observation.groups()) {
    if (!group.active || group.kind != kind) continue;
    const double sigma = observation.sigma_of(group) * (group.stated ? observation.components().stated_noise
                                                                     : observation.components().unstated_noise);
    sum += sigma * sigma;
    ++count;
  }
  return std::sqrt(sum / std::max(count, 1)) * (found ? calibration.unit_weight_std.value_or(1.0) : 1.0);
}

void add_frames(const Measurements& measurements, const Observation& observation, const Eigen::VectorXd& unknowns,
                Calibration& calibration) {
  for (std::size_t s = 0; s < measurements.series.size(); ++s) {
    calibration.frames.push_back({measurements.series[s].name, observation.frame(s, unknowns),
                                  observation.rotation_zero(s, unknowns), observation.second_reflector(s, unknowns)});
  }
  for (std::size_t s = 0; s < measurements.planes.size(); ++s) {
    const Eigen::Vector3d plane = observation.plane(s, unknowns);
    calibration.planes.push_back({measurements.planes[s].name, plane(0), plane(1), plane(2)});
  }
  calibration.distance_bias = observation.distance_bias(unknowns);
}

/// Values, standard deviations and shares of information.
void add_parameters(const Observation& observation, const Eigen::VectorXd& unknowns, Calibration& calibration) {
  calibration.parameters.clear();
  for (Eigen::Index k = 0; k < observation.source_count(); ++k) {
    const SoughtSource& one = observation.sought()[static_cast<std::size_t>(k)];
    ParameterEstimate parameter{
        .limb = one.limb, .source = one.source, .value = unknowns(observation.nuisance_count() + k)};
    parameter.prior_std = one.prior_std;
    if (calibration.covariance.size() > 0) parameter.std = std::sqrt(calibration.covariance(k, k));
    if (one.prior_std && parameter.std) {
      parameter.data_share = 1.0 - std::min(1.0, std::pow(*parameter.std / *one.prior_std, 2));
    }
    calibration.parameters.push_back(parameter);
  }
}

/// Notes on a scatter that the stated sigmas do not explain, and on parameters far outside their tolerances.
void add_warnings(Calibration& calibration) {
  constexpr double kImprobable = 0.01, kFarOutside = 4.0;
  if (calibration.fit_probability && *calibration.fit_probability < kImprobable) {
    calibration.notes.push_back(fmt::format(
        "the readings scatter {:.1f} times as much as their stated sigmas; all standard deviations are widened by that",
        *calibration.unit_weight_std));
  }
  for (const ParameterEstimate& parameter : calibration.parameters) {
    if (!parameter.prior_std || std::abs(parameter.value) < kFarOutside * *parameter.prior_std) continue;
    calibration.notes.push_back(
        fmt::format("{} of limb {} is {:.1f} standard deviations of its tolerance away from "
                    "nominal: a wrong part, or a wrong tolerance",
                    name(parameter.source), parameter.limb + 1, std::abs(parameter.value) / *parameter.prior_std));
  }
}

/// Everything was determined that readings of this kind can determine: with priors always; offsets alone (a rail's are
/// also the robot's height) and the paper's pseudo-inverse may leave motions of the whole robot open; otherwise nothing
/// may be open.
bool is_determined(const Observation& observation, const Calibration& calibration) {
  if (has_priors(observation) || calibration.rank == observation.source_count()) return true;
  const bool may_leave_motions = calibration.options.method == Method::paper || calibration.stages.size() == 1;
  return may_leave_motions && std::ranges::all_of(calibration.null_space, &NullDirection::gauge);
}

/// Scatter and covariance. With priors the covariance is the posterior's; without, it is scaled by the scatter: always
/// where no sigma is stated, upwards only where all are.
void state_uncertainty(const Measurements& measurements, const Observation& observation, const LeastSquaresResult& fit,
                       const Scatter& scatter_of_fit, Calibration& calibration) {
  constexpr double kImprobable = 0.01;
  const double sum = scatter_of_fit.sum, freedom = scatter_of_fit.redundancy;
  const bool stated = all_stated(observation);
  if (freedom >= 0.5) calibration.unit_weight_std = std::sqrt(sum / freedom);
  if (freedom >= 0.5 && stated) {
    calibration.fit_probability =
        boost::math::cdf(boost::math::complement(boost::math::chi_squared_distribution<>(freedom), sum));
  }
  const Eigen::Index n = observation.source_count();
  const double scatter = calibration.unit_weight_std.value_or(1.0);
  if (has_priors(observation)) {
    const double factor = calibration.fit_probability.value_or(1.0) < kImprobable ? scatter : 1.0;
    calibration.covariance = inverse_information(fit.at_answer.root()).bottomRightCorner(n, n) * factor * factor;
    return;
  }
  if (!calibration.unit_weight_std && !stated) return;
  const Spectrum all = analyse(fit.at_answer.root(), kRankTolerance);
  if (calibration.options.method == Method::paper) {
    calibration.covariance = covariance_of_pairs(measurements, observation, fit.parameters, all.covariance, sum);
  } else if (is_determined(observation, calibration)) {
    const double factor = stated ? std::max(1.0, scatter) : scatter;
    calibration.covariance = all.covariance.bottomRightCorner(n, n) * factor * factor;
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

}  // namespace

std::vector<PosePair> station_pairs(const Observation& observation, const std::vector<StationState>& stations,
                                    const Eigen::VectorXd& unknowns, std::size_t series) {
  struct Mean {
    PosePair pair;
    int points = 0, rotations = 0;
  };
  std::map<std::size_t, Mean> means;
  for (const Group& group : observation.groups()) {
    if (!group.is_point() || group.series != series || !group.active) continue;
    const StationState& station = stations[group.station];
    Mean& mean = means[group.station];
    if (mean.points == 0) {
      const Pose meant{station.plate.position, station.rotation};
      mean.pair = {meant, {Eigen::Vector3d::Zero(), meant.rotation}};
    }
    const Eigen::Vector3d measured = station.plate.position - observation.point_residual(group, station, unknowns);
    mean.pair.actual.position += (measured - mean.pair.actual.position) / ++mean.points;
    if (const auto residual = observation.rotation_residual(group, stations, unknowns)) {
      const double read = station.rotation - *residual;
      mean.pair.actual.rotation += (read - mean.pair.actual.rotation) / ++mean.rotations;
    }
  }
  std::vector<PosePair> pairs;
  pairs.reserve(means.size());
  for (const auto& [station, mean] : means) pairs.push_back(mean.pair);
  return pairs;
}

void add_stage(const char* name, const Observation& observation, const LeastSquaresResult& fit, int iterations,
               Calibration& calibration) {
  StageReport stage{.name = name, .iterations = iterations, .converged = fit.status == LeastSquaresStatus::converged};
  const auto stations =
      fit.status == LeastSquaresStatus::not_evaluable ? nullptr : observation.stations(fit.parameters);
  if (stations) {
    stage.rms_distance = summarize_fit(observation, *stations, fit.parameters).rms_distance;
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

void state_evidence(const Measurements& measurements, const Observation& observation, const LeastSquaresResult& fit,
                    const Scatter& scatter, const std::vector<Contradiction>& suspects, Calibration& calibration) {
  if (fit.status == LeastSquaresStatus::not_evaluable) return judge(fit, false, calibration);
  calibration.readings = observation.groups().size();
  calibration.degrees_of_freedom = static_cast<int>(std::lround(scatter.redundancy));
  state_rank(measurements, observation, fit, calibration);
  state_uncertainty(measurements, observation, fit, scatter, calibration);
  add_parameters(observation, fit.parameters, calibration);
  add_frames(measurements, observation, fit.parameters, calibration);
  Observation nominal(calibration.robot, measurements, calibration.options, {});
  const auto nominal_unknowns = fit_nominal(nominal, observation);
  const auto after = snapshot(observation, fit.parameters);
  const auto before = nominal_unknowns ? snapshot(nominal, *nominal_unknowns) : std::nullopt;
  if (!after || !before) return judge(fit, false, calibration);
  add_residuals(measurements, *before, *after, calibration);
  calibration.before = summarize_fit(nominal, *before->stations, before->unknowns);
  calibration.after = summarize_fit(observation, *after->stations, after->unknowns);
  // As many parameters as the readings were used up for: with priors that is no whole number.
  const double found = static_cast<double>(after->rows - observation.nuisance_count()) - scatter.redundancy;
  calibration.chance =
      chance_of(before->sum - fit.at_answer.squared_residuals(), found, scatter, all_stated(observation));
  calibration.noise = noise_of(measurements, observation, calibration);
  add_suspects(measurements, observation, after->unknowns, suspects, calibration);
  add_warnings(calibration);
  judge(fit, is_determined(observation, calibration), calibration);
}

}  // namespace paracal::detail
