#include "virtual_twins.hpp"

#include <algorithm>
#include <cmath>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/units.hpp"

namespace paracal::report::detail {
namespace {

constexpr std::uint64_t kSeed = 2016;
constexpr int kFinePoints = 9;
constexpr double kNoise = 0.05 / 3.0;                     // mm
constexpr double kRotationNoise = to_radians(0.3) / 3.0;  // rad

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
  return pose_of(machine, plate);
}

Pose read(Pose pose, RandomStream& random) {
  for (double& coordinate : pose.position) coordinate += kNoise * random.normal();
  pose.rotation += kRotationNoise * random.normal();
  return pose;
}

Place place_of(const Robot& robot, const Station& station) {
  const Eigen::Vector3d& r = station.commanded.position;
  const Workspace& workspace = robot.workspace();
  return {static_cast<int>(std::lround(2.0 * (workspace.top_z - r.z()) / workspace.height)), r.head<2>().norm()};
}

/// Largest magnitude of one kind of error, and where it stands.
void add(const Robot& robot, const std::vector<PosePair>& pairs, const std::vector<Station>& stations,
         double PoseError::*kind, std::vector<double>& values, std::vector<Place>& places) {
  std::vector<double> errors;
  errors.reserve(pairs.size());
  for (const PosePair& pair : pairs) errors.push_back(std::abs(error_relative_to(pairs.front(), pair).*kind));
  const auto largest = std::ranges::max_element(errors);
  values.push_back(*largest);
  places.push_back(place_of(robot, stations[static_cast<std::size_t>(largest - errors.begin())]));
}

void add(const Robot& robot, const std::vector<PosePair>& pairs, const std::vector<Station>& stations,
         Largest& largest) {
  add(robot, pairs, stations, &PoseError::distance, largest.distance, largest.of_distance);
  add(robot, pairs, stations, &PoseError::volumetric, largest.volumetric, largest.of_volumetric);
  add(robot, pairs, stations, &PoseError::rotation, largest.rotation, largest.of_rotation);
}

/// The validation of one twin: against the commanded poses, and against those that its calibration predicts.
void validate_twin(const Robot& robot, const Machine& actual, const Machine& believed, RandomStream& random,
                   Twins& twins) {
  const std::vector<Station> stations = validation_stations(robot);
  std::vector<PosePair> before, after;
  for (const Station& station : stations) {
    const Joints joints = believed_joints(robot, station);
    const Pose seen = read(pose_of(actual, joints), random);
    before.push_back({station.commanded, seen});
    after.push_back({pose_of(believed, joints), seen});
  }
  add(robot, before, stations, twins.before);
  add(robot, after, stations, twins.after);
}

}  // namespace

Twins calibrate_twins(const Robot& robot, const SourceErrors& table4, int count) {
  const std::vector<Station> measured = fine_stations(robot, kFinePoints);
  const CalibrationOptions paper{.method = Method::paper, .stage = Stage::fine, .states_use = false};
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
    validate_twin(robot, build(robot, errors), build(robot, found), random, twins);
  }
  return twins;
}

Tilts tilt_twins(const Robot& robot, const SourceErrors& table4, int count) {
  const std::vector<Station> stations = validation_stations(robot);
  std::vector<Joints> joints;
  joints.reserve(stations.size());
  for (const Station& station : stations) joints.push_back(believed_joints(robot, station));
  Tilts tilts;
  for (int number = 0; number < count; ++number) {
    RandomStream random(kSeed, static_cast<std::uint64_t>(number));
    const Machine machine = build(robot, with_drawn_tilt(robot, table4, random));
    const Eigen::Vector3d home = forward(machine, joints.front()).plate.tilt;
    double largest = 0.0, bottom = 0.0;
    Place where;
    for (std::size_t k = 1; k < stations.size(); ++k) {
      const double tilt = (forward(machine, joints[k]).plate.tilt - home).head<2>().norm();
      const Place place = place_of(robot, stations[k]);
      if (tilt > largest) where = place;
      largest = std::max(largest, tilt);
      if (place.layer == Place::kBottom) bottom = std::max(bottom, tilt);
    }
    tilts.bottom.push_back(bottom);
    tilts.largest.push_back(where);
  }
  return tilts;
}

}  // namespace paracal::report::detail
