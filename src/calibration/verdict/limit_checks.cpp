#include "validation_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

#include "visits.hpp"

namespace paracal::detail {
namespace {

/// Of the least certain reading, mm.
Uncertainty uncertainty_of_readings(const Validation& validation, std::optional<LengthKind> of) {
  Uncertainty largest;
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
    std::string reason = fmt::format("the largest {} increased from {:.3f} to {:.3f} mm", what, before, after);
    if (after - before <= uncertainty) {
      reason = fmt::format(
          "the largest {} changed from {:.3f} to {:.3f} mm: not significant, because it is measured with U {:.3f} mm",
          what, before, after, uncertainty);
    }
    validation.reasons.push_back(std::move(reason));
  };
  if (!validation.poses.empty()) {
    return require("aligned error", validation.before.max_volumetric_aligned, validation.after.max_volumetric_aligned,
                   two_points, validation.after.rms_distance);
  }
  if (validation.after.reads_distances) {
    const auto [before, after] = largest_of_readings(validation, std::nullopt);
    return require("distance error", before, after, uncertainty_of_readings(validation, std::nullopt).expanded(),
                   validation.after.rms_distance);
  }
  const auto& [kind, rms] = *validation.after.rms_lengths.begin();
  const auto [before, after] = largest_of_readings(validation, kind);
  require(fmt::format("{} error", words(kind).noun), before, after,
          uncertainty_of_readings(validation, kind).expanded(), rms);
}

/// Of a rotation that was read with a distance, rad; 0 where none was.
Uncertainty uncertainty_of_rotations(const Measurements& measurements, const ValidationOptions& options) {
  const bool any =
      std::ranges::any_of(measurements.distances, [](const auto& one) { return one.rotation.has_value(); });
  return {any ? options.noise.rotation : 0.0};
}

/// How far measured points of a series lie from its home, and from their middle: by so much the scale of an instrument
/// shifts them.
struct Extent {
  double from_home = 0.0, from_middle = 0.0;
};

Extent extent_of(const Validation& validation) {
  std::map<std::string_view, std::vector<Eigen::Vector3d>> series;
  for (const ValidatedPose& one : validation.poses) series[one.series].push_back(one.after.actual.position);
  Extent extent;
  for (const auto& [name, points] : series) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : points) middle += point / static_cast<double>(points.size());
    for (const Eigen::Vector3d& point : points) {
      extent.from_home = std::max(extent.from_home, (point - points.front()).norm());
      extent.from_middle = std::max(extent.from_middle, (point - middle).norm());
    }
  }
  return extent;
}

double longest_distance(const Measurements& measurements) {
  double longest = 0.0;
  for (const DistanceReading& one : measurements.distances) longest = std::max(longest, one.distance);
  return longest;
}

/// What is held against a limit: the largest of `count` errors of so many coordinates.
struct Largest {
  const char* quantity;
  double error = 0.0;  ///< mm or rad
  Uncertainty of_each = {};
  std::size_t count = 0;
  double coordinates = 1.0;
};

/// Reasons against the calibration are what is not proven within its limit.
class LimitJudge {
 public:
  LimitJudge(const Measurements& measurements, const ValidationOptions& options, Validation& validation)
      : measurements_(measurements),
        options_(options),
        validation_(validation),
        means_(means_of_visits(measurements, options)),
        extent_(extent_of(validation)) {
    std::ranges::move(means_.notes, std::back_inserter(validation_.notes));
  }

  void judge() {
    check_distances();
    check_positions();
    check_rotations();
  }

  /// U of the difference of two points, which varies sqrt(2) times as much as a coordinate.
  double expanded_of_two_points() const { return two_points().expanded(); }

