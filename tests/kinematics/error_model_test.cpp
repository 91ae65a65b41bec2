#include "paracal/kinematics/error_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "paracal/error.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "support/robots.hpp"

namespace paracal::error_model_test {
namespace {

using test::Random;

class ErrorModelLaw : public test::EveryRobot {
 protected:
  struct PaperVectors {
    Eigen::VectorXd position, tilt;  ///< dp_d, dp_e
  };

  PaperVectors paper_vectors(const SourceErrors& errors) const {
    const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
    PaperVectors vectors{Eigen::VectorXd(limbs * ErrorModel::kPosition), Eigen::VectorXd(limbs * ErrorModel::kTilt)};
    Eigen::Index position = 0, tilt = 0;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : sources_of(robot.actuator())) {
        const double scaled = errors(limb, source) * paper_scale(robot, source);
        (tilts_plate(source) ? vectors.tilt(tilt++) : vectors.position(position++)) = scaled;
      }
    }
    return vectors;
  }
};

/// [huang2016, Eqs. (5), (6)] against the exact machine, at errors of 1e-3 mm and 1e-5 rad. The difference is second
/// order: it is compared with the typical displacement of the run, since single displacements can be near zero by
/// chance.
TEST_P(ErrorModelLaw, IsTheDerivativeOfTheExactModel) {
  Random random;
  double difference = 0.0, displacement = 0.0, tilt_difference = 0.0, tilt = 0.0;
  constexpr int kPoses = 500;
  for (int k = 0; k < kPoses; ++k) {
    const SourceErrors errors = random.errors(robot, 1e-3, 1e-5);
    const PaperVectors p = paper_vectors(errors);
    const Pose pose = random.pose(robot);
    const ErrorModel model = error_model(robot, pose);
    ASSERT_TRUE(model.ok());
    const ForwardResult exact = forward(build(robot, errors), model.joints);
    ASSERT_TRUE(exact.ok());
    Eigen::VectorXd delta(robot.limb_count());
    delta.head<3>() = exact.plate.position - pose.position;
    if (robot.slide()) delta(3) = exact.plate.slide - robot.nominal().slide_of(pose.rotation);
    difference = std::max(difference, (model.G_dd * p.position + model.G_de * p.tilt - delta).norm());
    tilt_difference = std::max(tilt_difference, (model.G_ee * p.tilt - exact.plate.tilt).norm());
    displacement += delta.norm() / kPoses;
    tilt += exact.plate.tilt.norm() / kPoses;
  }
  EXPECT_LT(difference, 1e-4 * displacement);
  EXPECT_LT(tilt_difference, 1e-4 * tilt);
}

/// Two derivations of the same matrices: the paper's, limb by limb on centre lines, and the rod-by-rod least squares.
TEST_P(ErrorModelLaw, EqualsTheExactJacobianAtZeroError) {
  Random random;
  for (int k = 0; k < 100; ++k) {
    const Pose pose = random.pose(robot);
    const ErrorModel model = error_model(robot, pose);
    PlateState plate;
    plate.position = pose.position;
    plate.slide = robot.nominal().slide_of(pose.rotation);
    const ExactJacobian exact = exact_jacobian(robot.nominal(), plate, model.joints);
    ASSERT_TRUE(model.ok() && exact.ok);
    const auto n = static_cast<Eigen::Index>(robot.limb_count());
    Eigen::Index position = 0, tilt = 0;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : sources_of(robot.actuator())) {
        const Eigen::VectorXd column =
            exact.plate.col(static_cast<Eigen::Index>(robot.nominal().parameter(limb, source))) /
            paper_scale(robot, source);
        Eigen::VectorXd paper = Eigen::VectorXd::Zero(n + 3);
        if (tilts_plate(source)) {
          paper << model.G_de.col(tilt), model.G_ee.col(tilt);
          ++tilt;
        } else {
          paper.head(n) = model.G_dd.col(position++);
        }
        EXPECT_LT((column - paper).norm(), 1e-12 * (1.0 + paper.norm())) << name(source) << " of limb " << limb + 1;
      }
    }
  }
}

TEST_P(ErrorModelLaw, SaysWhenThePoseIsOutOfReach) {
  EXPECT_EQ(error_model(robot, {{5000, 0, -5000}, 0.0}).status, ErrorModelStatus::unreachable);
}

TEST_P(ErrorModelLaw, CommonShiftOfAllBaseJointsShiftsThePlate) {
  const ErrorModel model = error_model(robot, {robot.workspace().centre(), 0.0});
  Eigen::VectorXd p = Eigen::VectorXd::Zero(model.G_dd.cols());
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) p(limb * ErrorModel::kPosition + index("e_y")) = 1.0;
  const Eigen::VectorXd delta = model.G_dd * p;
  EXPECT_LT((delta.head<3>() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT(delta.tail(delta.size() - 3).norm(), 1e-12);
}

PARACAL_ON_EVERY_ROBOT(ErrorModelLaw);
PARACAL_ON_UNUSUAL_ROBOTS(ErrorModelLaw);

/// Along x instead of y the slide cannot be told from a rotation-free shift: A_dd is singular on the axis of the
/// workspace (docs/paper-slips.md), which is how the paper's unstated slide direction was found.
TEST(ErrorModel, SlideAlongXIsSingularOnTheAxis) {
  RobotDescription description = catalogue::huang2016().description();
  description.slide->axis = {1, 0, 0};
  EXPECT_THAT([&] { const Robot robot(description); },
              testing::ThrowsMessage<InvalidArgument>(testing::HasSubstr("singular at (0, 0, -888) mm")));
}

}  // namespace
}  // namespace paracal::error_model_test
