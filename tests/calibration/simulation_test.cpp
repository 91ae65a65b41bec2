// What virtual machines are measured to do, kind by kind.

#include "paracal/calibration/simulation.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::simulation_test {
namespace {

class SimulationLaw : public test::EveryRobot {
 protected:
  PlateState plate(std::size_t station) const {
    return forward(machine, believed_joints(robot, stations[station])).plate;
  }

  test::Random random;
  SourceErrors errors = random.realistic_errors(robot);
  Machine machine = build(robot, errors);
  std::vector<Station> stations = fine_stations(robot, 5);
};

TEST_P(SimulationLaw, PerfectReadingsAreThoseOfTheMachine) {
  RandomStream stream(1);
  const VirtualInstrument instrument{.set_up = Eigen::Vector3d(-900.0, 2e-3, -1e-3)};
  const auto read = [&](Measurand measurand) {
    return simulate(robot, errors, planned(robot, stations, {.measurand = measurand}), instrument, stream);
  };
  const Measurements coordinates = read(Measurand::coordinates), pairs = read(Measurand::distances);
  ASSERT_EQ(coordinates.series.front().readings.size(), stations.size());
  EXPECT_EQ(coordinates.series.front().readings[3].point, plate(3).position);
  EXPECT_EQ(pairs.distances.size(), stations.size() * (stations.size() - 1) / 2);
  const Measurements home = read(Measurand::home_distances);
  ASSERT_EQ(home.distances.size(), stations.size() - 1);
  for (const DistanceReading& one : home.distances) {
    EXPECT_EQ(one.from, 0u);
    EXPECT_NEAR(one.distance, (plate(one.to).position - plate(0).position).norm(), 1e-9);
    EXPECT_FALSE(one.rotation);
  }
  const Measurements heights = read(Measurand::lengths);
  ASSERT_EQ(heights.lengths.front().readings.size(), stations.size());
  for (const LengthReading& one : heights.lengths.front().readings) {
    const Eigen::Vector3d p = plate(one.station).position;
    EXPECT_NEAR(one.length, p.z() + 900.0 - 2e-3 * p.x() + 1e-3 * p.y(), 1e-9);
  }
}

TEST_P(SimulationLaw, RotationsComeWithDistances) {
  RandomStream stream(1);
  const Measurements read = simulate(
      robot, errors, planned(robot, stations, {.measurand = Measurand::home_distances, .rotation = true}), {}, stream);
  const DistanceReading& one = read.distances[4];
  EXPECT_NEAR(*one.rotation, machine.rotation_of(plate(one.to).slide) - machine.rotation_of(plate(0).slide), 1e-12);
}

/// Noise of the reading, and of both visits of a distance.
TEST_P(SimulationLaw, ScattersAsTheInstrumentAndTheMachineDo) {
  constexpr int kMany = 3000;
  RandomStream stream(2);
  Measurements plan{.stations = stations, .lengths = {{"plane"}}};
  for (int k = 0; k < kMany; ++k) {
    plan.lengths.front().readings.push_back({.station = 2});
    plan.distances.push_back({.from = 0, .to = 2});
  }
  const Measurements read = simulate(robot, errors, plan, {.noise = 0.03, .repeatability = 0.04}, stream);
  double heights = 0.0, distances = 0.0;
  const double z = plate(2).position.z(), length = (plate(2).position - plate(0).position).norm();
  for (int k = 0; k < kMany; ++k) {
    const auto at = static_cast<std::size_t>(k);
    heights += std::pow(read.lengths.front().readings[at].length - z, 2) / kMany;
    distances += std::pow(read.distances[at].distance - length, 2) / kMany;
  }
  EXPECT_NEAR(std::sqrt(heights), std::hypot(0.03, 0.04), 0.05 * 0.05);  // 5 %: four standard deviations
  EXPECT_NEAR(std::sqrt(distances), std::hypot(0.03, 0.04, 0.04), 0.05 * 0.064);
}

/// A plan may visit a place twice. What noise alone makes of its distance is one that tables may state.
TEST_P(SimulationLaw, NoDistanceIsBelowZero) {
  RandomStream stream(4);
  Measurements plan{.stations = {stations[2], stations[2]}};
  for (int k = 0; k < 100; ++k) plan.distances.push_back({.from = 0, .to = 1});
  for (const DistanceReading& one : simulate(robot, errors, plan, {.noise = 0.05}, stream).distances) {
    EXPECT_GT(one.distance, 0.0);
  }
}

/// The way without a tracker: heights and distances from home, planned, read and calibrated from.
TEST_P(SimulationLaw, HeightsAndDistancesCalibrate) {
  RandomStream stream(3);
  const std::vector<Station> many = fine_stations(robot, 12);
  Measurements plan = planned(robot, many, {.measurand = Measurand::lengths});
  plan.distances = planned(robot, many, {.measurand = Measurand::home_distances}).distances;
  const Measurements read = simulate(
      robot, errors, plan, {.noise = 0.01, .set_up = Eigen::Vector3d(robot.workspace().top_z, 1e-3, 0.0)}, stream);
  CalibrationOptions options;
  options.noise.height = options.noise.distance = 0.01;
  options.stage = Stage::fine;
  const Calibration found = calibrate(robot, read, options);
  EXPECT_LT(found.after.rms_distance, 0.3 * found.before.rms_distance);
  EXPECT_LT(found.after.rms_lengths.at(LengthKind::height), 0.02);
}

TEST_P(SimulationLaw, PlansNameWhatHasNone) {
  EXPECT_THROW((void)planned(robot, stations, {.measurand = Measurand::lengths, .rotation = true}), InvalidArgument);
  EXPECT_THROW((void)planned(robot, stations, {.measurand = Measurand::distances, .second = true}), InvalidArgument);
}

PARACAL_ON_EVERY_ROBOT(SimulationLaw);
PARACAL_ON_UNUSUAL_ROBOTS(SimulationLaw);

}  // namespace
}  // namespace paracal::simulation_test
