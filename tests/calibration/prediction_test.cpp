// How known errors spread over poses, against the exact machine moved a little and what follows by hand.

#include "paracal/calibration/prediction.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "calibration/fit/largest_errors.hpp"
#include "numerics/distributions.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/base_motion.hpp"
#include "support/robots.hpp"

namespace paracal::prediction_test {
namespace {

class SpreadLaw : public test::EveryRobot {
 protected:
  Source fifth = sources_of(robot.actuator())[4];  // length of the arm, or gain of the rail
  /// x, y, z, phi of the exact machine.
  Eigen::Vector4d pose(const SourceErrors& errors, const Joints& joints) const {
    const Machine machine = build(robot, errors);
    const PlateState plate = forward(machine, joints).plate;
    return {plate.position.x(), plate.position.y(), plate.position.z(), machine.rotation_of(plate.slide)};
  }
  Eigen::Vector4d by_arm(const Joints& joints) const {
    constexpr double kStep = 1e-3;
    SourceErrors more, less;
    more(0, fifth) = kStep;
    less(0, fifth) = -kStep;
    return (pose(more, joints) - pose(less, joints)) / (2.0 * kStep);
  }
  Eigen::Matrix4Xd by_joints(const Joints& joints) const {
    const double step = 1e-6 * test::joint_scale(robot);
    Eigen::Matrix4Xd columns(4, joints.size());
    for (Eigen::Index k = 0; k < joints.size(); ++k) {
      Joints more = joints, less = joints;
      more(k) += step;
      less(k) -= step;
      columns.col(k) = (pose({}, more) - pose({}, less)) / (2.0 * step);
    }
    return columns;
  }
  Joints joints_at(std::size_t station) const { return believed_joints(robot, stations[station]); }

