#include "paracal/mechanism/limb.hpp"

#include <gtest/gtest.h>

#include "paracal/mechanism/catalogue.hpp"
#include "support/robots.hpp"

namespace paracal::limb_test {
namespace {

class LimbLaw : public test::EveryRobot {};

Eigen::Vector3d elbow_at(const Limb& limb, double joint) {
  const auto ends = ends_at(limb, joint);
  return as_eigen(ends.elbow.centre);
}

TEST_P(LimbLaw, JointSolutionPutsTheElbowOneRodAway) {
  test::Random random;
  for (int k = 0; k < 1000; ++k) {
    const Pose pose = random.pose(robot);
    for (std::size_t i = 0; i < robot.limb_count(); ++i) {
      const Limb& limb = robot.nominal().limbs[i];
      const Eigen::Vector3d joint = pose.position + as_eigen(limb.plate);
      EXPECT_NEAR((joint - elbow_at(limb, joint_to(limb, joint))).norm(), limb.mean_rod(), 1e-10);
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
    const Eigen::Vector3d joint = random.pose(robot).position + as_eigen(limb.plate);
    const double found = joint_to(limb, joint);
    // The other root: the arm mirrored about the direction base joint -> plate joint, the carriage about the height of
    // the plate joint.
    const Eigen::Vector3d d = joint - as_eigen(limb.base);
    const double height = d.dot(as_eigen(limb.normal));
    const double other = 2.0 * (on_rail ? height : std::atan2(height, d.dot(as_eigen(limb.radial)))) - found;
    ASSERT_NEAR((joint - elbow_at(limb, other)).norm(), limb.mean_rod(), 1e-9);
    EXPECT_GT(on_rail ? found : std::cos(found), on_rail ? other : std::cos(other));
  }
}

TEST_P(LimbLaw, OutOfReachIsSaidNotGuessed) {
  const Limb& limb = robot.nominal().limbs[0];
  const Eigen::Vector3d far = (limb.arm + limb.mean_rod() + 1.0) * (as_eigen(limb.axis) - as_eigen(limb.normal));
  EXPECT_TRUE(std::isnan(joint_to(limb, as_eigen(limb.base) + far)));
}

TEST_P(LimbLaw, JointOffsetIsSubtractedFromTheCommand) {
  Limb limb = robot.nominal().limbs[0];
  const Eigen::Vector3d joint = robot.workspace().centre() + as_eigen(limb.plate);
  const double without = joint_to(limb, joint);
  limb.joint_offset += 0.01;
  EXPECT_NEAR(joint_to(limb, joint), without - 0.01, 1e-12);
}

PARACAL_ON_EVERY_ROBOT(LimbLaw);
PARACAL_ON_UNUSUAL_ROBOTS(LimbLaw);

}  // namespace
}  // namespace paracal::limb_test
