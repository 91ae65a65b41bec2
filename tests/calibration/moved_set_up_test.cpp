// An instrument or a body that moved while it was read.

#include "calibration/diagnosis/mistakes.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include "paracal/calibration/diagnosis.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::moved_set_up_test {
namespace {

using testing::ElementsAre;

constexpr double kNoise = 0.017;  // mm
const Eigen::Vector3d kShift(0.3, -0.4, 0.2);

Eigen::Quaterniond small_turn() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(0.003, Eigen::Vector3d(1, 2, -1).normalized()));
}

/// Of a body that was knocked before reading `from` (counted from 0).
Measurements knocked(const Robot& robot, std::size_t from, int number) {
  Measurements read = body_poses(robot, candidate_stations(robot, 30, 3), number);
  std::vector<PointReading>& readings = read.series[0].readings;
  for (std::size_t k = from; k < readings.size(); ++k) {
    readings[k].point += *readings[k].orientation * kShift;
    readings[k].orientation = Quaternion(*readings[k].orientation * small_turn());
  }
  return read;
}

Measurements points_of(const Robot& robot, int number) {
  const std::vector<Station> stations = candidate_stations(robot, 20, 3);
  Measurements read = measured_machine(robot, stations, number, {.noise = kNoise, .repeats = 2}).measurements;
  read.series[0].name = "points";
  return read;
}

TEST(MovedSetUp, OfABodyIsNamedWithTheReading) {
  const Robot robot = robot_named("hexapod");
  for (const auto& [number, from] : {std::pair(1, std::size_t{10}), {2, 15}, {3, 19}}) {
    const auto diagnosis = diagnose(robot, knocked(robot, from, number));
    ASSERT_TRUE(diagnosis);
    EXPECT_THAT(diagnosis->causes,
                ElementsAre("the instrument, or the body on the plate, moved between readings " + std::to_string(from) +
                            " and " + std::to_string(from + 1) + " of poses"));
  }
  EXPECT_EQ(calibrate(robot, knocked(robot, 15, 4)).verdict, Verdict::rejected);
}

TEST(MovedSetUp, OfAnInstrumentIsNamedWithTheReading) {
  const Robot robot = robot_named("delta");
  for (const int number : {1, 2}) {
    Measurements read = points_of(robot, number);
    std::vector<PointReading>& readings = read.series[0].readings;
    for (std::size_t k = 23; k < readings.size(); ++k) readings[k].point += kShift;
    const auto diagnosis = diagnose(robot, read);
    ASSERT_TRUE(diagnosis);
    EXPECT_THAT(diagnosis->causes, ElementsAre("the instrument moved between readings 23 and 24 of points"));
  }
}

/// What drifts did not move between two readings.
TEST(MovedSetUp, IsNoDrift) {
  const Robot robot = robot_named("delta");
  for (const int number : {1, 2}) {
    Measurements read = points_of(robot, number);
    std::vector<PointReading>& readings = read.series[0].readings;
    const auto count = static_cast<double>(readings.size());
    for (std::size_t k = 0; k < readings.size(); ++k) readings[k].point += static_cast<double>(k) / count * kShift;
    const auto diagnosis = diagnose(robot, read);
    if (diagnosis) {
      EXPECT_THAT(diagnosis->causes, testing::IsEmpty()) << diagnosis->text;
    }
  }
}

TEST(MovedSetUp, IsSoughtInNothingThatHoldsStill) {
  const Robot robot = robot_named("hexapod");
  EXPECT_TRUE(detail::moved_set_ups({robot, body_poses(robot, candidate_stations(robot, 30, 3), 1), {}}).empty());
  const Robot level = robot_named("delta");
  EXPECT_TRUE(detail::moved_set_ups({level, points_of(level, 1), {}}).empty());
}

}  // namespace
}  // namespace paracal::test::moved_set_up_test
