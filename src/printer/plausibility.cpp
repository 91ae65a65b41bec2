#include "paracal/printer/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include "paracal/error.hpp"
#include "paracal/printer/common_shift.hpp"
#include "paracal/units.hpp"

namespace paracal {
namespace {

double spread(const std::array<double, 3>& values) {
  const auto [least, most] = std::ranges::minmax(values);
  return most - least;
}

/// What the owner reads in the file as a rod.
const char* rod_name(const DeltaGeometry& geometry) {
  return geometry.actuator == Actuator::linear ? "rods" : "lower arms";
}

/// The fit changes a length of the file by more than is usual.
void check_change(const char* what, double before, double after, double size, const PrinterLimits& limits,
                  std::vector<std::string>& complaints) {
  if (std::abs(after - before) <= limits.changed * size) return;
  complaints.push_back(
      fmt::format("{} is {:.2f} mm in the file but {:.2f} mm by the readings: measure it", what, before, after));
}

enum class Changed : std::uint8_t { all, heights, distances };

DeltaReadings changed(DeltaReadings readings, const auto& change, Changed which = Changed::all) {
  for (BedReading& one : readings.heights) {
    if (which != Changed::distances) one.drops = change(one.drops);
  }
  for (PrintedDistance& one : readings.distances) {
    if (which == Changed::heights) continue;
    one.from = change(one.from);
    one.to = change(one.to);
  }
  return readings;
}

/// Root mean square over all readings that a geometry leaves, mm; infinite where it does not close.
double misfit(const DeltaGeometry& geometry, const DeltaReadings& readings) {
  const DeltaFit judged = judge_as_firmware(geometry, readings);
  return judged.ok() ? std::hypot(judged.rms_height, judged.rms_distance) : INFINITY;
}

/// Ratios of step sizes that a wrong line makes.
constexpr std::array kStepRatios{0.0625, 0.1, 0.125, 0.2,         0.25,        1.0 / 3.0,  0.4,  0.5,
                                 0.625,  0.8, 0.9,   16.0 / 17.0, 17.0 / 16.0, 10.0 / 9.0, 1.25, 1.6,
                                 2.0,    2.5, 3.0,   4.0,         5.0,         8.0,        10.0, 16.0};

/// The steps of all towers (-1) or of one, of readings of one kind or of all.
DeltaReadings with_steps(const DeltaReadings& readings, double ratio, int tower, Changed which = Changed::all) {
  const auto scaled = [&](JointDrops drops) {
    for (std::size_t i = 0; i < 3; ++i) drops[i] *= tower < 0 || tower == static_cast<int>(i) ? ratio : 1.0;
    return drops;
  };
  return changed(readings, scaled, which);
}

/// Heights and distances that the file explains if only one kind is read with other steps: measured at two times, with
/// another line of the file in force.
std::optional<std::string> two_steps(const DeltaGeometry& saved, const DeltaReadings& readings, double& best) {
  std::optional<std::string> cause;
  if (readings.heights.empty() || readings.distances.empty()) return cause;
  for (const double ratio : kStepRatios) {
    for (const Changed which : {Changed::heights, Changed::distances}) {
      const double left = misfit(saved, with_steps(readings, ratio, -1, which));
      if (left >= best) continue;
      best = left;
      const bool heights = which == Changed::heights;
      cause = fmt::format(
          "the {0} fit the file, and the {1} fit it if their steps are {2:.4g} times as large: both were measured with "
          "different steps per mm. Measure the {1} again",
          heights ? "distances" : "heights", heights ? "heights" : "distances", ratio);
    }
  }
  return cause;
}

/// Ratio by which all (or one tower's) steps would have to be taken to suit the file.
std::optional<std::string> wrong_steps(const DeltaGeometry& saved, const DeltaReadings& readings, double enough) {
  double best = enough;
  std::optional<std::string> cause = two_steps(saved, readings, best);
  for (const double ratio : kStepRatios) {
    for (int tower = -1; tower < 3; ++tower) {
      const double left = misfit(saved, with_steps(readings, ratio, tower));
      if (left >= best) continue;
      best = left;
      cause = fmt::format(
          "the readings fit the file if the steps of {} are {:.4g} times as large: check rotation_distance, "
          "gear_ratio, "
          "microsteps and full_steps_per_rotation (steps per mm), now and when the readings were taken",
          tower < 0 ? std::string("all towers") : fmt::format("tower {}", "ABC"[tower]), ratio);
    }
  }
  return cause;
}

std::optional<std::string> wrong_order(const DeltaGeometry& saved, const DeltaReadings& readings, double enough) {
  std::array<std::size_t, 3> order{0, 1, 2};
  double best = enough;
  std::optional<std::string> cause;
  while (std::ranges::next_permutation(order).found) {
    const auto exchanged = [&](const JointDrops& drops) {
      return JointDrops{drops[order[0]], drops[order[1]], drops[order[2]]};
    };
    const double left = misfit(saved, changed(readings, exchanged));
    if (left >= best) continue;
    best = left;
    cause = fmt::format("the readings fit the file with the towers in the order {}{}{}: check the order of the towers",
                        "ABC"[order[0]], "ABC"[order[1]], "ABC"[order[2]]);
  }
  return cause;
}

}  // namespace

std::vector<std::string> implausible(const DeltaGeometry& geometry, const PrinterLimits& limits) {
  std::vector<std::string> complaints;
  const double rod = mean_of(geometry.rod);
  if (!(std::ranges::min(geometry.rod) > 0.0 && geometry.radius > 0.0)) {
    return {fmt::format("expected radius and rods above 0, got {:.2f} mm and rods of {:.2f} mm (mean)", geometry.radius,
                        rod)};
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = geometry.tower_angle[i],
                 off = std::remainder(angle - design_angle(angle), 2.0 * std::numbers::pi);
    if (std::abs(off) <= limits.tower) continue;
    complaints.push_back(
        fmt::format("tower {} is {:+.1f} deg from its design angle: check it", "ABC"[i], to_degrees(off)));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double apart =
        std::remainder(geometry.tower_angle[i] - geometry.tower_angle[(i + 1) % 3], 2.0 * std::numbers::pi);
    if (std::abs(std::abs(apart) - to_radians(120.0)) <= 2.0 * limits.tower) continue;
    complaints.push_back(fmt::format("towers {} and {} are {:.1f} deg apart, not 120: check their angles", "ABC"[i],
                                     "ABC"[(i + 1) % 3], std::abs(to_degrees(apart))));
  }
  if (spread(geometry.rod) > limits.rods_apart * rod) {
    complaints.push_back(fmt::format("{} of {:.2f}, {:.2f} and {:.2f} mm differ too much: measure them",
                                     rod_name(geometry), geometry.rod[0], geometry.rod[1], geometry.rod[2]));
  }
  if (spread(geometry.endstop) > limits.endstops_apart * rod) {
    complaints.push_back(fmt::format("endstops at {:.2f}, {:.2f} and {:.2f} mm differ too much: check them",
                                     geometry.endstop[0], geometry.endstop[1], geometry.endstop[2]));
  }
  if (geometry.actuator == Actuator::linear) {
    const double share = geometry.radius / rod;
    if (share < limits.smallest_radius || share > limits.largest_radius) {
      complaints.push_back(fmt::format("a delta radius of {:.2f} mm does not match rods of {:.2f} mm: measure both",
                                       geometry.radius, rod));
    }
  }
  return complaints;
}

namespace {

constexpr double kSteps = 0.2;  // of what the file leaves must be left by steps of another size

/// Two heights of one place that differ by more than any probe.
std::optional<std::string> contradiction(const DeltaGeometry& saved, const DeltaReadings& readings, double worst) {
  constexpr double kOnePlace = 0.5;   // mm
  std::vector<Eigen::Vector3d> beds;  // where the nozzle was, less what it read
  for (const BedReading& one : readings.heights) {
    if (const auto place = nozzle(saved, one.drops)) beds.emplace_back(*place - one.height * Eigen::Vector3d::UnitZ());
  }
  for (std::size_t k = 0; k < beds.size(); ++k) {
    for (std::size_t j = 0; j < k; ++j) {
      const Eigen::Vector3d apart = beds[k] - beds[j];
      if (apart.head<2>().norm() > kOnePlace || std::abs(apart.z()) <= worst) continue;
      return fmt::format("two heights of the bed at ({:.1f}, {:.1f}) mm differ by {:.2f} mm: measure again",
                         beds[k].x(), beds[k].y(), std::abs(apart.z()));
    }
  }
  return std::nullopt;
}

/// What a fit of the readings says against the file.
std::vector<std::string> complaints_of(const DeltaGeometry& saved, const DeltaFit& fit, const PrinterLimits& limits) {
  if (!fit.ok()) return {"the firmware's fit of these readings does not converge: check them"};
  std::vector<std::string> complaints;
  if (fit.rms_height > limits.worst_height || fit.rms_distance > limits.worst_distance) {
    complaints.push_back(
        fmt::format("no delta printer explains these readings: the best fit leaves {:.2f} mm in heights and {:.2f} mm "
                    "in distances (rms)",
                    fit.rms_height, fit.rms_distance));
  }
  const bool linear = saved.actuator == Actuator::linear;
  const double rod = mean_of(saved.rod);
  check_change("the radius", saved.radius, fit.geometry.radius, linear ? saved.radius : rod, limits, complaints);
  for (std::size_t i = 0; i < 3; ++i) {
    check_change(linear ? "a rod" : "a lower arm", saved.rod[i], fit.geometry.rod[i], rod, limits, complaints);
    check_change("an endstop", saved.endstop[i], fit.geometry.endstop[i], rod, limits, complaints);
  }
  for (const std::string& one : implausible(fit.geometry, limits))
    complaints.push_back("in the fit of the readings, " + one);
  return complaints;
}

/// What a wrong line in the file, or readings in another order, would explain.
std::optional<std::string> likely_cause(const DeltaGeometry& saved, const DeltaReadings& readings, const DeltaFit& fit,
                                        bool is_wrong, const PrinterLimits& limits) {
  constexpr double kOrder = 0.5;    // of what the file leaves must be left
  constexpr double kNotable = 2.0;  // times what the fit leaves
  const double left = misfit(saved, readings), best = std::hypot(fit.rms_height, fit.rms_distance);
  if (is_wrong || left > limits.worst_saved) {
    if (auto steps = wrong_steps(saved, readings, std::min(kSteps * left, 5.0 * limits.worst_height))) return steps;
  }
  if (!is_wrong && !(left > limits.least_notable && left > kNotable * best)) return std::nullopt;
  return wrong_order(saved, readings, kOrder * left);
}

}  // namespace

std::vector<std::string> implausible(const DeltaGeometry& saved, const DeltaReadings& readings, const DeltaFit& fit,
                                     const PrinterLimits& limits) {
  std::vector<std::string> complaints;
  // Fewer readings than numbers leave the fit anywhere.
  const std::size_t count = readings.heights.size() + readings.distances.size();
  if (count >= static_cast<std::size_t>(fit.parameters)) complaints = complaints_of(saved, fit, limits);
  if (auto twice = contradiction(saved, readings, limits.worst_repeat)) complaints.push_back(std::move(*twice));
  if (auto cause = likely_cause(saved, readings, fit, !complaints.empty(), limits)) {
    return {std::move(*cause)};  // the others follow from it
  }
  return complaints;
}

std::optional<std::string> wrong_sign(const DeltaGeometry& saved, const DeltaReadings& readings,
                                      const PrinterLimits& limits) {
  double highest = -std::numeric_limits<double>::infinity();
  DeltaReadings right = readings;
  for (BedReading& one : right.heights) {
    if (one.by_hand) continue;
    highest = std::max(highest, one.height);
    one.height = -one.height;
  }
  if (!std::isfinite(highest) || highest > limits.lowest_trigger) return std::nullopt;
  const std::array<double, 3> endstop = common_shift(saved, right, 0.0).endstop;
  return fmt::format(
      "by the readings, the probe triggers with the nozzle {0:.1f} mm below the bed, which is impossible: check the "
      "sign "
      "of z_offset (column height_mm). With {0:+.1f} mm the endstops are {1:.1f} {2:.1f} {3:.1f} mm",
      -highest, endstop[0], endstop[1], endstop[2]);
}

void require_places(const DeltaGeometry& saved, const DeltaReadings& readings, const PrinterLimits& limits) {
  std::vector<Eigen::Vector2d> places;
  for (const BedReading& one : readings.heights) {
    if (const auto at = nozzle(saved, one.drops)) places.emplace_back(at->head<2>());
  }
  if (places.empty()) return;
  double spread = 0.0;
  for (const Eigen::Vector2d& place : places) spread = std::max(spread, (place - places.front()).norm());
  if (spread >= limits.least_spread) return;
  throw InvalidArgument(fmt::format(
      "expected heights across the bed, got all {} within {:.0f} mm of ({:.0f}, {:.0f}) mm: measure at the "
      "rim, too",
      places.size(), limits.least_spread, std::round(places.front().x()) + 0.0, std::round(places.front().y()) + 0.0));
}

bool has_wrong_steps(const DeltaGeometry& saved, const DeltaReadings& readings, const DeltaReadings& shifted) {
  return wrong_steps(saved, readings, kSteps * misfit(saved, shifted)).has_value();
}

}  // namespace paracal
