#include "paracal/calibration/plan.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "calibration/fit/sought.hpp"
#include "calibration/plan/tolerated_reach.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/level.hpp"

namespace paracal {
namespace {

Station home(const Robot& robot) { return {"P0", {robot.workspace().centre(), 0.0}}; }

/// So that a point on the x axis reads 0 and not 1e-13.
Eigen::Vector3d to_nanometres(const Eigen::Vector3d& position) { return (position * 1e6).array().round() / 1e6 + 0.0; }

/// n points around a layer of the workspace, named on from the stations already there.
void add_circle(std::vector<Station>& stations, const Workspace& workspace, double share, double depth, double rotation,
                int n, double start) {
  for (int k = 0; k < n; ++k) {
    const double azimuth = start + 2.0 * std::numbers::pi * k / n;
    const Eigen::Vector3d position = to_nanometres(workspace.at(share, azimuth, depth));
    stations.push_back({fmt::format("P{}", stations.size()), {position, rotation}});
  }
}

std::vector<Station> stations_of(const Robot& robot, Stage stage, int n, double start) {
  return stage == Stage::rough ? rough_stations(robot, n, start) : fine_stations(robot, n, start);
}

Measurements planned_lengths(const Robot& robot, const std::vector<Station>& stations,
                             const PlannedReadings& readings) {
  const LengthWords& kind = words(readings.length);
  if (kind.needs_at && !(readings.at && readings.at->norm() > 0.0)) {
    throw InvalidArgument(fmt::format("plan: expected {} with {}", kind.at, kind.plural));
  }
  Measurements plan{.stations = stations, .lengths = {{std::string(kind.name), kind.kind, {}, readings.at}}};
  for (std::size_t k = 0; k < stations.size(); ++k) plan.lengths.front().readings.push_back({.station = k});
  RandomStream unused(0);
  return simulate(robot, {}, std::move(plan), {}, unused);
}

Measurements planned_poses(const Robot& robot, const std::vector<Station>& stations, const PlannedReadings& readings) {
  Measurements plan{.stations = stations, .series = {{"poses", {}}}};
  for (std::size_t k = 0; k < stations.size(); ++k) {
    plan.series.front().readings.push_back(
        {.station = k, .point = Eigen::Vector3d::Zero(), .orientation = Quaternion::Identity()});
  }
  RandomStream unused(0);
  return simulate(robot, {}, std::move(plan), {.mount = readings.mount}, unused);
}

}  // namespace

std::vector<Station> rough_stations(const Robot& robot, int n, double start_azimuth) {
  const double share = detail::tolerated_share(robot);
  std::vector<Station> stations{home(robot)};
  add_circle(stations, robot.workspace(), share, 0.5, 0.0, n, start_azimuth);
  return stations;
}

std::vector<Station> fine_stations(const Robot& robot, int n, double start_azimuth) {
  const Workspace& workspace = robot.workspace();
  const double share = detail::tolerated_share(robot), up = 0.5 * (1.0 - share);
  std::vector<Station> stations{home(robot)};
  add_circle(stations, workspace, share, up, workspace.max_rotation, n, start_azimuth);
  add_circle(stations, workspace, share, 1.0 - up, workspace.min_rotation, n, start_azimuth);
  return stations;
}

std::vector<Station> validation_stations(const Robot& robot) {
  constexpr int kLayers = 3, kCircles = 5, kPoints = 8;  // where there is one layer, its points are three times as many
  const Workspace& workspace = robot.workspace();
  std::vector<Station> stations{home(robot)};
  const int layers = workspace.layers(kLayers);
  for (int layer = 0; layer < layers; ++layer) {
    for (int circle = 1; circle <= kCircles; ++circle) {
      add_circle(stations, workspace, static_cast<double>(circle) / kCircles, Workspace::layer_depth(layer, layers),
                 0.0, kPoints * kLayers / layers, 0.0);
    }
  }
  return stations;
}

std::vector<Station> workspace_stations(const Robot& robot) {
  const Workspace& workspace = robot.workspace();
  const std::vector<Eigen::Vector3d> tilts = workspace.tilts();
  std::vector<Station> stations = validation_stations(robot);
  for (std::size_t k = 1; k < stations.size(); ++k) {
    const std::array<double, 3> turns{workspace.min_rotation, 0.0, workspace.max_rotation};
    stations[k].commanded.rotation = turns[k % turns.size()];
    stations[k].commanded.tilt = tilts[k % tilts.size()];
  }
  return stations;
}

Measurements planned(const Robot& robot, const std::vector<Station>& stations, const PlannedReadings& readings) {
  const bool coordinates = readings.measurand == Measurand::coordinates, poses = readings.measurand == Measurand::poses;
  const bool lengths = readings.measurand == Measurand::lengths;
  if (readings.second && !coordinates)
    throw InvalidArgument("plan: expected coordinates with a second reflector, got another measurand");
  if (readings.rotation && lengths) {
    throw InvalidArgument(fmt::format("plan: expected {} without rotations", words(readings.length).plural));
  }
  if (readings.rotation && poses)
    throw InvalidArgument("plan: expected poses without rotation readings, since poses include them");
  if (lengths) return planned_lengths(robot, stations, readings);
  if (poses) return planned_poses(robot, stations, readings);
  RandomStream unused(0);
  VirtualInstrument instrument{.reads_rotation = readings.rotation, .mount = readings.mount};
  if (readings.second) instrument.second = Eigen::Vector3d(0.0, 0.0, -sizes_of(robot.limbs()).parallelogram_width);
  Measurements plan = simulate(robot, {}, stations, instrument, unused);
  if (coordinates) return plan;
  plan.distances = all_distances(plan.series.front());
  plan.series.clear();
  if (readings.measurand == Measurand::home_distances) {
    std::erase_if(plan.distances, [](const DistanceReading& one) { return one.from != 0; });
  }
  if (readings.rotation) {
    for (DistanceReading& reading : plan.distances) {
      reading.rotation = stations[reading.to].commanded.rotation - stations[reading.from].commanded.rotation;
    }
  }
  return plan;
}

PaperPlan paper_plan(const Robot& robot, Stage stage, double start_azimuth, double threshold, int show_up_to) {
  if (stage == Stage::automatic) throw InvalidArgument("plan: expected the rough or the fine stage");
  check_level(robot, "poses by stage");
  const CalibrationOptions options;
  const std::vector<SoughtSource> sought =
      stage == Stage::rough ? detail::encoder_offsets(robot, options) : detail::paper_columns(robot, options);
  const auto distances_of = [&](int n) { return stage == Stage::rough ? n * (n + 1) / 2 : n * (2 * n + 1); };
  int n = static_cast<int>(robot.limb_count()) - 1;
  while (distances_of(n) < static_cast<int>(sought.size())) ++n;
  PaperPlan plan;
  for (; n <= PaperPlan::kLargest && (plan.n == 0 || n <= show_up_to); ++n) {
    const std::vector<Station> stations = stations_of(robot, stage, n, start_azimuth);
    const Identifiability seen =
        identifiability(robot, planned(robot, stations, {.measurand = Measurand::distances}), options, sought);
    CurvePoint point{n, seen.indices, 1.0};
    if (!plan.curve.empty()) {
      point.change = std::abs(point.indices.O2 - plan.curve.back().indices.O2) / point.indices.O2;
      if (plan.n == 0 && point.change <= threshold) plan.n = n;
    }
    plan.curve.push_back(point);
  }
  if (plan.n > 0) plan.stations = stations_of(robot, stage, plan.n, start_azimuth);
  return plan;
}

}  // namespace paracal
