#include "paracal/mechanism/limb.hpp"

#include <gtest/gtest.h>

#include "paracal/mechanism/catalogue.hpp"
#include "support/robots.hpp"

namespace paracal::limb_test {
namespace {

class LimbLaw : public test::EveryRobot {};

Eigen::Vector3d elbow_at(const Limb& limb, double joint) {
  return limb.base + elbow_lever(limb, joint, arm_directions(limb, joint));
}

TEST_P(LimbLaw, JointSolutionPutsTheElbowOneRodAway) {
  test::Random random;
  for (int k = 0; k < 1000; ++k) {
    const Pose pose = random.pose(robot);
    for (std::size_t i = 0; i < robot.limb_count(); ++i) {
      const Limb& limb = robot.nominal().limbs[i];
      const Eigen::Vector3d joint = pose.position + limb.plate;
      const JointSolution solution = solve_joint(limb, joint);
      ASSERT_TRUE(solution.reached);
      EXPECT_NEAR((joint - elbow_at(limb, solution.joint)).norm(), limb.mean_rod(), 1e-10);
    }
  }
}

/// An arm's elbow is the one further out, a carriage the one further up.
TEST_P(LimbLaw, WorkingModeIsTheElbowFurtherOutOrUp) {
  test::Random random;
  Limb limb = robot.nominal().limbs[0];
  limb.joint_offset = 0.0;
  const bool on_rail = limb.actuator == Actuator::linear;
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Vector3d joint = random.pose(robot).position + limb.plate;
    const double found = solve_joint(limb, joint).joint;
    // The other root: the arm mirrored about the direction base joint -> plate joint, the carriage about the height of
    // the plate joint.
    const Eigen::Vector3d d = joint - limb.base;
    const double height = d.dot(limb.frame.col(1));
    const double other = 2.0 * (on_rail ? height : std::atan2(height, d.dot(limb.frame.col(0)))) - found;
    ASSERT_NEAR((joint - elbow_at(limb, other)).norm(), limb.mean_rod(), 1e-9);
    EXPECT_GT(on_rail ? found : std::cos(found), on_rail ? other : std::cos(other));
  }
}

TEST_P(LimbLaw, OutOfReachIsSaidNotGuessed) {
  const Limb& limb = robot.nominal().limbs[0];
  const Eigen::Vector3d far = (limb.arm + limb.mean_rod() + 1.0) * (limb.frame.col(2) - limb.frame.col(1));
  const JointSolution solution = solve_joint(limb, limb.base + far);
  EXPECT_FALSE(solution.reached);
  EXPECT_TRUE(std::isnan(solution.joint));
}

TEST_P(LimbLaw, JointOffsetIsSubtractedFromTheCommand) {
  Limb limb = robot.nominal().limbs[0];
  const Eigen::Vector3d joint = robot.workspace().centre() + limb.plate;
  const double without = solve_joint(limb, joint).joint;
  limb.joint_offset += 0.01;
  EXPECT_NEAR(solve_joint(limb, joint).joint, without - 0.01, 1e-12);
}

PARACAL_ON_EVERY_ROBOT(LimbLaw);
PARACAL_ON_UNUSUAL_ROBOTS(LimbLaw);

}  // namespace
}  // namespace paracal::limb_test