 private:
  Uncertainty two_points() const {
    return means_.point.times(std::sqrt(2.0)).with(options_.scale_std * extent_.from_home);
  }
  std::size_t readings() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(validation_.readings, [](const CheckedReading& one) { return !one.length; }));
  }

  void check_distances() {
    if (options_.limits.distance && !validation_.after.reads_distances) {
      return refuse(fmt::format("expected distances or points for the limit on distances, got only {}",
                                words(validation_.after.rms_lengths.begin()->first).plural));
    }
    // A bias that is sought takes up what all distances have in common, of the machine, too.
    const Uncertainty read = uncertainty_of_readings(validation_, std::nullopt)
                                 .with(options_.scale_std * longest_distance(measurements_))
                                 .with(options_.noise.distance_bias);
    check({"distance error, mm", validation_.after.max_abs_distance, larger(two_points(), read),
           validation_.poses.size() + readings()},
          options_.limits.distance);
  }

  /// |dr| of an aligned point varies along itself as one coordinate does, at most as all three do.
  void check_positions() {
    if (options_.limits.volumetric && validation_.poses.empty()) {
      return refuse("expected points for the limit on aligned positions, got none");
    }
    check({"aligned position error, mm", validation_.after.max_volumetric_aligned,
           means_.point.with(options_.scale_std * extent_.from_middle), validation_.poses.size(), 3.0},
          options_.limits.volumetric);
  }

  void check_rotations() {
    const std::optional<double>& limit = options_.limits.rotation;
    if (validation_.after.max_abs_rotation) {
      check({"rotation error, rad", *validation_.after.max_abs_rotation,
             larger(means_.rotation.times(std::sqrt(2.0)), uncertainty_of_rotations(measurements_, options_)),
             validation_.poses.size() + readings()},
            limit);
    } else if (validation_.after.max_orientation) {
      check({"orientation error, rad", *validation_.after.max_orientation, means_.rotation,
             measurements_.stations.size(), 3.0},
            limit);
    } else if (limit) {
      refuse("expected rotations for the limit on rotation, got none");
    }
  }

  void check(const Largest& one, const std::optional<double>& limit) {
    if (!limit) return;
    const double U = one.of_each.expanded();
    const double least = std::max(0.0, one.error - one.of_each.expanded_of_all(one.count, one.coordinates));
    const Conformity conformity = one.error + U <= *limit ? Conformity::conforming
                                  : least > *limit        ? Conformity::not_conforming
                                                          : Conformity::undecided;
    validation_.checks.push_back({one.quantity, one.error, U, least, one.of_each.coverage(), *limit, conformity});
    if (conformity == Conformity::conforming) return;
    refuse(fmt::format("{}: measured {:.4g} (95 % interval {:.3g} to {:.3g}), limit {:.4g}: {}", one.quantity,
                       one.error, least, one.error + U, *limit, name(conformity)));
  }

  void refuse(std::string_view reason) { validation_.reasons.emplace_back(reason); }

  const Measurements& measurements_;
  const ValidationOptions& options_;
  Validation& validation_;
  MeansOfVisits means_;
  Extent extent_;
};

}  // namespace

void check_limits(const Measurements& measurements, const ValidationOptions& options, Validation& validation) {
  LimitJudge judge(measurements, options, validation);
  judge.judge();
  if (!options.limits.any()) require_gain(judge.expanded_of_two_points(), validation);
  if (validation.agreement && validation.agreement->contradicts()) {
    const Agreement& agreement = *validation.agreement;
    std::string text = fmt::format(
        "the readings differ from the predictions {:.1f} times as much as uncertainty and noise explain. Check whether "
        "the machine changed (collision, repair, load) or the stated sigma is too small",
        std::sqrt(agreement.chi_square / agreement.freedom));
    // Positions that are proven to be good enough are; rotations say nothing of positions.
    const bool are_held = options.limits.distance || options.limits.volumetric;
    (are_held ? validation.notes : validation.reasons).push_back(std::move(text));
  }
  if (options.limits.any()) validation.accepted = validation.reasons.empty();
}

}  // namespace paracal::detail
