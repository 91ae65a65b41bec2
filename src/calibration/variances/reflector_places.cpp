#include "reflector_places.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "calibration/readings/points.hpp"

namespace paracal::detail {
namespace {

bool shows_places(const Measurements& measurements) {
  return !measurements.series.empty() && std::ranges::all_of(measurements.series, [](const PointSeries& series) {
    return std::ranges::all_of(series.readings,
                               [](const PointReading& one) { return !one.second && !one.orientation; });
  });
}

/// How a mount stands at each station, from how it stands in the mean.
std::vector<Eigen::Matrix3d> turns_of(const std::vector<StationState>& stations, ReflectorMount mount) {
  std::vector<Eigen::Matrix3d> turns;
  Eigen::Matrix3d middle = Eigen::Matrix3d::Zero();
  for (const StationState& one : stations) {
    turns.push_back(mount_rotation(one.plate, one.rotation, mount));
    middle += turns.back() / static_cast<double>(stations.size());
  }
  for (Eigen::Matrix3d& one : turns) one -= middle;
  return turns;
}

}  // namespace

std::vector<ReflectorPlace> reflector_places(const StageFit& fit, const Measurements& measurements,
                                             const LinearReadings& readings) {
  constexpr double kTurned = 0.02;  // rad: a mount that turns less shows no place
  const Observation& observation = fit.observation();
  const auto stations = observation.stations(fit.fit().parameters);
  const auto turns_phi = [&] {
    const auto [least, most] = std::ranges::minmax(*stations, {}, &StationState::rotation);
    return most.rotation - least.rotation > kTurned;
  };
  if (!observation.has_centred_reflectors() || !shows_places(measurements) || !stations) return {};
  std::vector<ReflectorPlace> all;
  for (const ReflectorMount mount : kReflectorMounts) {
    if (mount != ReflectorMount::plate && !turns_phi()) continue;  // else as the plate itself
    const std::vector<Eigen::Matrix3d> turns = turns_of(*stations, mount);
    if (std::ranges::none_of(turns, [](const Eigen::Matrix3d& one) { return one.norm() > kTurned; })) continue;
    Eigen::MatrixXd effect = Eigen::MatrixXd::Zero(readings.y.size(), 3);
    for (std::size_t k = 0; k < readings.blocks.size(); ++k) {
      const Group& group = observation.groups()[readings.blocks[k].each.front().group];
      if (observation.series_of(group).quantity() != Quantity::coordinate) continue;
      const Eigen::MatrixXd moved = observation.by_position(group, {*stations, fit.fit().parameters});
      effect.middleRows(readings.first[k], moved.rows()) = moved * turns[group.station];
    }
    all.push_back({mount, fmt::format("the reflector is beside {}", centre_of(mount)), std::move(effect)});
  }
  return all;
}

}  // namespace paracal::detail
