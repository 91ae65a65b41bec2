#include "paracal/report/error_map.hpp"

#include <cmath>

#include "figures.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/drive.hpp"
#include "paracal/numerics/rigid_fit.hpp"
#include "paracal/units.hpp"

namespace paracal::report {
namespace {

using detail::rounded;

/// Home, then the grid.
std::vector<Station> stations_of(const Robot& robot) {
  std::vector<Station> stations{{"home", {robot.workspace().centre(), 0.0}}};
  for (const Pose& pose : polar_grid(robot, detail::kMapGrid, false)) stations.push_back({"map", pose});
  return stations;
}

std::vector<PosePair> driven(const Robot& robot, const KnownErrors& known, const std::vector<Station>& stations) {
  const Machine machine = build(robot, known.errors);
  const bool even = known.drives().are_even();
  std::vector<PosePair> pairs;
  pairs.reserve(stations.size());
  for (const Station& station : stations) {
    const Pose& commanded = station.commanded;
    if (!even) {
      pairs.push_back({commanded, predict(robot, known, believed_joints(robot, station)).pose});
      continue;
    }
    const auto plate = drive(machine, robot.nominal(), commanded);
    if (!plate) throw Unreachable("the calibrated machine cannot reach every pose of its workspace");
    pairs.push_back({commanded, pose_of(machine, *plate)});
  }
  return pairs;
}

RigidMotion alignment(const std::vector<PosePair>& pairs) {
  std::vector<Eigen::Vector3d> meant, actual;
  for (const PosePair& pair : pairs) {
    meant.push_back(pair.meant.position);
    actual.push_back(pair.actual.position);
  }
  return rigid_fit(actual, meant);
}

}  // namespace

io::Json error_map(const Robot& robot, const KnownErrors& known) {
  const std::vector<Station> stations = stations_of(robot);
  const std::vector<PosePair> pairs = driven(robot, known, stations);
  const RigidMotion aligned = alignment(pairs);
  std::vector<PoseStd> spread;
  if (known.covariance.size() > 0) {
    spread = PoseSpread(robot, known.errors, known.parameters, stations)
                 .each(known.expanded_covariance(), known.joint_std_of_a_visit());
  }
  io::Json json = detail::map_axes(robot.workspace());
  json["coverage_factor"] = kCoverageFactor;
  for (std::size_t k = 1; k < pairs.size(); ++k) {
    const PoseError error = error_relative_to(pairs.front(), pairs[k]);
    const Eigen::Vector3d &meant = pairs[k].meant.position, &actual = pairs[k].actual.position;
    const auto expanded = [&](double PoseStd::*what) {
      return spread.empty() ? io::Json(nullptr) : rounded(kCoverageFactor * spread[k].*what);
    };
    io::Json point = detail::place_json(meant);
    point["distance_before_mm"] = rounded(std::abs(error.distance));
    point["distance_after_mm"] = expanded(&PoseStd::distance);
    point["position_before_mm"] = rounded((aligned(actual) - meant).norm());
    point["position_after_mm"] = expanded(&PoseStd::aligned);
    if (robot.slide()) {
      point["rotation_before_deg"] = rounded(to_degrees(std::abs(error.rotation)));
      point["rotation_after_deg"] =
          spread.empty() ? io::Json(nullptr) : rounded(to_degrees(kCoverageFactor * spread[k].rotation));
    }
    json["points"].push_back(std::move(point));
  }
  return json;
}

}  // namespace paracal::report
