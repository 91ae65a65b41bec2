#include "command_mistakes.hpp"

#include <algorithm>

namespace paracal::detail {
namespace {

template <typename Change>
void change_commands(Measurements& measurements, Change&& change) {
  for (Station& station : measurements.stations) change(station.commanded);
}

}  // namespace

bool commands_count(const Measurements& measurements) {
  return std::ranges::any_of(measurements.stations, [](const Station& one) { return !one.believed; });
}

bool states_joints(const Measurements& measurements) {
  return std::ranges::any_of(measurements.stations, [](const Station& one) { return one.believed.has_value(); });
}

bool commands_turn(const Measurements& measurements) {
  return std::ranges::any_of(measurements.stations, [](const Station& one) { return one.commanded.rotation != 0.0; });
}

void scale_commands(Measurements& measurements, double factor) {
  change_commands(measurements, [&](Pose& pose) { pose.position *= factor; });
}

void scale_joints(Measurements& measurements, double factor) {
  for (Station& station : measurements.stations) {
    if (station.believed) *station.believed *= factor;
  }
}

void turn_commands(Measurements& measurements, double factor) {
  change_commands(measurements, [&](Pose& pose) { pose.rotation *= factor; });
}

void turn_frame_of_commands(Measurements& measurements, const Eigen::Matrix3d& turn) {
  change_commands(measurements, [&](Pose& pose) { pose.position = turn * pose.position; });
}

}  // namespace paracal::detail
