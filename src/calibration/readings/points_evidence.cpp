// What points and the poses of bodies add to the evidence of a fit, and what they are called.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "points.hpp"

namespace paracal::detail {

std::string Points::label(std::size_t index, const std::vector<Station>& stations) const {
  const std::size_t station = readings_[index].station;
  const auto same = [&](const PointReading& reading) { return reading.station == station; };
  std::string text = fmt::format("{} of {}", stations[station].name, name());
  if (std::ranges::count_if(readings_, same) > 1) {
    const auto before =
        std::count_if(readings_.begin(), readings_.begin() + static_cast<std::ptrdiff_t>(index) + 1, same);
    text += fmt::format(", repeat {}", before);
  }
  return text;
}

/// The station where the machine stood closest to it. Two readings that explain each other were swapped.
std::string Points::explanation(std::size_t index, const Placed& at, const std::vector<Station>& stations) const {
  constexpr double kNear = 2.0;  // mm: a calibrated machine's reading lies this close to its station
  const auto near = [&](const PointReading& reading, std::size_t station) {
    return off(reading, at.stations[station], at.unknowns).norm() < kNear;
  };
  const PointReading& reading = readings_[index];
  for (const PointReading& other : readings_) {
    if (other.station == reading.station || !near(reading, other.station)) continue;
    const bool swapped = std::ranges::any_of(
        readings_, [&](const PointReading& one) { return one.station == other.station && near(one, reading.station); });
    return fmt::format("{} {}", swapped ? "swapped with" : "it was taken at", stations[other.station].name);
  }
  return {};
}

std::vector<PosePair> Points::station_pairs(std::span<const Group> of_series, const Placed& at) const {
  struct Mean {
    PosePair pair;
    int points = 0, rotations = 0;
  };
  std::map<std::size_t, Mean> means;
  for (const Group& group : of_series) {
    if (!group.active) continue;
    const StationState& station = at.stations[group.station];
    Mean& mean = means[group.station];
    if (mean.points == 0) {
      const Pose meant{station.plate.position, station.rotation};
      mean.pair = {meant, {Eigen::Vector3d::Zero(), meant.rotation}};
    }
    const Residual residual = this->residual(group.index, at);
    const Eigen::Vector3d measured = station.plate.position - residual.length;
    mean.pair.actual.position += (measured - mean.pair.actual.position) / ++mean.points;
    if (residual.rotation) {
      const double read = station.rotation - *residual.rotation;
      mean.pair.actual.rotation += (read - mean.pair.actual.rotation) / ++mean.rotations;
    }
  }
  std::vector<PosePair> pairs;
  pairs.reserve(means.size());
  for (const auto& [station, mean] : means) pairs.push_back(mean.pair);
  return pairs;
}

void Points::add_to(ErrorTally& tally, std::span<const Group> of_series, const Placed& at) const {
  const std::vector<PosePair> pairs = station_pairs(of_series, at);
  const PoseErrorSummary one = summarize(pairs, shows_rotation());
  PoseErrorSummary& all = tally.summary;
  all.max_abs_distance = std::max(all.max_abs_distance, one.max_abs_distance);
  all.max_volumetric = std::max(all.max_volumetric, one.max_volumetric);
  all.max_volumetric_aligned = std::max(all.max_volumetric_aligned, one.max_volumetric_aligned);
  tally.widen_rotation(one.max_abs_rotation);
  tally.distances.squares += one.rms_distance * one.rms_distance * static_cast<double>(pairs.size() - 1);
  tally.distances.count += pairs.size() - 1;
  for (const Group& group : of_series) {
    if (group.active) tally.widen_orientation(residual(group.index, at).orientation);
  }
}

void Points::list(const Group& group, const std::vector<Station>& stations, const Residual& before,
                  const Residual& after, FitResiduals& all) const {
  all.points.push_back({name(), stations[group.station].name, before.length, after.length, before.rotation,
                        after.rotation, !group.active, before.orientation, after.orientation});
}

void Points::add_set_up(const FoundUnknowns& found, FoundSetUps& all, Remarks& remarks) const {
  all.frames.push_back({name(), frame(found.values), rotation_zero(found.values), second_reflector(found.values),
                        body_ < 0 ? std::nullopt : std::optional(body(found.values))});
  if (body_ < 0 || found.covariance.size() == 0) return;
  // Where the plate hardly turns, the place of a body and that of the frame are one.
  const Eigen::Vector3d variances = found.covariance.diagonal().segment<3>(place_);
  if (variances.maxCoeff() < 0.5 * kBodyReach * kBodyReach) return;
  remarks.assumed.push_back(
      fmt::format("the body of {} has its origin within about {:g} mm of the plate centre (standard deviation per "
                  "axis): the plate rotates too little to determine it",
                  name(), kBodyReach));
}

}  // namespace paracal::detail
