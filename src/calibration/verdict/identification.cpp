#include "paracal/calibration/identification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

#include "calibration/fit/as_given.hpp"
#include "calibration/fit/distance_geometry.hpp"
#include "calibration/fit/sought.hpp"
#include "calibration/fit/stage_fit.hpp"
#include "evidence.hpp"
#include "explanation.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "paracal/error.hpp"
#include "paracal/numerics/least_squares.hpp"

namespace paracal {
namespace {

/// The paper measures points and calibrates from the distances of all pairs, all weighing alike, and nothing else.
Measurements as_distances(const Measurements& measurements) {
  Measurements pairs{.stations = measurements.stations,
                     .distances = measurements.distances,
                     .files = measurements.files,
                     .notes = measurements.notes};
  for (const PointSeries& series : measurements.series) {
    std::vector<DistanceReading> distances = all_distances(series);
    if (pairs.distances.empty()) {
      pairs.distances = std::move(distances);
    } else {
      pairs.distances.insert(pairs.distances.end(), distances.begin(), distances.end());
    }
  }
  for (DistanceReading& reading : pairs.distances) {
    reading.distance_sigma.reset();
    reading.rotation.reset();
  }
  return pairs;
}

/// Do the readings leave nothing open but motions of the whole robot, and are there a quarter more of them than that
/// takes? Distances between N points are worth 3 N - 6 numbers at most; frames and the like cost as many as
/// they have unknowns.
bool enough_for_fine(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options) {
  constexpr double kSpare = 1.25;
  const Identifiability seen = identifiability(robot, measurements, options, detail::position_group(robot, options));
  std::vector<bool> is_joined(measurements.stations.size());
  for (const DistanceReading& reading : measurements.distances) is_joined[reading.from] = is_joined[reading.to] = true;
  const Eigen::Index joined = std::ranges::count(is_joined, true);
  const auto pairs = static_cast<Eigen::Index>(measurements.distances.size());
  const auto worth = std::min(pairs, std::max<Eigen::Index>(3 * joined - 6, 1));
  const Eigen::Index numbers = seen.rows - (pairs - worth) - seen.nuisance;
  const bool open = !std::ranges::all_of(seen.null_space, &NullDirection::gauge);
  return !open && static_cast<double>(numbers) >= kSpare * seen.rank;
}

/// On limbs with one rod the encoder offsets alone are no stage of anybody's; and where few readings make them stand
/// out by chance, those that do are farther off than they are said to be.
bool goes_fine(const Robot& robot, const Measurements& measurements, const CalibrationOptions& options) {
  if (options.stage != Stage::automatic) return options.stage == Stage::fine;
  return !robot.is_level() || enough_for_fine(robot, measurements, options);
}

Calibration with_errors(const detail::StageFit& stage, Calibration calibration) {
  detail::state_errors(stage, calibration);
  return calibration;
}

Calibration finished(const Measurements& used, const detail::StageFit& stage,
                     const std::optional<detail::Explanation>& explanation, Calibration calibration,
                     detail::Told told) {
  if (told == detail::Told::errors) return with_errors(stage, std::move(calibration));
  detail::add_stage("fine", stage.observation(), stage.fit(), stage.iterations(), calibration);
  const std::vector<detail::Contradiction> none;
  const bool lists = told == detail::Told::everything && calibration.options.method != Method::paper;
  detail::state_evidence(used, stage, explanation, lists ? stage.suspects() : none, told, calibration);
  return calibration;
}

/// A fit, and what explains what it leaves.
struct StageExplanation {
  detail::StageFit fit;
  std::optional<detail::Explanation> found = {};

