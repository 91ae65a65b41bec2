#include "paracal/kinematics/forward.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "kinematics/linear_closure.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/base_motion.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::forward_test {
namespace {

using test::Random;

class ForwardLaw : public test::EveryRobot {
 protected:
  /// Norm of J^T f at a plate state, from the kernels, not from what the solver says of itself.
  double gradient_norm(const Machine& machine, const Joints& joints, const PlateState& plate) const {
    return detail::with_limb_count(machine, [&]<int N>() {
      return detail::linearize<N>(machine, plate, detail::ends_of<N>(machine, joints)).gradient().norm();
    });
  }

  static double distance(const PlateState& a, const PlateState& b) {
    return (a.position - b.position).norm() + std::abs(a.slide - b.slide) + 50.0 * (a.tilt - b.tilt).norm();
  }
};

TEST_P(ForwardLaw, UndoesTheInverseTo1e9mmOver100000Poses) {
  Random random;
  double worst = 0.0;
  for (int k = 0; k < 100'000; ++k) {
    const Pose pose = random.pose(robot);
    const InverseResult joints = inverse(robot.nominal(), pose);
    ASSERT_TRUE(joints.ok());
    const ForwardResult result = forward(robot.nominal(), joints.joints);
    ASSERT_TRUE(result.ok());
    const double slide_error = result.plate.slide - robot.nominal().slide_of(pose.rotation);
    worst = std::max({worst, (result.plate.position - pose.position).norm(), std::abs(slide_error),
                      50.0 * (result.plate.tilt - pose.tilt).norm()});
  }
  EXPECT_LT(worst, 1e-9);
}

TEST_P(ForwardLaw, GradientVanishesToMachinePrecision) {
  Random random;
  for (int k = 0; k < 1000; ++k) {
    const Machine machine = build(robot, random.realistic_errors(robot));
    const Joints joints = inverse(robot.nominal(), random.pose(robot)).joints;
    const ForwardResult result = forward(machine, joints);
    ASSERT_TRUE(result.ok());
    // Residuals are rounded at 1e-13 mm (rods of 1 m), levers are up to 150 mm: 8 x 1e-13 x 150.
    EXPECT_LT(gradient_norm(machine, joints, result.plate), 1.2e-10);
    EXPECT_NEAR(result.gradient, gradient_norm(machine, joints, result.plate), 1e-10);
  }
}

TEST_P(ForwardLaw, SameAnswerFromAnyStartWithin50mm) {
  Random random;
  for (int k = 0; k < 300; ++k) {
    const Machine machine = build(robot, random.realistic_errors(robot));
    const Joints joints = inverse(robot.nominal(), random.pose(robot)).joints;
    const ForwardResult reference = forward(machine, joints);
    for (int start = 0; start < 10; ++start) {
      ForwardOptions options{.start = reference.plate};
      options.start->position += random.within(50.0);
      options.start->tilt += random.within(0.2);
      if (machine.has_slide()) options.start->slide += random.uniform(-50.0, 50.0);
      const ForwardResult again = forward(machine, joints, options);
      ASSERT_TRUE(again.ok());
      EXPECT_LT(distance(again.plate, reference.plate), 1e-9);
    }
  }
}

TEST_P(ForwardLaw, ClosesExactlyWhenNothingTiltsThePlate) {
  Random random;
  for (int k = 0; k < 200; ++k) {
    SourceErrors errors = random.realistic_errors(robot);
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : sources_of(robot.actuator())) errors(limb, source) *= tilts_plate(source) ? 0.0 : 1.0;
    }
    const ForwardResult result = forward(build(robot, errors), inverse(robot.nominal(), random.pose(robot)).joints);
    ASSERT_TRUE(result.ok());
    EXPECT_LT(result.residual, 1e-11);
    EXPECT_LT(!robot.is_level() ? 0.0 : result.plate.tilt.norm(), 1e-13);
  }
}

TEST_P(ForwardLaw, MovingAllBaseJointsTogetherMovesThePlateAlong) {
  Random random;
  const bool keeps_z = robot.nominal().has_guides && robot.freedoms().holds_z();
  const Eigen::Vector3d shift(0.7, -0.4, keeps_z ? 0.0 : 1.1);
  const bool on_rails = robot.actuator() == Actuator::carriage;
  for (int k = 0; k < 100; ++k) {
    SourceErrors errors = random.realistic_errors(robot);
    for (std::size_t limb = 0; limb < robot.limb_count() && on_rails; ++limb) {
      errors(limb, "alpha0") = errors(limb, "beta0") = 0.0;  // they are shifted along where they should lie
    }
    const Joints joints = inverse(robot.nominal(), random.pose(robot)).joints;
    const ForwardResult before = forward(build(robot, errors), joints);
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      if (on_rails) shift_limb(robot, limb, shift, errors);
      for (std::size_t axis = 0; axis < 3 && !on_rails; ++axis) {
        errors(limb, sources_of(robot.actuator())[1 + axis]) += shift(static_cast<Eigen::Index>(axis));
      }
    }
    const ForwardResult after = forward(build(robot, errors), joints);
    ASSERT_TRUE(before.ok() && after.ok());
    EXPECT_LT((after.plate.position - before.plate.position - shift).norm(), 1e-9);
    EXPECT_NEAR(after.plate.slide, before.plate.slide, 1e-9);
  }
}