  /// Home and one pose: all that rigid motions leave of two points is their distance, half of it to each.
  std::vector<Station> stations{fine_stations(robot, 4)[0], fine_stations(robot, 4)[3]};
  Eigen::Vector3d direction = (stations[1].commanded.position - stations[0].commanded.position).normalized();
  KnownErrors arm{{}, {{0, fifth}}, Eigen::MatrixXd::Constant(1, 1, 0.04)};
  PoseSpread spread{robot, {}, arm.parameters, stations};
  /// Four limbs neglect curvature (exact_jacobian.hpp); rotations of some thousandths of a rad a mm.
  double exactly = 2e-3;
};

TEST_P(SpreadLaw, JacobianIsTheDerivativeOfThePose) {
  const Joints joints = joints_at(1);
  const Eigen::MatrixXd jacobian = pose_jacobian(differentiable(robot, {}), joints, arm.parameters);
  const Eigen::Vector4d expected = by_arm(joints);
  EXPECT_LT((jacobian.col(0).head<3>() - expected.head<3>()).norm(), exactly * expected.head<3>().norm());
  EXPECT_NEAR(jacobian(3, 0), expected(3), exactly * std::abs(expected(3)) + 1e-9);
}

TEST_P(SpreadLaw, OfTwoPosesByHand) {
  const Eigen::Vector4d change = by_arm(joints_at(1)) - by_arm(joints_at(0));
  const double distance = 0.2 * std::abs(direction.dot(change.head<3>())), rotation = 0.2 * std::abs(change(3));
  const std::vector<PoseStd> each = spread.each(arm.covariance);
  ASSERT_EQ(each.size(), 2u);
  EXPECT_NEAR(each[1].distance, distance, exactly * distance);
  for (const PoseStd& one : each) EXPECT_NEAR(one.aligned, 0.5 * distance, exactly * distance);
  EXPECT_NEAR(each[1].rotation, rotation, exactly * rotation + 1e-9);
  EXPECT_EQ(each[0].distance, 0.0);
  EXPECT_EQ(each[0].rotation, 0.0);

  const WorkspaceUncertainty all = spread.uncertainty(arm.covariance);
  EXPECT_NEAR(all.rms_distance, each[1].distance, 1e-12);  // of all poses but home
  EXPECT_NEAR(all.rms_aligned, 0.5 * distance, exactly * distance);
  const double lever = 70.0;
  EXPECT_NEAR((spread.mean_square(lever) * arm.covariance).trace(),
              0.25 * distance * distance + lever * lever * rotation * rotation,
              2.0 * exactly * (distance * distance + lever * lever * rotation * rotation));
}

/// Of one normal error 95 % are within 1.96 standard deviations; 1000 drawn machines know that to 3 % (one sigma).
TEST_P(SpreadLaw, UseOfOneErrorIsItsQuantile) {
  const std::vector<PoseStd> each = spread.each(arm.covariance);
  const Use use = spread.worst(arm).any;
  EXPECT_NEAR(use.distance.U, 1.96 * each[1].distance, 0.1 * each[1].distance * 1.96);
  EXPECT_NEAR(use.aligned.U, 1.96 * each[1].aligned, 0.1 * each[1].aligned * 1.96);
  if (robot.slide()) {
    EXPECT_NEAR(use.rotation->U, 1.96 * each[1].rotation, 0.1 * each[1].rotation * 1.96);
  }
}

/// Joints that stand elsewhere at each pose do so at home, too.
TEST_P(SpreadLaw, JointsOfBothPosesCount) {
  const double joint_std = 1e-3 * test::joint_scale(robot);
  const Eigen::Matrix4Xd here = by_joints(joints_at(1)), home = by_joints(joints_at(0));
  const Eigen::RowVector3d along = direction.transpose();
  const double distance =
      joint_std * std::hypot((along * here.topRows<3>()).norm(), (along * home.topRows<3>()).norm());
  const double rotation = joint_std * std::hypot(here.row(3).norm(), home.row(3).norm());
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(1, 1);
  const Eigen::VectorXd all_joints = Eigen::VectorXd::Constant(here.cols(), joint_std);
  const std::vector<PoseStd> each = spread.each(none, all_joints);
  EXPECT_NEAR(each[1].distance, distance, exactly * distance);
  EXPECT_NEAR(each[1].rotation, rotation, exactly * rotation + 1e-9);
  EXPECT_NEAR(each[0].aligned, joint_std * home.topRows<3>().norm(), exactly * each[0].aligned);
  EXPECT_NEAR(each[1].aligned, joint_std * here.topRows<3>().norm(), exactly * each[1].aligned);

  KnownErrors known = arm;
  known.covariance = none;
  known.joint_std = all_joints;
  const Use use = spread.worst(known).mean;
  EXPECT_NEAR(use.distance.U, 1.96 * distance, 0.1 * 1.96 * distance);
  EXPECT_GT(use.aligned.U, std::max(each[0].aligned, each[1].aligned));
  if (robot.slide()) {
    EXPECT_NEAR(use.rotation->U, 1.96 * rotation, 0.1 * 1.96 * rotation);
  }
}

/// A machine that is turned as a whole is right wherever an instrument looks from: nothing is left once it is aligned.
TEST_P(SpreadLaw, NothingIsLeftOfAMachineThatIsTurned) {
  std::vector<Station> around = fine_stations(robot, 5);
  for (Station& one : around) one.commanded.rotation = 0.0;  // a slide's axis is exact: no base turns it
  KnownErrors turned;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : sources_of(robot.actuator())) turned.parameters.push_back({limb, source});
  }
  const PoseSpread over{robot, {}, turned.parameters, around};
  const double lever = robot.workspace().radius;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kTurn = 1e-3;
    const SourceErrors errors = turned_base(robot, kTurn * Eigen::Vector3d::Unit(axis));
    Eigen::VectorXd values(std::ssize(turned.parameters));
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      const SoughtSource& one = turned.parameters[static_cast<std::size_t>(k)];
      values(k) = errors(one.limb, one.source);
    }
    for (const PoseStd& one : over.each(values * values.transpose())) {
      EXPECT_LT(one.aligned, 0.02 * kTurn * lever) << axis;
    }
  }
}

