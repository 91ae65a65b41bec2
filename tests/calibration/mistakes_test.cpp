// Undoing a mistake leads back to the readings from which it was made.

#include "calibration/diagnosis/mistakes.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "calibration/diagnosis/dimensions.hpp"
#include "calibration/diagnosis/wrong_nominal.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::mistakes_test {
namespace {

using detail::Input;
using detail::Mistake;
using testing::HasSubstr;

/// Points with rotations and a second reflector, distances with rotations, heights: whatever can be read.
Measurements all_kinds(const Robot& robot) {
  const std::vector<Station> stations = fine_stations(robot, 4);
  Measurements read =
      measured_machine(robot, stations, 1, {.reads_rotation = true, .second = Eigen::Vector3d(60, 0, -150)})
          .measurements;
  read.distances = all_distances(read.series[0]);
  for (DistanceReading& one : read.distances) one.rotation = 0.1 * static_cast<double>(one.from + 1);
  read.lengths.push_back({"bed"});
  for (std::size_t k = 0; k < stations.size(); ++k) {
    read.lengths[0].readings.push_back({.station = k, .length = 1.0 + static_cast<double>(k)});
  }
  return read;
}

void expect_alike(const Measurements& one, const Measurements& other) {
  for (std::size_t k = 0; k < one.stations.size(); ++k) {
    const Station &a = one.stations[k], &b = other.stations[k];
    EXPECT_LT((a.commanded.position - b.commanded.position).norm(), 1e-9) << k;
    EXPECT_NEAR(a.commanded.rotation, b.commanded.rotation, 1e-12) << k;
    if (a.believed && b.believed) {
      EXPECT_LT((*a.believed - *b.believed).norm(), 1e-9) << k;
    }
  }
  for (std::size_t k = 0; k < one.series[0].readings.size(); ++k) {
    const PointReading &a = one.series[0].readings[k], &b = other.series[0].readings[k];
    EXPECT_EQ(a.station, b.station) << k;
    EXPECT_LT((a.point - b.point).norm(), 1e-9) << k;
    EXPECT_LT((*a.second - *b.second).norm(), 1e-9) << k;
    EXPECT_NEAR(*a.rotation, *b.rotation, 1e-12) << k;
  }
  for (std::size_t k = 0; k < one.distances.size(); ++k) {
    const DistanceReading &a = one.distances[k], &b = other.distances[k];
    EXPECT_EQ(a.from, b.from) << k;
    EXPECT_EQ(a.to, b.to) << k;
    EXPECT_NEAR(a.distance, b.distance, 1e-9) << k;
    EXPECT_NEAR(*a.rotation, *b.rotation, 1e-12) << k;
  }
  for (std::size_t k = 0; k < one.lengths[0].readings.size(); ++k) {
    const LengthReading &a = one.lengths[0].readings[k], &b = other.lengths[0].readings[k];
    EXPECT_EQ(a.station, b.station) << k;
    EXPECT_NEAR(a.length, b.length, 1e-9) << k;
  }
}

class Mistakes : public testing::Test {
 protected:
  /// The mistake of that name, undone.
  void expect_undone(const Measurements& sound, const std::string& text, void (*spoil)(Measurements&),
                     const CalibrationOptions& options = {}) const {
    SCOPED_TRACE(text);
    Measurements spoilt = sound;
    spoil(spoilt);
    Input given{robot, spoilt, options};
    const std::vector<Mistake> all = detail::usual_mistakes(given);
    const auto mistake = std::ranges::find(all, text, &Mistake::text);
    ASSERT_NE(mistake, all.end());
    mistake->undo(given);
    expect_alike(given.measurements, sound);
  }
  Measurements believed(Measurements read) const {
    for (Station& station : read.stations) station.believed = believed_joints(robot, station);
    return read;
  }
  std::ptrdiff_t count(const Measurements& read, const std::string& family,
                       const CalibrationOptions& options = {}) const {
    return std::ranges::count(detail::usual_mistakes(Input{robot, read, options}), family, &Mistake::family);
  }

