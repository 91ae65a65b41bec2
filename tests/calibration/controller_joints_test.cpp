// Joints that a controller displays, against the dimensions of a robot file.

#include "paracal/calibration/controller_joints.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>

#include "paracal/calibration/controller_model.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::controller_joints_test {
namespace {

using testing::AllOf, testing::Contains, testing::ElementsAre, testing::HasSubstr, testing::IsEmpty, testing::Not,
    testing::SizeIs, testing::StartsWith;

using Change = std::function<void(RobotDescription&)>;

/// A controller whose dimensions are those of a robot but for one change.
Robot changed(const Robot& robot, const Change& change) {
  RobotDescription description = robot.description();
  description.workspace.radius *= 0.5;  // shorter rods reach less
  description.tolerances = tolerances_of(robot);
  change(description);
  return Robot(std::move(description));
}

Change longer_rod(double mm) {
  return [mm](RobotDescription& one) { test::redimension(one, [&](SharedDimensions& shared) { shared.rod += mm; }); };
}

/// What a display with so many decimals (deg or mm) shows.
DisplayedJoints displayed(const Robot& controller, const Pose& pose, int decimals = 4) {
  const Unit unit = joint_unit(controller.actuator());
  const double digit = std::pow(10.0, -decimals);
  DisplayedJoints one{"P", pose, inverse(controller.nominal(), pose).joints, {}, 2};
  one.rounding = Joints::Constant(one.joints.size(), from_file_unit(unit, 0.5 * digit));
  for (double& joint : one.joints) joint = from_file_unit(unit, digit * std::round(to_file_unit(unit, joint) / digit));
  return one;
}

Pose home(const Robot& robot) { return {robot.workspace().centre()}; }
Pose towards(const Robot& robot, double azimuth) {
  const Workspace& workspace = robot.workspace();
  return {Workspace::on_circle(0.45 * workspace.radius, azimuth, workspace.centre().z())};
}

class ControllerJoints : public test::EveryRobot {};

TEST_P(ControllerJoints, OfTheSameDimensionsAgreeWithinTheirRounding) {
  for (const int decimals : {0, 1, 2, 3, 4}) {
    EXPECT_TRUE(check_controller(
                    robot, {displayed(robot, home(robot), decimals), displayed(robot, towards(robot, 0.3), decimals)})
                    .agrees())
        << decimals;
  }
}

/// The machine of the case: rods 10 mm longer in the file than in the controller.
TEST_P(ControllerJoints, AtHomeAndOnTheRimNameTheRod) {
  const Robot controller = changed(robot, longer_rod(-10.0));
  const ControllerCheck check =
      check_controller(robot, {displayed(controller, home(robot)), displayed(controller, towards(robot, 0.3))});
  ASSERT_FALSE(check.agrees());
  EXPECT_EQ(*check.differs, 0u);
  const double rod = sizes_of(robot.limbs()).rod;
  EXPECT_THAT(check.explanations, ElementsAre(fmt::format("rod {:.2f} mm instead of {:g} mm", rod - 10.0, rod)));
  EXPECT_TRUE(check.is_named);
  EXPECT_FALSE(check.deciding);
}

/// And the pose that is asked for decides.
TEST_P(ControllerJoints, AtHomeAloneDoNotDecide) {
  const Robot controller = changed(robot, longer_rod(-10.0));
  const DisplayedJoints at_home = displayed(controller, home(robot));
  const ControllerCheck check = check_controller(robot, {at_home});
  EXPECT_THAT(check.explanations, Contains(StartsWith("rod ")));
  EXPECT_THAT(check.explanations, Contains(HasSubstr("plate radius ")));
  EXPECT_THAT(check.explanations, Contains(HasSubstr("origin at z")));
  ASSERT_TRUE(check.deciding);
  Pose nearer = *check.deciding;  // that the shorter rods reach
  nearer.position.head<2>() *= 0.5;
  EXPECT_THAT(check_controller(robot, {at_home, displayed(controller, nearer)}).explanations,
              ElementsAre(StartsWith("rod ")));
}

INSTANTIATE_TEST_SUITE_P(Robots, ControllerJoints, testing::Values("huang2016", "rotary_delta", "linear_delta"),
                         test::robot_name);

class OneController : public testing::Test {
 protected:
  std::vector<std::string> explained(const std::function<Joints(const Pose&)>& joints) const {
    std::vector<DisplayedJoints> all;
    for (const Pose& pose : {home(robot), towards(robot, 0.0), towards(robot, 2.0)}) {
      DisplayedJoints one = displayed(robot, pose, 6);
      one.joints = joints(pose);
      all.push_back(one);
    }
    return check_controller(robot, all).explanations;
  }
  Joints of(const Robot& controller, const Pose& pose) const { return inverse(controller.nominal(), pose).joints; }

