#include <gtest/gtest.h>

#include <Eigen/Core>
#include <unsupported/Eigen/AutoDiff>

#include "kinematics/linear_closure.hpp"
#include "numerics/dense.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/machine_impl.hpp"
#include "support/differences.hpp"
#include "support/robots.hpp"
#include "support/rod_residuals.hpp"

namespace paracal::derivatives_test {
namespace {

using test::Random;
/// Of a fixed size: Eigen adds no terms whose derivatives are of different sizes, as those of constants are.
constexpr int kMostDerivatives = static_cast<int>(kMostSources) * kMaxLimbs;
using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, kMostDerivatives, 1>>;

std::string plate_column(Eigen::Index column) { return "unknown " + std::to_string(column); }

class DerivativeLaw : public test::EveryRobot {
 protected:
  int unknowns() const { return !robot.is_level() ? 6 : static_cast<int>(robot.limb_count()) + 3; }
  int rods() const { return static_cast<int>(robot.limb_count()) * (!robot.is_level() ? 1 : 2); }
  int sources() const { return static_cast<int>(robot.parameters().size()); }
  int column(std::size_t limb, Source source) const {
    return static_cast<int>(robot.nominal().parameter(limb, source));
  }
  std::string named(Eigen::Index column) const {
    const Parameter& one = robot.parameters()[static_cast<std::size_t>(column)];
    return std::string(name(one.source)) + " of limb " + std::to_string(one.limb + 1);
  }
};

/// The kernels once more with numbers that carry their derivatives: d residual / d plate.
TEST_P(DerivativeLaw, ClosureJacobianAgainstAutomaticDerivatives) {
  Random random;
  for (int k = 0; k < 50; ++k) {
    const SourceErrors errors = random.errors(robot, 1.0, 0.01);
    const Machine machine = build(robot, errors);
    const Joints joints = inverse(robot.nominal(), random.pose(robot)).joints;
    PlateState plate;
    plate.position = robot.workspace().centre() + random.within(200.0);
    plate.tilt = random.within(0.3);
    if (robot.slide()) plate.slide = random.uniform(-30.0, 30.0);

    int next = 0;
    const auto variable = [&](double value) { return Dual(value, kMostDerivatives, next++); };
    const auto constant = [&](double value) { return Dual(value, Dual::DerType::Zero()); };
    BasicPlateState<Dual> dual_plate;
    for (int axis = 0; axis < 3; ++axis) dual_plate.position(axis) = variable(plate.position(axis));
    dual_plate.slide = robot.slide() ? variable(plate.slide) : constant(0.0);
    for (int axis = 0; axis < 3; ++axis) dual_plate.tilt(axis) = variable(plate.tilt(axis));
    BasicSourceErrors<Dual> dual_errors;
    std::array<Dual, kMaxLimbs> dual_joints;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : sources_of(robot.actuator()))
        dual_errors(limb, source) = constant(errors(limb, source));
      dual_joints[limb] = constant(joints(static_cast<Eigen::Index>(limb)));
    }
    const auto dual = test::rod_residuals(build(robot.description(), dual_errors), dual_plate, dual_joints);

    detail::with_limb_count(machine, [&]<int N>() {
      const auto linear = detail::linearize<N>(machine, plate, detail::ends_of<N>(machine, joints));
      Eigen::MatrixXd automatic(rods(), unknowns());
      for (int row = 0; row < rods(); ++row) {
        EXPECT_NEAR(linear.residual(row), dual(row).value(), 1e-11);
        automatic.row(row) = dual(row).derivatives().head(unknowns());
      }
      for (Eigen::Index k = 0; machine.has_guides && k < 6; ++k) {
        if (!machine.freedoms.free[static_cast<std::size_t>(k)]) automatic.col(k).setZero();
      }
      EXPECT_TRUE(test::jacobians_agree(linear.jacobian.topRows(rods()), automatic, 1e-13, plate_column));
    });
  }
}