  Robot robot = catalogue::huang2016();
};

constexpr double kDegree = std::numbers::pi / 180.0;

void scale_lengths(Measurements& read, double factor) {
  for (PointReading& one : read.series[0].readings) one.point *= factor, *one.second *= factor;
  for (DistanceReading& one : read.distances) one.distance *= factor;
  for (LengthReading& one : read.lengths[0].readings) one.length *= factor;
}
void scale_turns(Measurements& read, double factor) {
  for (PointReading& one : read.series[0].readings) *one.rotation *= factor;
  for (DistanceReading& one : read.distances) *one.rotation *= factor;
}
void scale_commands(Measurements& read, const Eigen::Vector3d& factors) {
  for (Station& one : read.stations) one.commanded.position = factors.cwiseProduct(one.commanded.position);
}
void scale_commanded_turns(Measurements& read, double factor) {
  for (Station& one : read.stations) one.commanded.rotation *= factor;
}
void scale_joints(Measurements& read, double factor) {
  for (Station& one : read.stations) *one.believed *= factor;
}

TEST_F(Mistakes, OfUnits) {
  const Measurements sound = all_kinds(robot);
  expect_undone(sound, "the readings are in inches", [](Measurements& m) { scale_lengths(m, 1.0 / 25.4); });
  expect_undone(sound, "the commanded poses are in metres",
                [](Measurements& m) { scale_commands(m, Eigen::Vector3d::Constant(1e-3)); });
  expect_undone(sound, "the readings and the commanded poses are in centimetres", [](Measurements& m) {
    scale_lengths(m, 0.1);
    scale_commands(m, Eigen::Vector3d::Constant(0.1));
  });
}

TEST_F(Mistakes, OfJointsOnRails) {
  robot = catalogue::linear_delta();
  expect_undone(believed(all_kinds(robot)), "joints and commanded poses are in metres", [](Measurements& m) {
    scale_commands(m, Eigen::Vector3d::Constant(1e-3));
    scale_joints(m, 1e-3);
  });
}

TEST_F(Mistakes, OfAngles) {
  const Measurements sound = all_kinds(robot), joints = believed(sound);
  expect_undone(sound, "the commanded phi is in rad, not deg",
                [](Measurements& m) { scale_commanded_turns(m, kDegree); });
  expect_undone(sound, "the readings of phi are in rad, not deg", [](Measurements& m) { scale_turns(m, kDegree); });
  expect_undone(sound, "all values of phi are in rad, not deg", [](Measurements& m) {
    scale_turns(m, kDegree);
    scale_commanded_turns(m, kDegree);
  });
  expect_undone(joints, "the joint angles are in rad, not deg", [](Measurements& m) { scale_joints(m, kDegree); });
  expect_undone(joints, "the joint angles and the readings of phi are in rad, not deg", [](Measurements& m) {
    scale_joints(m, kDegree);
    scale_turns(m, kDegree);
  });
}

TEST_F(Mistakes, OfSigns) {
  const Measurements sound = all_kinds(robot);
  expect_undone(sound, "the readings of phi have the opposite sign", [](Measurements& m) { scale_turns(m, -1.0); });
  expect_undone(sound, "the commanded phi has the opposite sign",
                [](Measurements& m) { scale_commanded_turns(m, -1.0); });
  expect_undone(sound, "commanded and measured phi have the opposite sign", [](Measurements& m) {
    scale_turns(m, -1.0);
    scale_commanded_turns(m, -1.0);
  });
  expect_undone(sound, "the heights are positive downwards", [](Measurements& m) {
    for (LengthReading& one : m.lengths[0].readings) one.length = -one.length;
  });
  expect_undone(sound, "the commanded x has the opposite sign", [](Measurements& m) { scale_commands(m, {-1, 1, 1}); });
  expect_undone(sound, "the commanded y has the opposite sign", [](Measurements& m) { scale_commands(m, {1, -1, 1}); });
  expect_undone(sound, "the commanded z has the opposite sign", [](Measurements& m) { scale_commands(m, {1, 1, -1}); });
  expect_undone(sound, "the commanded x and y are swapped", [](Measurements& m) {
    for (Station& one : m.stations) std::swap(one.commanded.position.x(), one.commanded.position.y());
  });
}

/// Stations of rows, moved on by one in their ring.
template <int kBy>
void move_rows(Measurements& read) {
  const auto move = [](auto& rows, auto member) {
    const auto was = rows;
    const std::size_t count = rows.size();
    for (std::size_t k = 0; k < count; ++k)
      rows[k].*member = was[(k + count + static_cast<std::size_t>(kBy)) % count].*member;
  };
  move(read.series[0].readings, &PointReading::station);
  move(read.lengths[0].readings, &LengthReading::station);
  move(read.distances, &DistanceReading::from);
  move(read.distances, &DistanceReading::to);
}

TEST_F(Mistakes, OfRows) {
  const Measurements sound = all_kinds(robot);
  expect_undone(sound, "each reading belongs to the pose one row below", move_rows<-1>);
  expect_undone(sound, "each reading belongs to the pose one row above", move_rows<1>);
}

template <int kBy>
void move_poses(Measurements& read) {
  const std::size_t count = read.stations.size();
  const auto move = [&](auto& rows) {
    for (auto& one : rows) one.station = (one.station + count + static_cast<std::size_t>(kBy)) % count;
  };
  move(read.series[0].readings);
  move(read.lengths[0].readings);
}

/// With repeats a row is not a pose, of whatever kind they are.
TEST_F(Mistakes, OfPoses) {
  Measurements sound = all_kinds(robot);
  EXPECT_EQ(count(sound, "row"), 2);
  sound.lengths[0].readings.push_back(sound.lengths[0].readings[2]);
  EXPECT_EQ(count(sound, "row"), 4);
  expect_undone(sound, "the readings of each pose belong to the next pose of the list", move_poses<-1>);
  expect_undone(sound, "the readings of each pose belong to the pose before it in the list", move_poses<1>);
}

TEST_F(Mistakes, OfFrames) {
  const Measurements sound = all_kinds(robot);
  const CalibrationOptions known{.frame = Frame::robot};
  EXPECT_EQ(count(sound, "frame"), 2);                  // a mirror, and heights downwards
  EXPECT_EQ(count(sound, "frame", known), 1 + 47 + 1);  // all axes but the right ones, and a frame of its own
  expect_undone(
      sound, "x, y, z of the readings are -y, x, z of the robot",
      [](Measurements& m) {
        for (PointReading& one : m.series[0].readings) {
          one.point = Eigen::Vector3d(-one.point.y(), one.point.x(), one.point.z());
          one.second = Eigen::Vector3d(-one.second->y(), one.second->x(), one.second->z());
        }
      },
      known);
}

TEST_F(Mistakes, OfMountsAreTheOthers) {
  EXPECT_EQ(count(all_kinds(robot), "mount"), 2);
  EXPECT_EQ(count(measured_machine(robot, fine_stations(robot, 4), 1, {}).measurements, "mount"), 0);
}

/// Names of the catalogue are mixed up; whoever has a file of his own knows how many limbs his machine has.
TEST_F(Mistakes, OfRobotsAreThoseThatItMayBe) {
  EXPECT_EQ(count(all_kinds(robot), "robot"), 2);
  EXPECT_EQ(count(believed(all_kinds(robot)), "robot"), 0);
  robot = robot_named("delta");
  const auto all = detail::usual_mistakes(Input{robot, all_kinds(robot), {}});
  std::vector<std::string> robots;
  for (const Mistake& one : all) {
    if (one.family == "robot") robots.push_back(one.text);
  }
  EXPECT_THAT(robots, testing::ElementsAre("the robot is rotary_delta, not delta"));
}

/// The controller knew its robot; the file has one number that is not its. What the readings say that it should be.
class WrongNominal : public testing::Test {
 protected:
  /// What is told of the number of that name, and the number.
  std::pair<std::string, double> told(const std::string& key, void (*misprint)(RobotDescription&),
                                      bool distances = false) const {
    const Robot robot = catalogue::huang2016();
    Measurements read = measure(robot, {}, fine_stations(robot, 9), 2, {.noise = 0.017, .reads_rotation = true});
    for (Station& station : read.stations) station.believed = believed_joints(robot, station);
    if (distances) {
      for (std::size_t k = 1; k < read.stations.size(); ++k) {
        const PointReading &home = read.series[0].readings[0], &there = read.series[0].readings[k];
        read.distances.push_back({.from = 0,
                                  .to = k,
                                  .distance = (there.point - home.point).norm(),
                                  .rotation = *there.rotation - *home.rotation});
      }
      read.series.clear();
    }
    RobotDescription description = robot.description();
    description.workspace.radius = description.workspace.height = 1.0;
    misprint(description);
    const Input given{Robot(std::move(description)), read, {}};
    const auto fit = detail::fit_robustly(given);
    if (!fit) return {"no fit", 0.0};
    const std::vector<Mistake> all = detail::wrong_nominals(given, *fit);
    const auto found = std::ranges::find(all, key, &Mistake::family);
    if (found == all.end()) return {"nothing", 0.0};
    const std::string& text = found->text;
    return {text, std::stod(text.substr(text.find(" = ") + 3))};
  }
};

TEST_F(WrongNominal, LengthsAreToldInMillimetres) {
  const auto [plate, radius] = told("plate_radius_mm", [](RobotDescription& robot) {
    test::redimension(robot, [&](SharedDimensions& shared) { shared.plate_radius += 10.0; });
  });
  EXPECT_THAT(plate, testing::MatchesRegex(".*with plate_radius_mm = [0-9]+\\.[0-9] instead of 85"));
  EXPECT_NEAR(radius, 75.0, 1.5);
  const auto [rod, length] = told("rod_mm", [](RobotDescription& robot) {
    test::redimension(robot, [&](SharedDimensions& shared) { shared.rod += 10.0; });
  });
  EXPECT_THAT(rod, HasSubstr("with rod_mm = "));
  EXPECT_NEAR(length, 950.0, 1.5);
}

TEST_F(WrongNominal, AzimuthsAreToldInDegrees) {
  const auto [text, azimuth] = told("limb_azimuth_deg of limb 2", [](RobotDescription& robot) {
    test::redimension(robot, [&](SharedDimensions& shared) { shared.limb_azimuth[1] += to_radians(5.0); });
  });
  EXPECT_THAT(text, testing::MatchesRegex(".*limb_azimuth_deg of limb 2 = [-0-9]+\\.[0-9][0-9] instead of .*"));
  const double right = to_degrees(*catalogue::huang2016().limbs()[1].azimuth);
  EXPECT_NEAR(azimuth, right, 0.7);
}

/// By rotations of points and of distances.
TEST_F(WrongNominal, APinionIsToldByRotations) {
  const auto misprint = [](RobotDescription& robot) { robot.slide->pinion_radius += 2.0; };
  for (const bool distances : {false, true}) {
    const auto [text, radius] = told("pinion_radius_mm", misprint, distances);
    EXPECT_THAT(text, HasSubstr("with pinion_radius_mm = "));
    EXPECT_NEAR(radius, 12.0, 0.1);
  }
  EXPECT_EQ(told("pinion_radius_mm", [](RobotDescription&) {}).first, "nothing");
}

/// One error with prior 2 and posterior variance 1, found at 3: the objective's curvature along it is 1/4 - 1/16, its
/// slope 3/4, so it wants 4 more and gains 3.
TEST(CommonPart, OfOneErrorByHand) {
  detail::TrialFit fit;
  fit.sought = {{0, "rod_mean", 2.0}};
  fit.errors = Eigen::VectorXd::Constant(1, 3.0);
  fit.covariance = Eigen::MatrixXd::Constant(1, 1, 1.0);
  SourceErrors direction;
  direction(0, "rod_mean") = 1.0;
  EXPECT_NEAR(detail::common_part(fit, {direction}).amounts(0), 4.0, 1e-12);
  EXPECT_NEAR(detail::common_part(fit, {direction}).gain, 3.0, 1e-12);
  fit.covariance(0, 0) = 4.0;  // the readings say nothing
  EXPECT_EQ(detail::common_part(fit, {direction}).gain, 0.0);
  EXPECT_EQ(detail::common_part(fit, {direction}).amounts(0), 0.0);
}

/// Two errors that readings tell apart want what each wants by itself; the same direction twice is nothing.
TEST(CommonPart, OfTwoErrorsByHand) {
  detail::TrialFit fit;
  fit.sought = {{0, "rod_mean", 2.0}, {1, "rod_mean", 1.0}};
  fit.errors = Eigen::Vector2d(3.0, -1.0);
  fit.covariance = Eigen::Vector2d(1.0, 0.5).asDiagonal();
  SourceErrors one, other;
  one(0, "rod_mean") = 1.0;
  other(1, "rod_mean") = 1.0;
  const detail::CommonPart part = detail::common_part(fit, {one, other});
  EXPECT_NEAR(part.amounts(0), 4.0, 1e-12);
  EXPECT_NEAR(part.amounts(1), -2.0, 1e-12);
  EXPECT_NEAR(part.gain, 5.0, 1e-12);
  EXPECT_EQ(detail::common_part(fit, {one, one}).gain, 0.0);
}

class DimensionLaw : public EveryRobot {};
PARACAL_ON_EVERY_ROBOT(DimensionLaw);
PARACAL_ON_UNUSUAL_ROBOTS(DimensionLaw);

/// A robot whose file has another number is, to first order, the robot with the errors that the number stands for.
TEST_P(DimensionLaw, ErrorsAreWhatAnotherNumberDoes) {
  Random random;
  for (const detail::Dimension& one : detail::dimensions(robot)) {
    const double small = one.angle ? 1e-7 : 1e-4;
    const Machine other = detail::with(robot, one, detail::now(robot, one) + small).nominal();
    SourceErrors errors;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : all_sources()) errors(limb, source) = small * one.direction(limb, source);
    }
    for (int k = 0; k < 20; ++k) {
      const Pose pose = random.pose(robot);
      const Joints joints = inverse(robot.nominal(), pose).joints;
      const Eigen::Vector3d moved = forward(other, joints).plate.position - pose.position;
      const Eigen::Vector3d taken = forward(build(robot, errors), joints).plate.position - pose.position;
      ASSERT_LT((moved - taken).norm(), 1e-3 * moved.norm() + 1e-9) << one.key;
    }
  }
}

}  // namespace
}  // namespace paracal::test::mistakes_test
