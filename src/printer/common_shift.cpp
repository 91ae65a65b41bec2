#include "paracal/printer/common_shift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "numerics/median.hpp"
#include "paracal/printer/ladder.hpp"

namespace paracal {
namespace {

/// The place that the nozzle touched by a geometry, and the height of the bed there.
struct Touched {
  Eigen::Vector2d place;
  double bed = 0.0;
};

std::optional<Touched> touched(const DeltaGeometry& geometry, const BedReading& reading) {
  const auto at = nozzle(geometry, reading.drops);
  if (!at) return std::nullopt;
  return Touched{at->head<2>(), at->z() - reading.height};
}

/// The smallest of values that have one sign.
double shared_part(std::vector<double> values, const ShiftLimits& limits) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const std::size_t aside = values.size() < limits.trimmed ? 0 : 1;
  const double least = values[aside], most = values[values.size() - 1 - aside];
  return least > 0.0 ? least : std::min(most, 0.0);
}

}  // namespace

std::vector<std::string> CommonShift::likely_causes() const {
  constexpr double kProbe = 10.0;  // mm: no probe triggers further away
  if (!is_stated) return {};
  std::vector<std::string> causes{"the bed was moved, or another build plate lies on it", "the nozzle was changed",
                                  "an endstop switch was moved, or the homed height in the file is wrong",
                                  "the steps per mm are wrong"};
  const std::string trigger = "the trigger height of the probe (z_offset) is not stated, or has the wrong sign";
  const bool is_likely = has_wrong_sign || std::abs(value) <= kProbe;
  if (has_wrong_sign || !is_by_hand) causes.insert(is_likely ? causes.begin() : causes.end(), trigger);
  return causes;
}

CommonShift common_shift(const DeltaGeometry& saved, const DeltaReadings& readings, double noise,
                         const ShiftLimits& limits) {
  std::vector<double> beds;
  bool is_by_hand = false;
  for (const BedReading& one : readings.heights) {
    if (const auto at = touched(saved, one)) beds.push_back(at->bed);
    is_by_hand |= one.by_hand;
  }
  const double value = shared_part(std::move(beds), limits);
  return {.value = value,
          .is_stated = std::abs(value) > std::max(limits.least, limits.noises * noise),
          .is_by_hand = is_by_hand,
          .endstop = with_bed_higher(saved, value).endstop};
}

namespace {

/// Bed by some values at the places of paper, from the lowest to the highest, mm.
double spread_of_paper(const DeltaGeometry& values, const DeltaReadings& paper) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const BedReading& one : paper.heights) {
    const auto at = touched(values, one);
    if (!at) continue;
    least = std::min(least, at->bed);
    most = std::max(most, at->bed);
  }
  return most - least;
}

/// A probe of one trigger height measures the same bed as the paper, but for that height. Values that level the probe's
/// heights would tilt the paper's by this, mm; 0 where there are too few.
double spread_of_trigger(const DeltaGeometry& saved, const DeltaReadings& readings, const ShiftLimits& limits) {
  DeltaReadings paper, probe;
  for (const BedReading& one : readings.heights) (one.by_hand ? paper : probe).heights.push_back(one);
  if (paper.heights.size() < limits.fewest || probe.heights.size() < limits.fewest_probed) return 0.0;
  const auto levelled = fit_rung(saved, probe, Rung::towers);
  const double spread = levelled ? spread_of_paper(*levelled, paper) : 0.0;
  return spread > 2.0 * spread_of_paper(saved, paper) ? spread : 0.0;
}

}  // namespace

TriggerError trigger_error(const DeltaGeometry& saved, const DeltaReadings& readings, const ShiftLimits& limits) {
  constexpr double kOnePlace = 0.5;  // mm
  std::vector<double> differences;
  for (const BedReading& paper : readings.heights) {
    const auto at = paper.by_hand ? touched(saved, paper) : std::nullopt;
    if (!at) continue;
    for (const BedReading& probe : readings.heights) {
      const auto there = probe.by_hand ? std::nullopt : touched(saved, probe);
      if (there && (there->place - at->place).norm() <= kOnePlace) differences.push_back(at->bed - there->bed);
    }
  }
  TriggerError error{.spread = spread_of_trigger(saved, readings, limits), .places = differences.size()};
  error.varies = error.spread > limits.varying;
  if (differences.empty()) return error;
  error.value = detail::median(differences);
  const double noise = limits.probe * std::numbers::sqrt2;
  error.is_stated = !error.varies && std::abs(error.value) > std::max(limits.least, limits.noises * noise);
  return error;
}

DeltaReadings by_paper(DeltaReadings readings, const TriggerError& error) {
  if (error.varies) std::erase_if(readings.heights, [](const BedReading& one) { return !one.by_hand; });
  for (BedReading& one : readings.heights) {
    if (error.is_stated && !one.by_hand) one.height -= error.value;
  }
  return readings;
}

DeltaGeometry with_bed_higher(const DeltaGeometry& geometry, double shift) {
  DeltaNumbers numbers = numbers_of(geometry);
  numbers.segment<3>(DeltaNumber::endstop).array() -= shift;
  if (geometry.actuator == Actuator::revolute) numbers(DeltaNumber::shoulder) -= shift;
  return with_numbers(geometry, numbers);
}

DeltaReadings without_shift(DeltaReadings readings, double shift) {
  for (BedReading& one : readings.heights) one.height += shift;
  return readings;
}

}  // namespace paracal
