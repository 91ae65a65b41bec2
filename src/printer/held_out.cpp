#include "paracal/printer/held_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>

#include "numerics/distributions.hpp"
#include "printer_fit.hpp"

namespace paracal {
namespace {

/// Places among heights and then distances, ascending.
using Group = std::vector<std::size_t>;

/// Heights in sixths around the middle of the bed.
std::vector<Group> sectors(const DeltaGeometry& geometry, const std::vector<BedReading>& heights) {
  constexpr std::size_t kSectors = 6;
  std::vector<double> azimuth;
  for (const BedReading& one : heights) {
    const Eigen::Vector3d place = nozzle(geometry, one.drops).value_or(Eigen::Vector3d::Zero());
    azimuth.push_back(std::atan2(place.y(), place.x()));
  }
  Group order(heights.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t k) { return azimuth[k]; });
  std::vector<Group> groups(kSectors);
  for (std::size_t k = 0; k < order.size(); ++k) groups[k * kSectors / order.size()].push_back(order[k]);
  for (Group& group : groups) std::ranges::sort(group);
  return groups;
}

std::vector<Group> groups_of(const DeltaGeometry& geometry, const DeltaReadings& readings) {
  constexpr std::size_t kFewest = 13;  // with fewer, a sixth of them is more than the rest can spare
  if (readings.distances.empty() && readings.heights.size() >= kFewest) return sectors(geometry, readings.heights);
  std::vector<Group> groups;
  for (std::size_t k = 0; k < readings.heights.size() + readings.distances.size(); ++k) groups.push_back({k});
  return groups;
}

DeltaReadings without(const DeltaReadings& all, const Group& group) {
  const auto out = [&](std::size_t place) { return std::ranges::binary_search(group, place); };
  DeltaReadings rest;
  for (std::size_t k = 0; k < all.heights.size(); ++k) {
    if (!out(k)) rest.heights.push_back(all.heights[k]);
  }
  for (std::size_t k = 0; k < all.distances.size(); ++k) {
    if (!out(all.heights.size() + k)) rest.distances.push_back(all.distances[k]);
  }
  return rest;
}

/// Predicted minus measured; NaN where the spheres have no point in common.
double error(const DeltaGeometry& geometry, const DeltaReadings& all, std::size_t place, double bias) {
  if (place < all.heights.size()) {
    const BedReading& reading = all.heights[place];
    const auto at = nozzle(geometry, reading.drops);
    return at ? at->z() - reading.height : NAN;
  }
  const PrintedDistance& reading = all.distances[place - all.heights.size()];
  const auto from = nozzle(geometry, reading.from), to = nozzle(geometry, reading.to);
  return from && to ? (*to - *from).norm() + bias - reading.distance : NAN;
}

/// Weighted with what readings of each kind are worth.
double weighted(const HeldOutReading& reading, double error) {
  const NoiseModel noise = CalibrationOptions{}.noise;
  return error / (reading.distance ? noise.distance : noise.height);
}

PairedGain gain_of(const std::vector<HeldOutReading>& readings, double HeldOutReading::*by) {
  constexpr double kTail = 0.05;
  const auto count = static_cast<double>(readings.size());
  if (readings.size() < 2) return {};
  double saved = 0.0, mean = 0.0, spread = 0.0;
  const auto drop = [&](const HeldOutReading& one) {
    return std::pow(weighted(one, one.saved), 2) - std::pow(weighted(one, one.*by), 2);
  };
  for (const HeldOutReading& one : readings) {
    saved += std::pow(weighted(one, one.saved), 2) / count;
    mean += drop(one) / count;
  }
  for (const HeldOutReading& one : readings) spread += std::pow(drop(one) - mean, 2) / (count - 1.0);
  const double half = detail::students_t_quantile(kTail, count - 1.0) * std::sqrt(spread / count);
  if (!(saved > 0.0)) return {};
  return {mean / saved, (mean - half) / saved, std::min((mean + half) / saved, 1.0)};  // no square is below zero
}

}  // namespace

PredictionErrors HeldOut::errors(double HeldOutReading::*by) const {
  double heights = 0.0, distances = 0.0;
  const auto count = std::ranges::count(readings, true, &HeldOutReading::distance);
  for (const HeldOutReading& one : readings) (one.distance ? distances : heights) += std::pow(one.*by, 2);
  const auto rms = [](double sum, std::ptrdiff_t of) {
    return of == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(of));
  };
  return {rms(heights, std::ssize(readings) - count), rms(distances, count)};
}

PairedGain HeldOut::gain(double HeldOutReading::*by) const { return gain_of(readings, by); }

bool HeldOut::some_kind_worse(double HeldOutReading::*by) const {
  return std::ranges::any_of(std::array{false, true}, [&](bool distance) {
    std::vector<HeldOutReading> kind;
    std::ranges::copy_if(readings, std::back_inserter(kind),
                         [&](const HeldOutReading& one) { return one.distance == distance; });
    return gain_of(kind, by).high < 0.0;
  });
}

std::optional<HeldOut> hold_out(const DeltaGeometry& start, const DeltaReadings& readings, bool seeks_bias,
                                double bow_radius, bool saved_is_fit) {
  HeldOut result;
  const std::vector<Group> groups = groups_of(start, readings);
  result.groups = groups.size();
  result.readings.resize(readings.heights.size() + readings.distances.size());
  const auto parameters = firmware_basis(start.actuator, !readings.distances.empty()).cols();
  for (const Group& group : groups) {
    const DeltaReadings rest = without(readings, group);
    if (rest.heights.empty() || std::ssize(rest.heights) + std::ssize(rest.distances) < parameters) return std::nullopt;
    const auto fit = detail::fit_printer(start, rest, {.seeks_bias = seeks_bias, .bow_radius = bow_radius});
    if (!fit) return std::nullopt;
    const DeltaProjection written = fit->written();
    const double bias = fit->calibration.distance_bias.value_or(0.0);
    for (const std::size_t place : group) {
      const DeltaGeometry& saved = saved_is_fit ? fit->firmware.geometry : start;
      result.readings[place] = {.distance = place >= readings.heights.size(),
                                .saved = error(saved, readings, place, bias),
                                .firmware = error(fit->firmware.geometry, readings, place, bias),
                                .written = error(written.geometry, readings, place, bias)};
      const HeldOutReading& one = result.readings[place];
      if (!std::isfinite(one.saved + one.firmware + one.written)) return std::nullopt;
    }
  }
  return result;
}

}  // namespace paracal
