#include "paracal/mechanism/limb.hpp"

#include <gtest/gtest.h>

#include "paracal/mechanism/catalogue.hpp"
#include "support/robots.hpp"

namespace paracal {
namespace {

class LimbLaw : public test::EveryRobot {};

TEST_P(LimbLaw, ArmSolutionPutsTheElbowOneRodAway) {
  test::Random random;
  for (int k = 0; k < 1000; ++k) {
    const Pose pose = random.pose(robot);
    for (std::size_t i = 0; i < robot.limb_count(); ++i) {
      const Limb& limb = robot.nominal().limbs[i];
      const Eigen::Vector3d joint = pose.position + limb.plate;
      const ArmSolution arm = solve_arm(limb, joint);
      ASSERT_TRUE(arm.reached);
      const Eigen::Vector3d elbow = limb.base + limb.arm * arm_directions(limb, arm.joint).u1;
      EXPECT_NEAR((joint - elbow).norm(), limb.mean_rod(), 1e-10);
    }
  }
}

TEST_P(LimbLaw, WorkingModeIsTheElbowFurtherOut) {
  test::Random random;
  const Limb& limb = robot.nominal().limbs[0];
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Vector3d joint = random.pose(robot).position + limb.plate;
    const double found = solve_arm(limb, joint).joint;
    // The mirror image of the arm about the direction base joint -> plate joint is the other root.
    const Eigen::Vector3d d = joint - limb.base;
    const double direction = std::atan2(d.dot(limb.frame.col(1)), d.dot(limb.frame.col(0)));
    const double other = 2.0 * direction - found;
    const Eigen::Vector3d other_elbow = limb.base + limb.arm * arm_directions(limb, other).u1;
    ASSERT_NEAR((joint - other_elbow).norm(), limb.mean_rod(), 1e-9);
    EXPECT_GT(std::cos(found), std::cos(other));
  }
}

TEST_P(LimbLaw, OutOfReachIsSaidNotGuessed) {
  const Limb& limb = robot.nominal().limbs[0];
  const ArmSolution arm = solve_arm(limb, limb.base - Eigen::Vector3d(0, 0, limb.arm + limb.mean_rod() + 1.0));
  EXPECT_FALSE(arm.reached);
  EXPECT_TRUE(std::isnan(arm.joint));
}

TEST_P(LimbLaw, EncoderOffsetIsSubtractedFromTheCommand) {
  Limb limb = robot.nominal().limbs[0];
  const Eigen::Vector3d joint = robot.workspace().centre() + limb.plate;
  const double without = solve_arm(limb, joint).joint;
  limb.joint_offset = 0.01;
  EXPECT_NEAR(solve_arm(limb, joint).joint, without - 0.01, 1e-15);
}

PARACAL_ON_EVERY_ROBOT(LimbLaw);

}  // namespace
}  // namespace paracal