/// d plate / d sources = -(J^T J)^-1 J^T J_p with J_p from automatic derivatives through build() and the closure.
TEST_P(DerivativeLaw, SourceJacobianAgainstAutomaticDerivatives) {
  Random random;
  for (int k = 0; k < 20; ++k) {
    const SourceErrors errors = random.errors(robot, 1.0, 0.01);
    const auto machine = differentiable(robot, errors);
    const Joints joints = inverse(robot.nominal(), random.pose(robot)).joints;
    const ForwardResult pose = forward(machine, joints);
    ASSERT_TRUE(pose.usable());

    const auto constant = [&](double value) { return Dual(value, Dual::DerType::Zero()); };
    BasicSourceErrors<Dual> dual_errors;
    std::array<Dual, kMaxLimbs> dual_joints;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : sources_of(robot.actuator())) {
        dual_errors(limb, source) = Dual(errors(limb, source), kMostDerivatives, column(limb, source));
      }
      dual_joints[limb] = constant(joints(static_cast<Eigen::Index>(limb)));
    }
    BasicPlateState<Dual> dual_plate;
    for (int axis = 0; axis < 3; ++axis) {
      dual_plate.position(axis) = constant(pose.plate.position(axis));
      dual_plate.tilt(axis) = constant(pose.plate.tilt(axis));
    }
    dual_plate.slide = constant(pose.plate.slide);
    const auto dual = test::rod_residuals(build(robot.description(), dual_errors), dual_plate, dual_joints);

    const ExactJacobian ours = exact_jacobian(machine, pose.plate, joints);
    ASSERT_TRUE(ours.ok);
    detail::with_limb_count(machine, [&]<int N>() {
      const auto linear = detail::linearize<N>(machine, pose.plate, detail::ends_of<N>(machine, joints));
      Eigen::MatrixXd by_source = Eigen::MatrixXd::Zero(linear.jacobian.rows(), sources());  // guides have none
      for (int row = 0; row < rods(); ++row) by_source.row(row) = dual(row).derivatives().head(sources());
      const Eigen::MatrixXd reference = -detail::shortest_solution(linear.jacobian, by_source);
      EXPECT_TRUE(test::jacobians_agree(ours.plate, reference, 1e-10, [&](Eigen::Index k) { return named(k); }));
    });
  }
}

/// The whole chain, errors -> machine -> exact pose, by differences.
TEST_P(DerivativeLaw, SourceJacobianAgainstDifferencesOfTheExactPose) {
  Random random;
  for (int k = 0; k < 10; ++k) {
    const SourceErrors errors = random.realistic_errors(robot);
    const Joints joints = inverse(robot.nominal(), random.pose(robot)).joints;
    Eigen::VectorXd at(sources()), step(sources());
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : sources_of(robot.actuator())) {
        at(column(limb, source)) = errors(limb, source);
        step(column(limb, source)) = unit(source, robot.actuator()) == Unit::rad ? 1e-4 : 1e-2;
      }
    }
    const auto plate_of = [&](const Eigen::VectorXd& values) -> Eigen::VectorXd {
      SourceErrors moved;
      for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
        for (const Source source : sources_of(robot.actuator())) moved(limb, source) = values(column(limb, source));
      }
      const ForwardResult pose = forward(build(robot, moved), joints);
      EXPECT_TRUE(pose.ok());
      Eigen::VectorXd state(unknowns());
      state.head<3>() = pose.plate.position;
      if (robot.slide()) state(3) = pose.plate.slide;
      state.tail<3>() = pose.plate.tilt;
      return state;
    };
    const auto machine = differentiable(robot, errors);
    const ExactJacobian ours = exact_jacobian(machine, forward(machine, joints).plate, joints);
    ASSERT_TRUE(ours.ok);
    const double tolerance = robot.limb_count() == 4 ? 1e-3 : 1e-6;  // the neglected curvature for 4 limbs
    const Eigen::MatrixXd differences = test::central_differences(plate_of, at, step);
    EXPECT_TRUE(test::jacobians_agree(ours.plate, differences, tolerance, [&](Eigen::Index k) { return named(k); }));
  }
}

PARACAL_ON_EVERY_ROBOT(DerivativeLaw);
PARACAL_ON_UNUSUAL_ROBOTS(DerivativeLaw);
PARACAL_ON_ROBOT_TEMPLATES(DerivativeLaw);

}  // namespace
}  // namespace paracal::derivatives_test
