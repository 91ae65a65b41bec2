#include "virtual_twins.hpp"

#include <algorithm>
#include <cmath>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/kinematics/forward.hpp"

namespace paracal::report::detail {
namespace {

constexpr std::uint64_t kSeed = 2016;
constexpr int kFinePoints = 9;
constexpr double kNoise = 0.017;  // mm: a third of the positioning repeatability, read as 3 sigma

SourceErrors with_drawn_tilt(const Robot& robot, const SourceErrors& position, RandomStream& random) {
  SourceErrors errors = draw_errors(*robot.tolerances(), robot.limb_count(), random);
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : all_sources()) {
      if (!tilts_plate(source)) errors(limb, source) = position(limb, source);
    }
  }
  return errors;
}

Pose pose_of(const Machine& machine, const Joints& joints) {
  const PlateState plate = forward(machine, joints).plate;
  return {plate.position, machine.rotation_of(plate.slide)};
}

/// Index of the pose with the largest error.
template <typename Error>
Place worst_place(const Robot& robot, const std::vector<PosePair>& pairs, const std::vector<Station>& stations,
                  Error&& error) {
  std::size_t worst = 0;
  double largest = -1.0;
  for (std::size_t k = 1; k < pairs.size(); ++k) {
    const double value = std::abs(error(error_relative_to(pairs.front(), pairs[k])));
    if (value <= largest) continue;
    largest = value;
    worst = k;
  }
  const Eigen::Vector3d& r = stations[worst].commanded.position;
  const Workspace& workspace = robot.workspace();
  return {static_cast<int>(std::lround(2.0 * (workspace.top_z - r.z()) / workspace.height)), r.head<2>().norm()};
}

void add(const Robot& robot, const std::vector<PosePair>& pairs, const std::vector<Station>& stations, Twins& twins) {
  const PoseErrorSummary largest = summarize(pairs, true);
  twins.distance.push_back(largest.max_abs_distance);
  twins.volumetric.push_back(largest.max_volumetric);
  twins.rotation.push_back(*largest.max_abs_rotation);
  const auto worst = [&](double PoseError::*what) {
    return worst_place(robot, pairs, stations, [what](const PoseError& error) { return error.*what; });
  };
  twins.worst_distance.push_back(worst(&PoseError::distance));
  twins.worst_volumetric.push_back(worst(&PoseError::volumetric));
  twins.worst_rotation.push_back(worst(&PoseError::rotation));
}

}  // namespace

Twins calibrate_twins(const Robot& robot, const SourceErrors& table4, int count) {
  const std::vector<Station> measured = fine_stations(robot, kFinePoints), validated = validation_stations(robot);
  const CalibrationOptions paper{.method = Method::paper, .stage = Stage::fine};
  Twins twins{.count = count};
  for (int number = 0; number < count; ++number) {
    RandomStream random(kSeed, static_cast<std::uint64_t>(number));
    const SourceErrors errors = with_drawn_tilt(robot, table4, random);
    const Measurements readings = simulate(robot, errors, measured, {.noise = kNoise}, random);
    const SourceErrors found = calibrate(robot, readings, paper).errors();
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (std::size_t k = 0; k < kPositionSourceCount; ++k) {
        twins.identified[limb][k].push_back(found(limb, static_cast<Source>(k)));
      }
    }
    const Machine actual = build(robot, errors), believed = build(robot, found);
    std::vector<PosePair> pairs;
    for (const Station& station : validated) {
      const Joints joints = believed_joints(robot, station);
      pairs.push_back({pose_of(believed, joints), pose_of(actual, joints)});
    }
    add(robot, pairs, validated, twins);
  }
  return twins;
}

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace paracal::report::detail
