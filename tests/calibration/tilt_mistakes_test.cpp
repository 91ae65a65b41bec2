// What commanded tilts of hexapods suffer.

#include "calibration/diagnosis/mistakes.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::tilt_mistakes_test {
namespace {

using testing::Contains;
using testing::HasSubstr;

Eigen::Matrix3d turn(int axis, double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
}

/// Angles of Rot(z, c) Rot(y, b) Rot(x, a), by hand.
Eigen::Vector3d roll_pitch_yaw(const Eigen::Vector3d& tilt) {
  const Eigen::Matrix3d r = turn(0, tilt.x()) * turn(1, tilt.y()) * turn(2, tilt.z());
  return {std::atan2(r(2, 1), r(2, 2)), -std::asin(r(2, 0)), std::atan2(r(1, 0), r(0, 0))};
}

struct Case {
  std::string cause;
  Eigen::Vector3d (*spoil)(const Eigen::Vector3d& tilt);
};

const std::vector<Case>& cases() {
  using V = Eigen::Vector3d;
  static const std::vector<Case> all{
      {"the commanded tilts are in rad, not deg", [](const V& t) { return V(t * std::numbers::pi / 180.0); }},
      {"the commanded tilts have the opposite sign", [](const V& t) { return V(-t); }},
      {"the commanded tilt_x has the opposite sign", [](const V& t) { return V(-t.x(), t.y(), t.z()); }},
      {"the commanded tilt_y has the opposite sign", [](const V& t) { return V(t.x(), -t.y(), t.z()); }},
      {"the commanded tilt_z has the opposite sign", [](const V& t) { return V(t.x(), t.y(), -t.z()); }},
      {"the commanded tilt_x and tilt_y have the opposite sign", [](const V& t) { return V(-t.x(), -t.y(), t.z()); }},
      {"the commanded tilt_x and tilt_y are swapped", [](const V& t) { return V(t.y(), t.x(), t.z()); }},
      {"the commanded tilt_x and tilt_z are swapped", [](const V& t) { return V(t.z(), t.y(), t.x()); }},
      {"the commanded tilts are of Rot(z, tilt_z) Rot(y, tilt_y) Rot(x, tilt_x), not of Rot(x, tilt_x) Rot(y, tilt_y) "
       "Rot(z, tilt_z)",
       roll_pitch_yaw},
  };
  return all;
}

void spoil(Measurements& read, const Case& one) {
  for (Station& station : read.stations) station.commanded.tilt = one.spoil(station.commanded.tilt);
}

TEST(TiltMistakes, LeadBackToWhatWasMeant) {
  const Robot robot = robot_named("hexapod");
  Measurements meant{.stations = candidate_stations(robot, 12, 4)};
  for (const Case& one : cases()) {
    detail::Input input{robot, meant, {}};
    spoil(input.measurements, one);
    const std::vector<detail::Mistake> all = detail::usual_mistakes(input);
    const auto found = std::ranges::find(all, one.cause, &detail::Mistake::text);
    ASSERT_NE(found, all.end()) << one.cause;
    found->undo(input);
    for (std::size_t k = 0; k < meant.stations.size(); ++k) {
      const Eigen::Vector3d is = input.measurements.stations[k].commanded.tilt;
      EXPECT_LT((is - meant.stations[k].commanded.tilt).norm(), 1e-12) << one.cause;
    }
  }
}

TEST(TiltMistakes, AreOfCommandsThatTilt) {
  const Robot robot = robot_named("hexapod");
  Measurements read{.stations = candidate_stations(robot, 12, 4)};
  EXPECT_EQ(detail::tilt_mistakes({robot, read, {}}).size(), 1U + 7U + 3U + 5U);
  for (Station& one : read.stations) one.believed = believed_joints(robot, one);
  EXPECT_TRUE(detail::tilt_mistakes({robot, read, {}}).empty());
  const Robot level = robot_named("delta");
  EXPECT_TRUE(detail::tilt_mistakes({level, {.stations = candidate_stations(level, 5, 4)}, {}}).empty());
}

/// A frame of the commands that is turned about z turns the tilts, too.
TEST(TiltMistakes, AFrameOfTheCommandsTurnsThemToo) {
  const Robot robot = robot_named("hexapod");
  const Measurements meant{.stations = candidate_stations(robot, 12, 4)};
  detail::Input input{robot, meant, {}};
  const std::vector<detail::Mistake> all = detail::usual_mistakes(input);
  const std::string text = "the frame of the commands is rotated by 90 deg about z relative to the robot's";
  std::ranges::find(all, text, &detail::Mistake::text)->undo(input);
  for (std::size_t k = 0; k < meant.stations.size(); ++k) {
    const Pose &was = meant.stations[k].commanded, &is = input.measurements.stations[k].commanded;
    const auto plate = [](const Eigen::Vector3d& t) {
      return Eigen::Matrix3d(turn(0, t.x()) * turn(1, t.y()) * turn(2, t.z()));
    };
    const Eigen::Matrix3d quarter = turn(2, std::numbers::pi / 2.0);
    EXPECT_LT((is.position - quarter * was.position).norm(), 1e-9);
    EXPECT_LT((plate(is.tilt) - quarter * plate(was.tilt) * quarter.transpose()).norm(), 1e-12);
  }
}

/// Named, whichever the machine, of which one has every cause; the calibration is rejected for it.
TEST(TiltMistakes, AreNamed) {
  const Robot robot = robot_named("hexapod");
  const std::vector<Station> stations = candidate_stations(robot, 24, 3);
  for (const Case& one : cases()) {
    for (int number = 0; number < machines({.claim = 3, .quick = 1}); ++number) {
      Measurements read = body_poses(robot, stations, number);
      spoil(read, one);
      const Calibration found = calibrate(robot, read);
      EXPECT_FALSE(found.accepted()) << one.cause;
      EXPECT_THAT(found.reasons, Contains(HasSubstr(one.cause))) << number;
    }
  }
}

}  // namespace
}  // namespace paracal::test::tilt_mistakes_test
