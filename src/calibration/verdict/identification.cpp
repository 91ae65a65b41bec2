#include "paracal/calibration/identification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
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

/// A fit, and what explains what it leaves.
struct StageExplanation {
  detail::StageFit fit;
  std::optional<detail::Explanation> found = {};

  bool names_cause() const {
    return found && std::ranges::any_of(found->known.components, [](const Component& one) { return one.told; });
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

/// Offsets alone left the machine less well known than its tolerances do, which the fine stage uses. That the readings
/// show errors is known from the offsets, which are fewer: the fine fit need not show it again.
/// @param offsets  rejected for their U alone.
Calibration with_tolerances(const Robot& robot, const Measurements& measurements, CalibrationOptions options,
                            const Calibration& offsets, detail::Told told) {
  options.stage = Stage::fine;
  Calibration fine = detail::calibrate_as_given(robot, measurements, options, told);
  fine.options.stage = Stage::automatic;
  const bool lacks_significance_alone = fine.verdict == Verdict::rejected && fine.reasons.size() == 1 && fine.chance &&
                                        *fine.chance > fine.options.largest_chance;
  if (lacks_significance_alone) {
    fine.chance = offsets.chance;
    static_cast<Outcome&>(fine) = {.verdict = Verdict::accepted};
  }
  return fine;
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
  std::vector<StageReport> stages;
  // Not from lengths: to them offsets alone are hardly more than the set-up, as a plane's height and tilt.
  SourceErrors offsets;
  if (!fine || used.lengths.empty()) {
    detail::StageFit rough(centre, used, options, detail::encoder_offsets(robot, options), {});
    rough.solve();
    stages.push_back(stage_report(kRoughStage, rough));
    if (!fine || rough.fit().status == LeastSquaresStatus::not_evaluable) {
      Evidence found = evidence_of({robot, used, options, rough}, std::move(stages), {}, told);
      const bool only_this = found.calibration.verdict == Verdict::rejected && found.calibration.reasons.size() == 1;
      const bool may_go_fine = only_this && options.stage == Stage::automatic && !paper;
      return !found.is_better_known && may_go_fine
                 ? with_tolerances(robot, measurements, options, found.calibration, told)
                 : std::move(found.calibration);
    }
    offsets = rough.observation().errors(rough.fit().parameters);
  }
  detail::StageFit stage(centre, used, options, sought, offsets, !paper);
  const auto finished = [&](const StageFit& fit, const Explanation* explanation) {
    stages.push_back(stage_report(kFineStage, fit));
    return evidence_of({robot, used, options, fit, explanation}, std::move(stages), std::move(causes), told)
        .calibration;
  };
  if (paper) {
    stage.solve_by_pseudo_inverse();
    return finished(stage, nullptr);
  }
  const StageExplanation best = fit_and_explain(used, std::move(stage), options);
  if (best.found) std::ranges::copy(best.found->known.components, std::back_inserter(causes));
  if (best.found && best.found->mount) {
    return calibrate_as_given(robot, measurements, seeking_reflector(options, *best.found->mount), told,
                              std::move(causes));
  }
  return finished(best.fit, best.found ? &*best.found : nullptr);
}

}  // namespace paracal