  bool names_cause() const {
    return found && std::ranges::any_of(found->causes, [](const Component& one) { return one.told; });
  }
};

StageExplanation explained(detail::StageFit fit, const Measurements& used, const CalibrationOptions& options) {
  StageExplanation all{std::move(fit)};
  if (options.seeks_discrepancies) all.found = detail::explained(all.fit, used, options);
  return all;
}

/// Gross errors and discrepancies can each be taken for the other: a wrong part for readings that contradict the rest,
/// a gross reading for backlash. Where leaving out gross errors first takes any, the machine is also explained with
/// them, and that explanation is kept under which all readings are likelier.
StageExplanation fit_and_explain(const Measurements& used, detail::StageFit stage, const CalibrationOptions& options) {
  stage.settle();
  const detail::StageFit without = stage;
  if (options.exclude_outliers) stage.exclude_outliers(options.outlier_chance);
  const bool left_out = stage.kept() != without.kept();
  std::vector<StageExplanation> all;
  all.push_back(explained(std::move(stage), used, options));
  if (left_out) all.push_back(explained(without, used, options));
  constexpr double kAlike = 1.0;  // of a logarithm: an explanation that names a cause is the better one
  const bool other = left_out && all[1].names_cause() &&
                     (!all[0].found || all[1].found->log_evidence > all[0].found->log_evidence - kAlike);
  return std::move(all[other ? 1 : 0]);
}

/// Where a reflector is beside its axis or centre, its place on this mount is one more unknown.
CalibrationOptions seeking_reflector(CalibrationOptions options, ReflectorMount mount) {
  options.reflector_is_at_centre = false;
  options.reflectors = mount;
  return options;
}

/// Priors that no table can use.
void check(const Discrepancies& expected) {
  constexpr double kShortest = 0.11, kLongest = 10.0;  // of a stroke: splines an eighth apart follow nothing shorter
  const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!positive(expected.visits) || !positive(expected.poses) || !positive(expected.drives) ||
      !positive(expected.tolerances)) {
    throw InvalidArgument("discrepancies: expected numbers above 0, got others");
  }
  if (expected.length >= kShortest && expected.length <= kLongest) return;
  throw InvalidArgument(fmt::format("discrepancies.length: expected {} to {} of the stroke, got {}", kShortest,
                                    kLongest, expected.length));
}

/// The machine that the fit expects, by which priors and held errors are counted.
Robot expected_robot(const Robot& robot, const CalibrationOptions& options) {
  if (!options.expected) return robot;
  RobotDescription description = robot.description();
  description.limbs = with_errors(std::move(description.limbs), *options.expected);
  return Robot(std::move(description));
}

/// The only reason against it.
bool lacks_significance_alone(const Calibration& calibration) {
  return calibration.verdict == Verdict::rejected && calibration.reasons.size() == 1 && calibration.chance &&
         *calibration.chance > calibration.options.largest_chance;
}

/// Offsets alone left the machine less well known than its tolerances do, which the fine stage uses. That the readings
/// show errors is known from the offsets, which are fewer: the fine fit need not show it again.
/// @param offsets  rejected for their U alone.
Calibration with_tolerances(const Robot& robot, const Measurements& measurements, CalibrationOptions options,
                            const Calibration& offsets, detail::Told told) {
  options.stage = Stage::fine;
  Calibration calibration = detail::calibrate_as_given(robot, measurements, options, told);
  calibration.options.stage = Stage::automatic;
  if (lacks_significance_alone(calibration)) {
    calibration.chance = offsets.chance;
    calibration.reasons.clear();
    calibration.verdict = Verdict::accepted;
  }
  return calibration;
}

}  // namespace

Calibration detail::calibrate_as_given(const Robot& robot, const Measurements& measurements,
                                       const CalibrationOptions& options, Told told, std::vector<Component> causes) {
  check(measurements, robot.limb_count());
  check(options.discrepancies);
  const bool paper = options.method == Method::paper;
  if (measurements.distances.empty() && measurements.series.empty() && (paper || measurements.lengths.empty())) {
    throw InvalidArgument(measurements.lengths.empty()
                              ? std::string("measurements: expected at least one reading, got none")
                              : fmt::format("method paper: expected points or distances, got only {}",
                                            words(measurements.lengths.front().kind).plural));
  }
  if (paper && std::ranges::any_of(measurements.series, &PointSeries::is_of_body)) {
    throw InvalidArgument("method paper: expected points of the plate centre or distances, got poses of a body");
  }
  const Robot centre = expected_robot(robot, options);
  const bool fine = goes_fine(centre, measurements, options);
  const std::vector<SoughtSource> sought =
      paper ? detail::paper_columns(robot, options) : detail::all_with_priors(robot, options);
  if (fine && sought.empty()) {
    throw InvalidArgument(
        "calibration: expected at least one error to estimate, got only errors that are fixed or have no tolerance");
  }
  const bool biased = options.noise.distance_bias > 0.0;  // such distances are none between points
  std::optional<Measurements> converted;
  if (paper) converted = as_distances(measurements);
  if (!paper && !biased) converted = detail::as_points(measurements);
  const Measurements& used = converted ? *converted : measurements;
  Calibration calibration{.robot = robot, .notes = used.notes, .options = options, .files = measurements.files};

  // Not from lengths: to them offsets alone are hardly more than the set-up, as a plane's height and tilt.
  SourceErrors offsets;
  if (!fine || used.lengths.empty()) {
    detail::StageFit rough(centre, used, options, detail::encoder_offsets(robot, options), {});
    rough.solve();
    detail::add_stage("rough", rough.observation(), rough.fit(), rough.iterations(), calibration);
    if (!fine || rough.fit().status == LeastSquaresStatus::not_evaluable) {
      if (told == Told::errors) return with_errors(rough, std::move(calibration));
      const bool better_known = detail::state_evidence(used, rough, {}, {}, told, calibration);
      const bool only_this = calibration.verdict == Verdict::rejected && calibration.reasons.size() == 1;
      const bool may_go_fine = only_this && options.stage == Stage::automatic && !paper;
      return !better_known && may_go_fine ? with_tolerances(robot, measurements, options, calibration, told)
                                          : calibration;
    }
    offsets = rough.observation().errors(rough.fit().parameters);
  }
  detail::StageFit stage(centre, used, options, sought, offsets, !paper);
  if (paper) {
    stage.solve_by_pseudo_inverse();
    return finished(used, stage, {}, std::move(calibration), told);
  }
  const StageExplanation best = fit_and_explain(used, std::move(stage), options);
  if (best.found) causes.insert(causes.end(), best.found->causes.begin(), best.found->causes.end());
  if (best.found && best.found->mount) {
    return calibrate_as_given(robot, measurements, seeking_reflector(options, *best.found->mount), told,
                              std::move(causes));
  }
  calibration.components = std::move(causes);
  return finished(used, best.fit, best.found, std::move(calibration), told);
}

}  // namespace paracal
