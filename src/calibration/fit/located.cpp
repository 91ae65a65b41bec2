#include "located.hpp"

#include <algorithm>

namespace paracal::detail {
namespace {

/// Frame of a series: that which brings the station means closest to the predicted poses.
RigidMotion frame_of(const PointSeries& series, const std::vector<Pose>& predicted, const ValidationOptions& options) {
  if (options.frame == Frame::robot) return {};
  std::vector<Eigen::Vector3d> from, to;
  for (const PointReading& reading : series.readings) {
    from.push_back(reading.point);
    to.push_back(predicted[reading.station].position);
  }
  return rigid_fit(from, to);
}

double rotation_zero_of(const PointSeries& series, const std::vector<Pose>& predicted,
                        const ValidationOptions& options) {
  if (options.rotation_zero == RotationZero::known) return 0.0;
  double sum = 0.0;
  int count = 0;
  for (const PointReading& reading : series.readings) {
    if (!reading.rotation) continue;
    sum += predicted[reading.station].rotation - *reading.rotation;
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace

Located locate(const PointSeries& series, const std::vector<Pose>& predicted, const ValidationOptions& options) {
  const RigidMotion to_robot = frame_of(series, predicted, options);
  const double zero = rotation_zero_of(series, predicted, options);
  Located located;
  located.rotations = std::ranges::all_of(series.readings, [](const auto& r) { return r.rotation.has_value(); });
  for (const PointReading& reading : series.readings) {
    auto& repeats = located.repeats[reading.station];
    if (repeats.empty()) located.order.push_back(reading.station);
    repeats.push_back({to_robot(reading.point), reading.rotation.value_or(0.0) + zero});
  }
  std::ranges::sort(located.order);  // stations keep the order of the file, in which home is the first
  return located;
}

Located locate_body(const Placement& placement, std::size_t series) {
  Located located;
  for (const Group& group : placement.observation.groups_of(series)) {
    const StationState& station = (*placement.stations)[group.station];
    const Residual off = placement.residual(group);
    located.rotations = off.rotation.has_value();
    located.repeats[group.station].push_back(
        {station.plate.position + off.length, station.rotation + off.rotation.value_or(0.0)});
  }
  for (const auto& [station, poses] : located.repeats) located.order.push_back(station);
  return located;
}

Pose mean_of(const std::vector<Pose>& poses) {
  Pose mean{Eigen::Vector3d::Zero(), 0.0};
  for (const Pose& pose : poses) {
    mean.position += pose.position / static_cast<double>(poses.size());
    mean.rotation += pose.rotation / static_cast<double>(poses.size());
  }
  return mean;
}

}  // namespace paracal::detail
