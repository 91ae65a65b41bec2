#include "virtual_twins.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "calibration/fit/as_given.hpp"
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
  SourceErrors errors = draw_errors(robot, *robot.tolerances(), random);
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

/// Poses that are commanded, and where the controller, which believes the nominal robot, then sends the joints.
struct Commanded {
  explicit Commanded(const Robot& robot) : stations(validation_stations(robot)) {
    joints.reserve(stations.size());
    for (const Station& station : stations) joints.push_back(believed_joints(robot, station));
  }

  std::vector<Station> stations;
  std::vector<Joints> joints = {};
};

/// make(number) of every twin, each by itself, on so many threads; 0: all.
template <typename Make>
auto on_threads(int count, unsigned threads, const Make& make) {
  std::vector<decltype(make(0))> all(static_cast<std::size_t>(count));
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads));
  arena.execute([&] { tbb::parallel_for(0, count, [&](int k) { all[static_cast<std::size_t>(k)] = make(k); }); });
  return all;
}

/// The validation of a twin: against the commanded poses, and against those that its calibration predicts.
struct Twin {
  SourceErrors found = {};
  std::vector<PosePair> before = {}, after = {};
};

Twin calibrated_twin(const Robot& robot, const SourceErrors& table4, const std::vector<Station>& measured,
                     const Commanded& validation, int number) {
  const CalibrationOptions paper{.method = Method::paper, .stage = Stage::fine};
  RandomStream random(kSeed, static_cast<std::uint64_t>(number));
  const SourceErrors errors = with_drawn_tilt(robot, table4, random);
  const Measurements readings = simulate(robot, errors, measured, {.noise = kNoise}, random);
  Twin twin{paracal::detail::calibrate_as_given(robot, readings, paper, paracal::detail::Told::errors).errors()};
  const Machine actual = build(robot, errors), believed = build(robot, twin.found);
  for (std::size_t k = 0; k < validation.stations.size(); ++k) {
    const Joints& joints = validation.joints[k];
    const Pose seen = read(pose_of(actual, joints), random);
    twin.before.push_back({validation.stations[k].commanded, seen});
    twin.after.push_back({pose_of(believed, joints), seen});
  }
  return twin;
}

/// The largest tilt in the bottom layer, and where that of all layers stands.
struct Tilt {
  double bottom = 0.0;
  Place largest = {};
};

Tilt tilt_of(const Robot& robot, const Machine& machine, const Commanded& validation) {
  const Eigen::Vector3d home = forward(machine, validation.joints.front()).plate.tilt;
  double largest = 0.0;
  Tilt found;
  for (std::size_t k = 1; k < validation.stations.size(); ++k) {
    const double tilt = (forward(machine, validation.joints[k]).plate.tilt - home).head<2>().norm();
    const Place place = place_of(robot, validation.stations[k]);
    if (tilt > largest) found.largest = place;
    largest = std::max(largest, tilt);
    if (place.layer == Place::kBottom) found.bottom = std::max(found.bottom, tilt);
  }
  return found;
}

}  // namespace

Twins calibrate_twins(const Robot& robot, const SourceErrors& table4, int count, unsigned threads) {
  const std::vector<Station> measured = fine_stations(robot, kFinePoints);
  const Commanded validation(robot);
  Twins twins{.count = count};
  const auto make = [&](int number) { return calibrated_twin(robot, table4, measured, validation, number); };
  for (const Twin& twin : on_threads(count, threads, make)) {
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : all_sources()) twins.identified[limb][source].push_back(twin.found(limb, source));
    }
    add(robot, twin.before, validation.stations, twins.before);
    add(robot, twin.after, validation.stations, twins.after);
  }
  return twins;
}

Tilts tilt_twins(const Robot& robot, const SourceErrors& table4, int count, unsigned threads) {
  const Commanded validation(robot);
  const auto make = [&](int number) {
    RandomStream random(kSeed, static_cast<std::uint64_t>(number));
    return tilt_of(robot, build(robot, with_drawn_tilt(robot, table4, random)), validation);
  };
  Tilts tilts;
  for (const Tilt& one : on_threads(count, threads, make)) {
    tilts.bottom.push_back(one.bottom);
    tilts.largest.push_back(one.largest);
  }
  return tilts;
}

}  // namespace paracal::report::detail