TEST_P(SpreadLaw, APlateThatDoesNotTurnHasNoRotationInUse) {
  EXPECT_EQ(use_over_workspace(robot, arm).any.rotation.has_value(), robot.slide().has_value());
}

PARACAL_ON_EVERY_ROBOT(SpreadLaw);
PARACAL_ON_UNUSUAL_ROBOTS(SpreadLaw);

/// Folding the knots of a spline and taking each pair of errors once is the same as G C G^T with a column for each: of
/// level plates with a slide and without, of guided ones and of hexapods, with knots in any order and some out of
/// reach.
TEST(PlateUncertaintyOf, ErrorsAndSplinesIsTheDiagonalOfTheWholeProduct) {
  for (const std::string_view name : {"huang2016", "linear_delta", "inclined_rails", "hexapod", "five-bar"}) {
    const Robot robot = test::robot_named(name);
    const DifferentiableMachine& machine = robot.nominal();
    const Pose pose = workspace_stations(robot)[5].commanded;
    const Joints joints = inverse(machine, pose).joints;
    std::vector<SoughtSource> parameters;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source& source : sources_of(robot.nominal().limbs[limb].actuator))
        parameters.push_back({limb, source});
    }
    for (std::size_t knot = 0; knot < 5 * robot.limb_count(); ++knot) {
      const std::size_t limb = knot % robot.limb_count();
      const double centre = joints(static_cast<Eigen::Index>(limb)) + 0.7 * (static_cast<double>(knot) / 5.0 - 1.5);
      parameters.push_back({limb, joint_zero(machine.limbs[limb].actuator), {}, SplineKnot{centre, 0.6}});
    }
    const auto n = static_cast<Eigen::Index>(parameters.size());
    test::Random random(7);
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.uniform(-0.1, 0.1); });
    const Eigen::MatrixXd covariance = root * root.transpose();
    const PlateState plate = plate_at(machine, pose);
    const PlateMotions motions = plate_jacobian(machine, plate, joints, parameters);
    const Eigen::VectorXd all = 2.0 * (motions * covariance * motions.transpose()).diagonal().cwiseSqrt();
    Eigen::VectorXd expected = all.head<4>();
    if (machine.commands_tilt()) {
      expected.resize(6);
      expected << all.head<3>(), all.tail<3>();
    }
    const auto found = PlateUncertainty(machine, parameters, covariance).at(plate, joints);
    ASSERT_TRUE(found) << name;
    EXPECT_LT((*found - expected).norm(), 1e-12 * expected.norm()) << name;
    EXPECT_FALSE(PlateUncertainty(machine, parameters, {}).at(plate, joints)) << name;
  }
}

/// Ten degrees of freedom: k = 2.284 of the noise's part alone [gum, Table G.2, 95.45 %].
TEST(KnownErrorsByHand, StudentWidensTheNoisesPartAlone) {
  const Eigen::MatrixXd all = Eigen::Vector2d(4.0, 9.0).asDiagonal(), noise = Eigen::Vector2d(1.0, 0.0).asDiagonal();
  KnownErrors known{{}, {{0, "theta_offset"}, {1, "arm_length"}}, all, noise};
  known.noise_dof = 10.0;
  known.joint_std = Eigen::Vector2d(0.3, 0.0);
  known.visit_std = Eigen::Vector2d(0.4, 0.2);
  const double widened = 3.0 + std::pow(2.284 / 2.0, 2);
  EXPECT_NEAR(known.expanded_covariance()(0, 0), widened, 2e-3);
  EXPECT_EQ(known.expanded_covariance()(1, 1), 9.0);
  EXPECT_NEAR(known.joint_std_of_a_visit()(0), 0.5, 1e-12);
  EXPECT_NEAR(known.joint_std_of_a_visit()(1), 0.2, 1e-12);
  // At one visit a joint that stands elsewhere is one whose zero lies elsewhere.
  EXPECT_NEAR(known.pose_covariance()(0, 0), widened + 0.25, 2e-3);
  EXPECT_EQ(known.pose_covariance()(1, 1), 9.0);
}

