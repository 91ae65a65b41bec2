// What carries the second reflector: the plate, or an end-effector that turns by phi or by -phi against it.

#include <gmock/gmock.h>

#include <algorithm>
#include <map>

#include "calibration/fit/observation.hpp"
#include "calibration/fit/sought.hpp"
#include "observation_derivatives.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::reflector_mount_test {
namespace {

const Eigen::Vector3d kLever(60.0, -20.0, -150.0);

class ReflectorMounts : public testing::TestWithParam<ReflectorMount> {
 protected:
  /// A machine out of tolerance by far, so that every derivative shows.
  Measurements readings(double noise) const {
    return test::measure(robot, test::table4_machine(robot, 3), fine_stations(robot, 9), 3,
                         {.noise = noise, .second = kLever, .mount = GetParam()});
  }

  Robot robot = catalogue::huang2016();
};

/// Against a level nominal machine: a quarter turn of phi takes x to y, to -y, or nowhere.
TEST_P(ReflectorMounts, TurnByPhi) {
  RandomStream random(1);
  const double z = robot.workspace().centre().z();
  const std::vector<Station> stations{{"P0", {{0.0, 0.0, z}, 0.0}}, {"P1", {{0.0, 0.0, z}, to_radians(90.0)}}};
  const Measurements read =
      simulate(robot, {}, stations, {.second = Eigen::Vector3d(60.0, 0.0, -150.0), .mount = GetParam()}, random);
  const PointReading& turned = read.series[0].readings[1];
  const std::map<ReflectorMount, Eigen::Vector3d> expected{
      {ReflectorMount::plate, {60.0, 0.0, -150.0}},
      {ReflectorMount::end_effector, {0.0, 60.0, -150.0}},
      {ReflectorMount::end_effector_reversed, {0.0, -60.0, -150.0}}};
  EXPECT_LT((*turned.second - turned.point - expected.at(GetParam())).norm(), 1e-6);
}

TEST_P(ReflectorMounts, DerivativesAreThoseOfTheReadings) {
  const CalibrationOptions options{.reflectors = GetParam()};
  const Measurements read = readings(0.0);
  detail::Observation observation(robot, read, options, detail::all_with_priors(robot, options));
  SourceErrors errors = test::table4_machine(robot, 5);
  const Eigen::VectorXd unknowns = *observation.start(errors);
  EXPECT_TRUE(test::derivatives_are_differences(observation, unknowns));
}

TEST_P(ReflectorMounts, AreCalibratedAsMounted) {
  const Calibration calibration = calibrate(robot, readings(0.002), {.reflectors = GetParam()});
  ASSERT_TRUE(calibration.accepted()) << calibration.brief();
  EXPECT_LT(calibration.noise, 0.004);
  // A constant tilt turns the lever, and a turned frame looks like one: 1e-3 rad times its length.
  EXPECT_LT((*calibration.frames[0].second - kLever).norm(), 1.0);
}

INSTANTIATE_TEST_SUITE_P(All, ReflectorMounts, testing::ValuesIn(kReflectorMounts), [](const auto& mount) {
  std::string text(name(mount.param));
  std::ranges::replace(text, '-', '_');
  return text;
});

}  // namespace
}  // namespace paracal::reflector_mount_test