  const Robot robot = test::robot_named("rotary_delta");
};

TEST_F(OneController, WithAnotherOriginIsToldWhere) {
  EXPECT_THAT(explained([&](const Pose& pose) { return of(robot, {pose.position + Eigen::Vector3d(3, -2, 5)}); }),
              ElementsAre("origin at (3.00, -2.00, 5.00) mm in the robot file's frame"));
  EXPECT_THAT(explained([&](const Pose& pose) { return of(robot, {pose.position + Eigen::Vector3d(0, 0, 5)}); }),
              ElementsAre("origin at z 5.00 mm in the robot file's frame (or a tool in the controller with its tip at "
                          "z -5.00 mm from the plate, which gives the same joints)"));
}

/// Joints of another order, a frame rotated about z, and joints of one limb that are off.
TEST_F(OneController, WithOtherLimbsOrFrameIsToldWhich) {
  const auto in_order = [&](const std::vector<int>& order) {
    return explained([&, order](const Pose& pose) {
      const Joints right = of(robot, pose);
      Joints shown = right;
      for (int k = 0; k < 3; ++k) shown(k) = right(order[static_cast<std::size_t>(k)]);
      return shown;
    });
  };
  EXPECT_THAT(in_order({0, 2, 1}), ElementsAre("limbs 2 and 3 swapped"));
  EXPECT_THAT(in_order({1, 2, 0}), ElementsAre(HasSubstr("limbs in another order: q1 ... are those of limbs 2, 3, 1")));
  for (const double turn : {30.0, -7.0, 90.0}) {
    EXPECT_THAT(explained([&](Pose pose) {
                  pose.position = Eigen::AngleAxisd(to_radians(turn), Eigen::Vector3d::UnitZ()) * pose.position;
                  return of(robot, pose);
                }),
                ElementsAre(fmt::format("frame rotated by {:.3f} deg about z of the robot file's frame", turn)));
  }
  EXPECT_THAT(explained([&](const Pose& pose) -> Joints { return 1.05 * of(robot, pose); }),
              ElementsAre("gear ratio: the controller shows 1.05 times the joints"));
  EXPECT_THAT(explained([&](const Pose& pose) -> Joints { return to_radians(1.0) * of(robot, pose); }),
              ElementsAre("joints in radians: multiply them by 57.29578"));
  EXPECT_THAT(explained([&](const Pose& pose) -> Joints { return of(robot, pose) + 0.02 * Joints::Unit(3, 1); }),
              ElementsAre(StartsWith("the zero of limb 2: the controller shows 1.146")));
  SourceErrors longer;
  longer(2, "rod_mean") = 4.0;
  EXPECT_THAT(explained([&](const Pose& pose) { return inverse(build(robot, longer), pose).joints; }),
              ElementsAre(StartsWith("rod of limb 3 ")));
}

/// An origin fits any three joints, so that one pose of three limbs never names one cause.
TEST_F(OneController, IsNotNamedByAsManyUnknownsAsJoints) {
  DisplayedJoints one = displayed(robot, towards(robot, 0.4), 3);
  one.joints = of(robot, {one.pose.position + Eigen::Vector3d(3, -2, 5)});
  const ControllerCheck check = check_controller(robot, {one});
  EXPECT_THAT(check.explanations, ElementsAre(StartsWith("origin at (3.")));
  EXPECT_FALSE(check.is_named);
  ASSERT_TRUE(check.deciding);
  DisplayedJoints other = displayed(robot, *check.deciding, 3);
  other.joints = of(robot, {other.pose.position + Eigen::Vector3d(3, -2, 5)});
  EXPECT_TRUE(check_controller(robot, {one, other}).is_named);
}

/// Joints that agree confirm only what they would show: at home no rotation about z and no order of the limbs.
TEST_F(OneController, IsConfirmedOnlyWhereTheSuspectsDiffer) {
  const ControllerCheck at_home = check_controller(robot, {displayed(robot, home(robot), 3)});
  EXPECT_TRUE(at_home.agrees());
  EXPECT_THAT(at_home.unseen, AllOf(Contains("the direction of x and y"), Contains("the order of limbs 2 and 3"),
                                    Contains("the order of the limbs")));
  ASSERT_TRUE(at_home.deciding);
  const ControllerCheck decided =
      check_controller(robot, {displayed(robot, home(robot), 3), displayed(robot, *at_home.deciding, 3)});
  EXPECT_TRUE(decided.agrees());
  EXPECT_THAT(decided.unseen, IsEmpty());
  // Along x limbs 2 and 3 are alike, and limb 1 moves in its plane.
  EXPECT_THAT(check_controller(robot, {displayed(robot, towards(robot, 0.0), 3)}).unseen,
              testing::UnorderedElementsAre("the order of limbs 2 and 3", "limb azimuth of limb 1"));
}

TEST_F(OneController, WithOtherJointsIsToldWhich) {
  EXPECT_THAT(explained([&](const Pose& pose) -> Joints { return -of(robot, pose); }),
              ElementsAre("joints with the opposite sign: multiply them by -1"));
  const Robot shorter = changed(robot, longer_rod(-10.0));
  EXPECT_THAT(explained([&](const Pose& pose) -> Joints { return -of(shorter, pose); }),
              ElementsAre(StartsWith("joints with the opposite sign, and rod ")));
  EXPECT_THAT(explained([&](const Pose& pose) -> Joints { return of(robot, pose).array() + to_radians(2.0); }),
              ElementsAre("the zero of all joints: the controller shows 2.000 deg more"));
}

/// Only the difference of the two radii enters the joints.
TEST_F(OneController, WithAnotherRadiusIsToldBoth) {
  const double base = sizes_of(robot.limbs()).base_radius, plate = sizes_of(robot.limbs()).plate_radius;
  const Robot controller = changed(robot, [](RobotDescription& one) {
    test::redimension(one, [&](SharedDimensions& shared) { shared.base_radius += 4.0; });
  });
  EXPECT_THAT(explained([&](const Pose& pose) { return of(controller, pose); }),
              ElementsAre(fmt::format("base radius {:.2f} mm instead of {:g} mm (or plate radius {:.2f} mm "
                                      "instead of {:g} mm, which gives the same joints)",
                                      base + 4.0, base, plate - 4.0, plate)));
}

TEST_F(OneController, WithTwoOtherDimensionsIsNotExplained) {
  const Robot controller = changed(robot, [](RobotDescription& one) {
    test::redimension(one, [&](SharedDimensions& shared) { shared.rod += 7.0; });
    test::redimension(one, [&](SharedDimensions& shared) { shared.arm -= 4.0; });
  });
  EXPECT_THAT(explained([&](const Pose& pose) { return of(controller, pose); }), IsEmpty());
}

TEST_F(OneController, DiffersByMoreThanTheRoundingAndNoLess) {
  DisplayedJoints one = displayed(robot, home(robot), 2);
  one.joints = of(robot, one.pose);
  const double half = one.rounding(1);
  one.joints(1) += 0.98 * half;
  EXPECT_TRUE(check_controller(robot, {one}).agrees());
  one.joints(1) += 0.1 * half;
  const ControllerCheck check = check_controller(robot, {one});
  ASSERT_FALSE(check.agrees());
  EXPECT_EQ(check.limb, 1u);
  EXPECT_DOUBLE_EQ(check.expected, of(robot, one.pose)(1));
}

TEST_F(OneController, IsRefusedWithoutPosesOrWithOtherLimbs) {
  EXPECT_THROW((void)check_controller(robot, {}), InvalidArgument);
  DisplayedJoints one = displayed(robot, home(robot));
  one.joints.conservativeResize(2);
  EXPECT_THROW((void)check_controller(robot, {one}), InvalidArgument);
}

TEST_F(OneController, ShowsJointsAtHomeAndOnTheRim) {
  const std::vector<ComparisonPose> poses = comparison_poses(robot);
  ASSERT_THAT(poses, SizeIs(3));
  EXPECT_EQ(poses[0].pose.position, robot.workspace().centre());
  for (const std::size_t k : {1u, 2u}) {
    EXPECT_DOUBLE_EQ(poses[k].pose.position.head<2>().norm(), robot.workspace().radius);
    EXPECT_EQ(poses[k].joints, of(robot, poses[k].pose));
  }
}

TEST_F(OneController, IsAssumedUntilItIsKnown) {
  EXPECT_THAT(controller_assumptions({}, robot),
              ElementsAre(AllOf(StartsWith("the controller computes joints with rod "), HasSubstr("plate radius"),
                                HasSubstr("--controller-joints"))));
  EXPECT_THAT(controller_assumptions({.evidence = ControllerEvidence::confirmed, .source = "2 poses of j.csv"}, robot),
              ElementsAre(StartsWith("confirmed by 2 poses of j.csv: the controller computes joints with rod ")));
  EXPECT_THAT(
      controller_assumptions({.source = "one pose agrees"}, robot),
      ElementsAre(AllOf(StartsWith("the controller computes joints with rod "), HasSubstr("; one pose agrees"))));
  for (const ControllerEvidence known : {ControllerEvidence::readings, ControllerEvidence::stated}) {
    EXPECT_THAT(controller_assumptions({.evidence = known}, robot), IsEmpty());
    EXPECT_EQ(controller_evidence(name(known)), known);
  }
  EXPECT_EQ(controller_evidence("guessed"), std::nullopt);
}

TEST_F(OneController, IsReadWhereAllStationsStateJoints) {
  Measurements measurements{.stations = {{"A", home(robot), of(robot, home(robot))}, {"B", towards(robot, 0.0)}}};
  EXPECT_EQ(with_readings({}, measurements).evidence, ControllerEvidence::assumed);
  measurements.stations.pop_back();
  EXPECT_EQ(with_readings({}, measurements).evidence, ControllerEvidence::readings);
}

TEST_F(OneController, IsKnownToACalibrationFromReadingsWithJoints) {
  Measurements measured = test::measured_machine(robot, fine_stations(robot, 9), 1, {.noise = 0.02}).measurements;
  for (Station& station : measured.stations) station.believed = believed_joints(robot, station);
  const Calibration found = calibrate(robot, measured, {.states_use = false, .diagnose = false});
  EXPECT_EQ(found.options.controller.evidence, ControllerEvidence::readings);
  EXPECT_THAT(found.assumed, Not(Contains(HasSubstr("--controller-joints"))));
}

TEST_F(OneController, CommandsItsOwnJoints) {
  const Robot controller = changed(robot, longer_rod(-10.0));
  const Measurements commanded = commanded_by(controller, {.stations = {{"A", home(robot)}}});
  EXPECT_EQ(*commanded.stations[0].believed, of(controller, home(robot)));
}

}  // namespace
}  // namespace paracal::controller_joints_test