TEST_P(ForwardLaw, ScalingEveryLengthScalesThePoseAndKeepsTheAngles) {
  constexpr double kScale = 2.5;
  RobotDescription description = robot.description();
  for (double* length : {&description.workspace.radius, &description.workspace.height, &description.workspace.top_z}) {
    *length *= kScale;
  }
  if (description.slide) description.slide->pinion_radius *= kScale;
  description.workspace.axis *= kScale;
  if (auto& box = description.workspace.box) {
    for (std::array<double, 2>* range : {&box->x, &box->y, &box->z}) {
      for (double& end : *range) end *= kScale;
    }
  }
  for (Workspace::Level& level : description.workspace.levels) {
    level.z *= kScale;
    level.radius *= kScale;
  }
  for (LimbDescription& limb : description.limbs) {
    limb.base *= kScale;
    limb.plate *= kScale;
    limb.length *= kScale;
    limb.arm *= kScale;
    limb.width *= kScale;
    if (joint_unit(limb.kind) == Unit::mm) limb.zero *= kScale;
  }
  const Robot larger(description);
  Random random;
  for (int k = 0; k < 100; ++k) {
    const Pose pose = random.pose(robot);
    const InverseResult small = inverse(robot.nominal(), pose);
    const InverseResult large = inverse(larger.nominal(), {kScale * pose.position, pose.rotation, pose.tilt});
    const double joint_scale = joint_unit(robot.actuator()) == Unit::mm ? kScale : 1.0;
    EXPECT_LT((joint_scale * small.joints - large.joints).cwiseAbs().maxCoeff(), joint_scale == 1.0 ? 1e-12 : 1e-10);
  }
}

TEST(Forward, RodsThatDoNotMeetAreNotAPose) {
  RobotDescription description = catalogue::rotary_delta().description();
  test::redimension(description, [&](SharedDimensions& shared) { shared.base_radius = 400.0; });
  test::redimension(description, [&](SharedDimensions& shared) { shared.rod = 600.0; });
  description.workspace = {.radius = 50.0, .height = 20.0, .top_z = -500.0};
  const Robot robot(description);
  // Level arms put the elbows 740 mm from where the rods, 600 mm long, would have to meet.
  const ForwardResult result = forward(robot.nominal(), Joints::Zero(3));
  EXPECT_FALSE(result.ok());
  EXPECT_GT(result.residual, 100.0);
}

TEST_P(ForwardLaw, NanIsAStatusNotAPose) {
  Joints joints = inverse(robot.nominal(), {robot.workspace().centre(), 0.0}).joints;
  joints(1) = std::numeric_limits<double>::quiet_NaN();
  const ForwardResult result = forward(robot.nominal(), joints);
  EXPECT_FALSE(result.ok());
  EXPECT_LE(result.iterations, ForwardOptions{}.max_iterations);
}

PARACAL_ON_EVERY_ROBOT(ForwardLaw);
PARACAL_ON_UNUSUAL_ROBOTS(ForwardLaw);
PARACAL_ON_ROBOT_TEMPLATES(ForwardLaw);

/// Independent oracle for a Delta without tilt errors: the wrist is the lower intersection of three spheres about the
/// elbows drawn in by the plate joints, found by trilateration in the plane of their centres.
Eigen::Vector3d trilaterate(const Machine& machine, const Joints& joints) {
  std::array<Eigen::Vector3d, 3> centre;
  std::array<double, 3> radius{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Limb& limb = machine.limbs[i];
    const double joint = limb.gain() * joints(static_cast<Eigen::Index>(i)) + limb.joint_offset;  // an arm's gain is 1
    const double along = limb.actuator == Actuator::linear ? -1.0 : std::cos(joint);
    const double up = limb.actuator == Actuator::linear ? joint : limb.arm * std::sin(joint);
    centre[i] = as_eigen(limb.base) + along * limb.arm * as_eigen(limb.radial) + up * as_eigen(limb.normal) -
                as_eigen(limb.plate);
    radius[i] = limb.rod[0];
  }
  const Eigen::Vector3d ex = (centre[1] - centre[0]).normalized();
  const double d = (centre[1] - centre[0]).norm(), i = ex.dot(centre[2] - centre[0]);
  const Eigen::Vector3d ey = (centre[2] - centre[0] - i * ex).normalized();
  const double j = ey.dot(centre[2] - centre[0]);
  const Eigen::Vector3d ez = ex.cross(ey);
  const double x = (radius[0] * radius[0] - radius[1] * radius[1] + d * d) / (2 * d);
  const double y = (radius[0] * radius[0] - radius[2] * radius[2] + i * i + j * j - 2 * i * x) / (2 * j);
  const double z = std::sqrt(radius[0] * radius[0] - x * x - y * y);
  return centre[0] + x * ex + y * ey + (ez.z() > 0 ? -z : z) * ez;
}

