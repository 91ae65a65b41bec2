#include "paracal/kinematics/inverse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "paracal/kinematics/forward.hpp"
#include "support/robots.hpp"

namespace paracal::inverse_test {
namespace {

using test::Random;

class ReachLaw : public test::EveryRobot {};
class InverseLaw : public test::EveryRobot {};

TEST_P(ReachLaw, BringsAMachineWithAllErrorsExactlyToThePose) {
  Random random;
  for (int k = 0; k < 2000; ++k) {
    const Machine machine = build(robot, random.realistic_errors(robot));
    const Pose pose = random.pose(robot);
    const InverseResult result = inverse(machine, pose);
    ASSERT_TRUE(result.ok());
    const ForwardResult reached = forward(machine, result.joints);
    ASSERT_TRUE(reached.ok());
    EXPECT_LT((reached.plate.position - pose.position).norm(), 1e-9);
    EXPECT_NEAR(reached.plate.slide, machine.slide_of(pose.rotation), 1e-9);
    EXPECT_LT(!robot.is_level() ? (reached.plate.tilt - pose.tilt).norm() : 0.0, 1e-11);
  }
}

TEST_P(InverseLaw, IsClosedFormUnlessSomethingTiltsThePlate) {
  Random random;
  SourceErrors errors;
  errors(0, "beta0") = 1e-3;
  errors(1, "e_y") = 0.5;
  const Pose pose = random.pose(robot);
  const Machine level = build(robot, errors);
  const InverseResult closed_form = inverse(level, pose);
  EXPECT_EQ(closed_form.iterations, 0);
  EXPECT_LT((forward(level, closed_form.joints).plate.position - pose.position).norm(), 1e-9);
  errors(2, "alpha2") = 1e-4;
  EXPECT_GT(inverse(build(robot, errors), pose).iterations, 0);
}

TEST_P(InverseLaw, NamesTheLimbThatDoesNotReach) {
  // Far out on the side of limb 1, the opposite limb is too short first.
  const Eigen::Vector3d far = 1000.0 * as_eigen(robot.nominal().limbs[0].radial) + robot.workspace().centre();
  const InverseResult result = inverse(robot.nominal(), {far, 0.0});
  EXPECT_EQ(result.status, InverseStatus::unreachable);
  ASSERT_GE(result.unreachable_limb, 0);
  EXPECT_TRUE(std::isnan(result.joints(result.unreachable_limb)));
}

TEST_P(ReachLaw, NanIsUnreachable) {
  Pose pose{robot.workspace().centre(), 0.0};
  pose.position.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(inverse(robot.nominal(), pose).status, InverseStatus::unreachable);
}

/// A plate that stays level is not asked to tilt, nor one with six freedoms to turn what it does not have, nor one with
/// guides to do what these hold.
TEST_P(ReachLaw, WhatAPlateCannotDoIsUnreachable) {
  Pose pose{robot.workspace().centre()};
  pose.tilt.y() = 1e-3;
  EXPECT_EQ(inverse(robot.nominal(), pose).ok(), !robot.is_level() && robot.freedoms().free[4]);
  pose = {robot.workspace().centre(), 1e-3};
  const InverseResult turned = inverse(robot.nominal(), pose);
  EXPECT_EQ(turned.ok(), robot.slide().has_value());
  EXPECT_EQ(turned.unreachable_limb, -1);
  pose = {robot.workspace().centre() + Eigen::Vector3d(0.0, 0.0, 1e-3)};
  const InverseResult lifted = inverse(robot.nominal(), pose);
  EXPECT_EQ(lifted.ok(), !robot.nominal().has_guides || robot.freedoms().free[2]);
  EXPECT_EQ(lifted.unreachable_limb, -1);
}

PARACAL_ON_EVERY_ROBOT(ReachLaw);
PARACAL_ON_UNUSUAL_ROBOTS(ReachLaw);
PARACAL_ON_ROBOT_TEMPLATES(ReachLaw);
PARACAL_ON_EVERY_ROBOT(InverseLaw);
PARACAL_ON_UNUSUAL_ROBOTS(InverseLaw);

TEST(Inverse, RigidPlateDoesNotTurn) {
  const Robot robot = catalogue::rotary_delta();
  const InverseResult result = inverse(robot.nominal(), {robot.workspace().centre(), 0.1});
  EXPECT_EQ(result.status, InverseStatus::unreachable);
  EXPECT_EQ(result.unreachable_limb, -1);
}

}  // namespace
}  // namespace paracal::inverse_test
