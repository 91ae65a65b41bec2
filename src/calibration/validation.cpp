#include "paracal/calibration/validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "agreement.hpp"
#include "iso9283.hpp"
#include "located.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "placement.hpp"
#include "visits.hpp"

namespace paracal {
namespace {

constexpr std::size_t kFewestPoses = 4;

void widen(PoseErrorSummary& all, const PoseErrorSummary& one) {
  all.max_abs_distance = std::max(all.max_abs_distance, one.max_abs_distance);
  all.rms_distance = std::max(all.rms_distance, one.rms_distance);
  all.max_volumetric = std::max(all.max_volumetric, one.max_volumetric);
  all.max_volumetric_aligned = std::max(all.max_volumetric_aligned, one.max_volumetric_aligned);
  if (one.max_abs_rotation) {
    all.max_abs_rotation = std::max(all.max_abs_rotation.value_or(0.0), *one.max_abs_rotation);
  }
}

/// Of the least certain reading, mm.
detail::Uncertainty uncertainty_of_readings(const Validation& validation, std::optional<LengthKind> of) {
  detail::Uncertainty largest;
  for (const CheckedReading& one : validation.readings) {
    if (one.length == of) largest.standard = std::max(largest.standard, one.sigma);
  }
  return largest;
}

/// Largest |residual| of distances or lengths of a kind, before and after.
std::pair<double, double> largest_of_readings(const Validation& validation, std::optional<LengthKind> of) {
  double before = 0.0, after = 0.0;
  for (const CheckedReading& one : validation.readings) {
    if (one.length != of) continue;
    before = std::max(before, std::abs(one.before));
    after = std::max(after, std::abs(one.after));
  }
  return {before, after};
}

/// Without limits a calibration must have made the machine better by more than can be measured: by points where there
/// are any, else by distances, else by lengths. Where nothing tells the noise, what is left says how large it may be:
/// of lengths read in metres half a metre is.
void require_gain(double two_points, Validation& validation) {
  const auto require = [&](std::string_view what, double before, double after, double uncertainty, double left) {
    if (!validation.agreement) uncertainty = std::max(uncertainty, kCoverageFactor * left);
    if (before - after > uncertainty) return;
    validation.reasons.push_back(
        fmt::format("the largest {} went from {:.3f} to {:.3f} mm, which is not more than the uncertainty of measuring "
                    "it, {:.3f} mm",
                    what, before, after, uncertainty));
  };
  if (!validation.poses.empty()) {
    return require("aligned error", validation.before.max_volumetric_aligned, validation.after.max_volumetric_aligned,
                   two_points, validation.after.rms_distance);
  }
  if (validation.after.reads_distances) {
    const auto [before, after] = largest_of_readings(validation, std::nullopt);
    return require("error of a distance", before, after, uncertainty_of_readings(validation, std::nullopt).expanded(),
                   validation.after.rms_distance);
  }
  const auto& [kind, rms] = *validation.after.rms_lengths.begin();
  const auto [before, after] = largest_of_readings(validation, kind);
  require(fmt::format("error of a {}", words(kind).noun), before, after,
          uncertainty_of_readings(validation, kind).expanded(), rms);
}

/// Adds the errors of distances and lengths to those of points.
void add_readings(const PoseErrorSummary& readings, bool has_points, PoseErrorSummary& all) {
  widen(all, readings);
  all.reads_distances = has_points || readings.reads_distances;
  all.rms_lengths = readings.rms_lengths;
}

/// Of a rotation that was read with a distance, rad; 0 where none was.
detail::Uncertainty uncertainty_of_rotations(const Measurements& measurements, const ValidationOptions& options) {
  const bool any =
      std::ranges::any_of(measurements.distances, [](const auto& one) { return one.rotation.has_value(); });
  return {any ? options.noise.rotation : 0.0};
}

/// The differences of two points vary sqrt(2) times as much as one coordinate; |dr| of an aligned point by its three.
void check_limits(const Measurements& measurements, const ValidationOptions& options, Validation& validation) {
  detail::MeansOfVisits means = detail::means_of_visits(measurements, options);
  std::ranges::move(means.notes, std::back_inserter(validation.notes));
  const detail::Uncertainty two_points = means.point.times(std::sqrt(2.0));
  const auto check = [&](const char* quantity, const std::optional<double>& limit, double error,
                         const detail::Uncertainty& of_error) {
    if (!limit) return;
    const double uncertainty = of_error.expanded();
    const Conformity conformity = error + uncertainty <= *limit  ? Conformity::conforming
                                  : error - uncertainty > *limit ? Conformity::not_conforming
                                                                 : Conformity::undecided;
    validation.checks.push_back({quantity, error, uncertainty, of_error.coverage, *limit, conformity});
    if (conformity == Conformity::conforming) return;
    validation.reasons.push_back(fmt::format("{}: {:.4g} +- {:.2g} against a limit of {:.4g} is {}", quantity, error,
                                             uncertainty, *limit, name(conformity)));
  };
  if (options.limits.distance && !validation.after.reads_distances) {
    validation.reasons.push_back(fmt::format("a limit on distances was set, and {} alone were read",
                                             words(validation.after.rms_lengths.begin()->first).plural));
  } else {
    check("distance error, mm", options.limits.distance, validation.after.max_abs_distance,
          larger(two_points, uncertainty_of_readings(validation, std::nullopt)));
  }
  if (options.limits.volumetric && validation.poses.empty()) {
    validation.reasons.emplace_back("a limit on aligned positions was set, and no points were read");
  } else {
    check("aligned position error, mm", options.limits.volumetric, validation.after.max_volumetric_aligned,
          means.point);
  }
  if (validation.after.max_abs_rotation) {
    check("rotation error, rad", options.limits.rotation, *validation.after.max_abs_rotation,
          larger(means.rotation.times(std::sqrt(2.0)), uncertainty_of_rotations(measurements, options)));
  } else if (validation.after.max_orientation) {
    check("orientation error, rad", options.limits.rotation, *validation.after.max_orientation, means.rotation);
  } else if (options.limits.rotation) {
    validation.reasons.emplace_back("a limit on rotation was set, and no rotation was read");
  }
  if (!options.limits.any()) require_gain(two_points.expanded(), validation);
  if (validation.agreement && validation.agreement->contradicts()) {
    const Agreement& agreement = *validation.agreement;
    std::string text = fmt::format(
        "these readings contradict the uncertainty that the calibration states: they lie {:.1f} times as far from its "
        "predictions as that and their noise explain; has the machine changed since (a knock, a repair, another load), "
        "or do they scatter more than is stated?",
        std::sqrt(agreement.chi_square / agreement.freedom));
    (options.limits.any() ? validation.notes : validation.reasons).push_back(std::move(text));
  }
  validation.accepted = validation.reasons.empty();
}

void validate_points(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                     const ValidationOptions& options, Validation& validation) {
  if (measurements.series.empty()) return;
  std::vector<PredictedPose> predicted;
  std::vector<Pose> poses;
  for (const Station& station : measurements.stations) {
    predicted.push_back(predict(robot, known, believed_joints(robot, station)));
    poses.push_back(predicted.back().pose);
  }
  const CalibrationOptions as_fitted = detail::as_for_a_fit(options);
  std::optional<detail::Placement> placement;  // costs a fit
  for (std::size_t s = 0; s < measurements.series.size(); ++s) {
    const PointSeries& series = measurements.series[s];
    if (series.is_of_body() && !placement) {
      placement.emplace(robot, measurements, as_fitted, known.errors);
    }
    const detail::Located located =
        series.is_of_body() ? detail::locate_body(*placement, s) : detail::locate(series, poses, options);
    if (located.order.size() < kFewestPoses) {
      throw InvalidArgument(fmt::format("{}: expected at least {} different poses, got {}", series.name, kFewestPoses,
                                        located.order.size()));
    }
    std::vector<PosePair> before, after;
    for (const std::size_t station : located.order) {
      const std::vector<Pose>& repeats = located.repeats.at(station);
      const Pose measured = detail::mean_of(repeats), commanded = measurements.stations[station].commanded;
      before.push_back({commanded, measured});
      after.push_back({poses[station], measured});
      validation.poses.push_back(
          {series.name, measurements.stations[station].name, before.back(), after.back(), located.rotations, {}});
      if (known.covariance.size() > 0) validation.poses.back().covariance = predicted[station].covariance;
      if (repeats.size() < 2) continue;
      detail::add_criteria(measurements.stations[station].name, commanded, repeats,
                           {measurements.stations[located.order.front()].commanded,
                            detail::mean_of(located.repeats.at(located.order.front()))},
                           located.rotations, validation.iso9283);
    }
    widen(validation.before, summarize(before, located.rotations));
    widen(validation.after, summarize(after, located.rotations));
  }
}

}  // namespace

std::string_view name(Conformity conformity) {
  switch (conformity) {
    case Conformity::conforming:
      return "conforming";
    case Conformity::not_conforming:
      return "not conforming";
    case Conformity::undecided:
      return "undecided";
  }
  return "";
}

namespace {

Validation judged(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                  const ValidationOptions& options) {
  Validation validation;
  validate_points(robot, known, measurements, options, validation);
  const auto [before, after] = detail::add_agreement(robot, known, measurements, options, validation);
  validation.before.max_orientation = before.max_orientation;
  validation.after.max_orientation = after.max_orientation;
  if (!validation.readings.empty()) {
    add_readings(before, !validation.poses.empty(), validation.before);
    add_readings(after, !validation.poses.empty(), validation.after);
  }
  check_limits(measurements, options, validation);
  return validation;
}

/// Another mount, with which bodies are turned by far less than with the one that is stated.
std::optional<ReflectorMount> likelier_mount(const Robot& robot, const KnownErrors& known,
                                             const Measurements& measurements, ValidationOptions options,
                                             const std::optional<double>& stated) {
  constexpr double kFar = 0.05, kLess = 0.2;  // rad; share
  if (!stated || *stated < kFar) return std::nullopt;
  const ReflectorMount as_stated = options.reflectors;
  for (const ReflectorMount mount : kReflectorMounts) {
    if (mount == as_stated) continue;
    options.reflectors = mount;
    const auto off = judged(robot, known, measurements, options).after.max_orientation;
    if (off && *off < kLess * *stated) return mount;
  }
  return std::nullopt;
}

}  // namespace

Validation validate(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                    const ValidationOptions& options) {
  check(measurements, robot.limb_count());
  if (measurements.series.empty() && measurements.distances.empty() && measurements.lengths.empty()) {
    throw InvalidArgument("validation: expected at least one reading, got none");
  }
  Validation validation = judged(robot, known, measurements, options);
  if (const auto mount = likelier_mount(robot, known, measurements, options, validation.after.max_orientation)) {
    validation.accepted = false;
    validation.reasons.insert(validation.reasons.begin(),
                              fmt::format("the readings are those of a body with --reflectors {}", name(*mount)));
  }
  return validation;
}

}  // namespace paracal
