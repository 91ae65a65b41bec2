#include "paracal/calibration/validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "calibration/fit/located.hpp"
#include "calibration/fit/placement.hpp"
#include "calibration/fit/started.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "validation_parts.hpp"

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

/// Adds the errors of distances and lengths to those of points.
void add_readings(const PoseErrorSummary& readings, bool has_points, PoseErrorSummary& all) {
  widen(all, readings);
  all.reads_distances = has_points || readings.reads_distances;
  all.rms_lengths = readings.rms_lengths;
  all.rms_joints = readings.rms_joints;
}

void validate_points(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                     const ValidationOptions& options, Validation& validation) {
  if (measurements.series.empty()) return;
  std::vector<PredictedPose> predicted;
  std::vector<Pose> poses;
  for (const Station& station : measurements.stations) {
    predicted.push_back(predict(robot, known, believed_joints(robot, station), detail::started(robot, station)));
    poses.push_back(predicted.back().pose);
  }
  const CalibrationOptions as_fitted = detail::as_for_a_fit(options);
  const Measurements actual = at_actual_joints(robot, known.drives(), measurements);  // a placement refers to it
  std::optional<detail::Placement> placement;                                         // costs a fit
  for (std::size_t s = 0; s < measurements.series.size(); ++s) {
    const PointSeries& series = measurements.series[s];
    if (series.is_of_body() && !placement) {
      placement.emplace(robot, actual, as_fitted, known.errors);
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
  detail::check_limits(measurements, options, validation);
  return validation;
}

/// The model of errors is checked where it was fitted, and there alone.
void note_extrapolation(const CalibratedRegion& region, const Measurements& measurements, Validation& validation) {
  std::size_t count = 0;
  double farthest = 0.0;
  for (const Station& station : measurements.stations) {
    if (!region.is_left_by(station.commanded.position)) continue;
    ++count;
    farthest = std::max(farthest, region.beyond(station.commanded.position));
  }
  if (count == 0) return;
  validation.notes.push_back(
      fmt::format("{} of {} poses lie{} outside of the region of the calibrated poses, by up to {:.3g} mm: the "
                  "calibration extrapolates there, and errors exceed U more often. Calibrate with poses in the whole "
                  "workspace",
                  count, measurements.stations.size(), count == 1 ? "s" : "", farthest));
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

std::string_view name(Conformity conformity) {
  constexpr std::array kNames{"conforming", "not conforming", "undecided"};
  return kNames.at(static_cast<std::size_t>(conformity));
}

Validation validate(const Robot& robot, const KnownErrors& known, const Measurements& measurements,
                    const ValidationOptions& options) {
  check(measurements, robot.limb_count());
  if (measurements.series.empty() && measurements.distances.empty() && measurements.lengths.empty()) {
    throw InvalidArgument("validation: expected at least one reading, got none");
  }
  Validation validation = judged(robot, known, measurements, options);
  note_extrapolation(known.region, measurements, validation);
  validation.assumed = controller_assumptions(with_readings(options.controller, measurements), robot);
  if (const auto mount = likelier_mount(robot, known, measurements, options, validation.after.max_orientation)) {
    validation.refuse(fmt::format("the readings match a body with --reflectors {}: use that option", name(*mount)));
    std::rotate(validation.reasons.begin(), std::prev(validation.reasons.end()), validation.reasons.end());  // first
  }
  return validation;
}

}  // namespace paracal
