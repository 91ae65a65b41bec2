// A cause is named only where the input so taken leaves nothing to explain.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cstdio>

#include "paracal/calibration/diagnosis.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::causes_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNoise = 0.017;  // mm

std::vector<Station> stations_of(const Robot& robot, int count = 20) { return candidate_stations(robot, count, 3); }

/// Points that repeat.
Measurements points_of(const Robot& robot, int number) {
  return measured_machine(robot, stations_of(robot), number, {.noise = kNoise, .repeats = 2}).measurements;
}

void scale_points(Measurements& read, double factor) {
  for (PointReading& one : read.series[0].readings) one.point *= factor;
}

/// Readings that are 2 % short along x: another robot and other arms lie nearer, but not near.
TEST(Causes, ReadingsThatAreShortOneWayAreNoUsualMistake) {
  const Robot robot = robot_named("delta");
  Measurements read = points_of(robot, 1);
  for (PointReading& one : read.series[0].readings) one.point.x() *= 0.98;
  const auto diagnosis = diagnose(robot, read);
  ASSERT_TRUE(diagnosis);
  EXPECT_THAT(diagnosis->causes, IsEmpty()) << diagnosis->text;
  EXPECT_THAT(diagnosis->text, testing::MatchesRegex("no common input mistake explains the residuals of 0\\.73 mm; the "
                                                     "most likely one leaves 0\\.3 mm. Check units, .*"));
  EXPECT_NEAR(diagnosis->largest_noise, 2.0 * kNoise, 0.5 * kNoise);
  const Calibration calibration = calibrate(robot, read);
  EXPECT_EQ(calibration.verdict, Verdict::rejected);
  EXPECT_THAT(calibration.reasons, Contains(diagnosis->text));
  EXPECT_TRUE(calibration.use);
}

/// Two numbers of the robot file: no single one explains the readings, both do, within what tolerances leave open.
TEST(Causes, TwoWrongNumbersOfTheFileAreNamedTogether) {
  const Robot robot = robot_named("delta");
  for (const int number : {1, 2, 3}) {
    SourceErrors errors = measured_machine(robot, stations_of(robot), number, {}).errors;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      errors(limb, "rod_mean") += 20.0;
      errors(limb, "arm_length") -= 10.0;
    }
    const Measurements read = measure(robot, errors, stations_of(robot), number, {.noise = kNoise, .repeats = 2});
    const auto diagnosis = diagnose(robot, read);
    ASSERT_TRUE(diagnosis);
    ASSERT_FALSE(diagnosis->causes.empty()) << diagnosis->text;
    const std::string text = diagnosis->causes.front();
    double rod = 0.0, arm = 0.0;
    ASSERT_EQ(std::sscanf(text.c_str(), "the readings fit a robot file with rod_mm = %lf and arm_mm = %lf", &rod, &arm),
              2)
        << text;
    EXPECT_NEAR(rod, 800.0, 1.5);
    EXPECT_NEAR(arm, 310.0, 1.5);
    EXPECT_THAT(text, testing::EndsWith(" instead of 780 and 320"));
    EXPECT_LT(diagnosis->rms_explained, 1.5 * kNoise);
    EXPECT_EQ(calibrate(robot, read).verdict, Verdict::rejected);
  }
}

/// A scale that is off looks like a robot that is as much larger: either may be.
TEST(Causes, AWrongScaleIsNamedBesideALargerRobot) {
  const Robot robot = robot_named("delta");
  for (const double scale : {1.005, 0.99}) {
    Measurements read = points_of(robot, 1);
    scale_points(read, scale);
    const auto diagnosis = diagnose(robot, read);
    ASSERT_TRUE(diagnosis);
    ASSERT_FALSE(diagnosis->causes.empty()) << diagnosis->text;
    double told = 0.0;
    ASSERT_EQ(std::sscanf(diagnosis->causes.front().c_str(), "the scale of the readings is %lf", &told), 1)
        << diagnosis->text;
    EXPECT_NEAR(told, scale, 1e-3);
    const bool within = scale == 1.005;  // radii that are 1 % off are beyond their tolerances
    EXPECT_EQ(testing::Value(diagnosis->causes, Contains(HasSubstr("a robot file with rod_mm = "))), within);
  }
}

/// Tilts of which half is written are no usual mistake: what fits worse than the input as given is not named.
TEST(Causes, NoneFitsWorseThanTheInputAsGiven) {
  const Robot robot = robot_named("hexapod");
  for (const int number : {1, 2, 3}) {
    Measurements read = body_poses(robot, stations_of(robot, 24), number);
    EXPECT_FALSE(diagnose(robot, read));
    for (Station& one : read.stations) one.commanded.tilt *= 0.5;
    const auto diagnosis = diagnose(robot, read);
    if (diagnosis) {
      EXPECT_THAT(diagnosis->causes, IsEmpty()) << diagnosis->text;
    }
  }
}

/// Where a wrong part explains what no mistake of the input does, the part is told.
TEST(Causes, PartsThatAreFarOffNeedNoMistake) {
  const Robot robot = robot_named("line-printer");
  for (const int number : {1, 2}) {
    SourceErrors errors = measured_machine(robot, stations_of(robot), number, {}).errors;
    errors(1, "e_x") += 8.0;
    errors(1, "e_y") -= 8.0;
    const Measurements read = measure(robot, errors, stations_of(robot), number, {.noise = kNoise, .repeats = 2});
    const Calibration calibration = calibrate(robot, read);
    EXPECT_TRUE(calibration.accepted()) << calibration.reasons.front();
    EXPECT_THAT(calibration.notes, Contains(HasSubstr("of limb 2")));
  }
}

/// Another fault is left when nearly all is explained.
TEST(Causes, AMistakeIsNamedOfAMachineWithBacklash) {
  const Robot robot = robot_named("delta");
  Random random(5);
  std::vector<Station> stations = stations_of(robot);
  for (Station& one : stations) {
    one.believed = believed_joints(robot, one);
    for (double& joint : *one.believed) joint += std::copysign(to_radians(0.02), random.uniform(-1.0, 1.0));
  }
  Measurements read =
      measure(robot, measured_machine(robot, stations, 1, {}).errors, stations, 1, {.noise = kNoise, .repeats = 2});
  read.stations = stations_of(robot);
  scale_points(read, 1e-3);
  const auto diagnosis = diagnose(robot, read);
  ASSERT_TRUE(diagnosis);
  EXPECT_THAT(diagnosis->causes, ElementsAre("the readings are in metres"));
}

}  // namespace
}  // namespace paracal::test::causes_test