class ForwardOracle : public testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Deltas, ForwardOracle, testing::Values("rotary_delta", "linear_delta"), test::robot_name);

TEST_P(ForwardOracle, TrilaterationOfADelta) {
  const Robot robot = catalogue::find(GetParam());
  Random random;
  for (int k = 0; k < 1000; ++k) {
    SourceErrors errors;
    for (std::size_t limb = 0; limb < 3; ++limb) {
      errors(limb, "theta_offset") = random.uniform(-0.02, 0.02);
      errors(limb, "arm_length") = random.uniform(-1.0, 1.0);
      errors(limb, "rod_mean") = random.uniform(-1.0, 1.0);
      errors(limb, "e_z") = random.uniform(-1.0, 1.0);
      errors(limb, "alpha0") = random.uniform(-0.01, 0.01);
      errors(limb, "beta0") = random.uniform(-0.01, 0.01);
    }
    const Machine machine = build(robot, errors);
    const Joints joints = inverse(robot.nominal(), random.pose(robot)).joints;
    EXPECT_LT((forward(machine, joints).plate.position - trilaterate(machine, joints)).norm(), 1e-9);
  }
}

/// docs/conventions.md, "Check your signs": exact answers of huang2016 at home, computed from Eq. (1) by a separate
/// program.
struct SignCheck {
  Source source;
  double value;  ///< mm or rad
  std::vector<std::size_t> limbs;
  Eigen::Vector3d position;  ///< mm
  double slide;              ///< mm
};

TEST(ForwardOracle, SignsAsInTheConventions) {
  const Robot robot = catalogue::huang2016();
  const Pose home{robot.workspace().centre(), 0.0};
  const Joints joints = inverse(robot.nominal(), home).joints;
  const std::vector<std::size_t> all{0, 1, 2, 3};
  for (const SignCheck& check : {
           SignCheck{"theta_offset", to_radians(1.0), all, {0, 0, 7.188}, 0},
           SignCheck{"theta_offset", to_radians(1.0), {0}, {4.243, -4.192, 1.831}, 4.192},
           SignCheck{"e_z", 1.0, all, {0, 0, 1}, 0},
           SignCheck{"arm_length", 1.0, all, {0, 0, 0.393}, 0},
           SignCheck{"rod_mean", 1.0, all, {0, 0, -1.169}, 0},
           SignCheck{"e_y", 1.0, {0, 1}, {0, 0.5, 0}, -0.5},
       }) {
    SourceErrors errors;
    for (const std::size_t limb : check.limbs) errors(limb, check.source) = check.value;
    const PlateState plate = forward(build(robot, errors), joints).plate;
    EXPECT_LT((plate.position - home.position - check.position).cwiseAbs().maxCoeff(), 6e-4) << name(check.source);
    EXPECT_NEAR(plate.slide, check.slide, 6e-4) << name(check.source);
  }
}

/// The same for the tilt group, linear, on limb 1: tilt in mrad.
TEST(ForwardOracle, TiltSignsAsInTheConventions) {
  const Robot robot = catalogue::huang2016();
  const ErrorModel model = error_model(robot, {robot.workspace().centre(), 0.0});
  const auto tilt = [&](Source source, double value) -> Eigen::Vector3d {
    const auto column = static_cast<Eigen::Index>(place_in(robot.actuator(), source) - ErrorModel::kPosition);
    return 1e3 * model.G_ee.col(column) * value * paper_scale(robot, source);
  };
  const auto near = [](const Eigen::Vector3d& ours, const Eigen::Vector3d& published) {
    return (ours - published).cwiseAbs().maxCoeff() < 6e-4;
  };
  EXPECT_TRUE(near(tilt("rod_difference", 0.1), {0.413, -0.413, -0.482}));
  EXPECT_TRUE(near(tilt("alpha03", 1e-3), {0.354, -0.354, -0.413}));
  EXPECT_TRUE(near(tilt("alpha2", 1e-3), {0.390, -0.390, -0.455}));
  EXPECT_TRUE(near(tilt("beta03", 1e-3), {-0.214, 0.214, 0.250}));
  EXPECT_TRUE(near(tilt("beta2", 1e-3), {-0.139, 0.139, 0.162}));
}

}  // namespace
}  // namespace paracal::forward_test