constexpr double kDrawn = 0.04;  // of a quantile that 1000 machines tell

/// Poses that depend on a number of their own, each of a machine, with this standard deviation.
detail::PoseQuantity independent(Eigen::Index coordinates, const Eigen::VectorXd& std) {
  const Eigen::Index rows = coordinates * std.size();
  detail::PoseQuantity quantity{coordinates, Eigen::MatrixXd::Zero(rows, rows), Eigen::MatrixXd::Zero(rows, 1), {}};
  for (Eigen::Index row = 0; row < rows; ++row) quantity.by_errors(row, row) = std(row / coordinates);
  return quantity;
}

double largest(const detail::PoseQuantity& quantity, const Eigen::VectorXd& joint_std = {}) {
  return detail::DrawnMachines(quantity.by_errors.cols(), quantity.by_joints.cols()).largest(quantity, {joint_std})[0];
}

/// |z| that one of so many does not exceed with 95 %.
double of_many(double count) { return detail::normal_quantile(0.5 * (1.0 + std::pow(0.95, 1.0 / count))); }

/// All that are as uncertain as the first count: also those behind the poses that are drawn together.
TEST(LargestErrors, OfManyEqualPoses) {
  EXPECT_NEAR(largest(independent(1, Eigen::VectorXd::Constant(60, 0.5))), 0.5 * of_many(60.0),
              kDrawn * 0.5 * of_many(60.0));
}

TEST(LargestErrors, OfOnePoseAmongManySmallOnes) {
  Eigen::VectorXd std = Eigen::VectorXd::Constant(60, 0.2);
  std(41) = 1.0;
  EXPECT_NEAR(largest(independent(1, std)), 1.96, kDrawn * 1.96);
}

TEST(LargestErrors, OfThreeCoordinatesIsTheirLength) {
  const double length = std::sqrt(detail::chi_square_quantile(1.0 - std::pow(0.95, 1.0 / 40.0), 3.0));
  EXPECT_NEAR(largest(independent(3, Eigen::VectorXd::Constant(40, 0.3))), 0.3 * length, kDrawn * 0.3 * length);
}

/// Joints are off anew at each pose, and at home.
TEST(LargestErrors, OfJointsAtEachPoseAndAtHome) {
  detail::PoseQuantity quantity = independent(1, Eigen::VectorXd::Zero(60));
  quantity.by_joints.setConstant(2.0);
  EXPECT_NEAR(largest(quantity, Eigen::VectorXd::Constant(1, 0.5)), of_many(60.0), kDrawn * of_many(60.0));
  quantity.by_joints.setZero();
  quantity.by_home = Eigen::MatrixXd::Constant(60, 1, 2.0);
  EXPECT_NEAR(largest(quantity, Eigen::VectorXd::Constant(1, 0.5)), 1.96, kDrawn * 1.96);
}

/// The same machines for every size of joints: what joints add makes no machine better.
TEST(LargestErrors, OfSeveralSizesOfJointsAreOfTheSameMachines) {
  detail::PoseQuantity quantity = independent(1, Eigen::VectorXd::Constant(60, 0.5));
  quantity.by_joints.setConstant(1e-9);
  const auto both = detail::DrawnMachines(60, 1).largest(
      quantity, {Eigen::VectorXd::Constant(1, 1.0), Eigen::VectorXd::Constant(1, 2.0)});
  EXPECT_NEAR(both[0], both[1], 1e-7);
}

}  // namespace
}  // namespace paracal::prediction_test
