#include "paracal/batch/production.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "paracal/calibration/identification.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "support/robots.hpp"

namespace paracal::production_test {
namespace {

constexpr std::uint64_t kSeed = 7;

class Production : public test::EveryRobot {
 protected:
  ProductionPlan paper() const { return settled(robot, paper_production(robot, tolerances_of(robot))); }
  MachineOutcome make(const ProductionPlan& plan, std::uint64_t machine) const {
    return produce(robot, plan, kSeed, machine);
  }
};

PARACAL_ON_EVERY_ROBOT(Production);

class Making : public Production {};
PARACAL_ON_EVERY_ROBOT(Making);
PARACAL_ON_ROBOT_TEMPLATES(Making);

Tolerances without_tilt(Tolerances tolerances) {
  for (const Source source : all_sources()) {
    if (tilts_plate(source)) tolerances[source] = 0.0;
  }
  return tolerances;
}

TEST_P(Making, NoErrorsStayNone) {
  ProductionPlan plan = paper();
  plan.tolerances = {};
  plan.instrument.noise = 0.0;
  const MachineOutcome outcome = make(plan, 0);
  EXPECT_NE(outcome.fate, Fate::does_not_close);
  for (const ErrorKind kind : kErrorKinds) {
    EXPECT_NEAR(outcome.before[kind], 0.0, 1e-8) << name(kind);
    EXPECT_NEAR(outcome.after[kind], 0.0, 1e-5) << name(kind);
  }
}

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& tilt) {
  const auto about = [&](int axis) { return Eigen::AngleAxisd(tilt(axis), Eigen::Vector3d::Unit(axis)); };
  return (about(0) * about(1) * about(2)).toRotationMatrix();
}

/// The same definitions, written down once more: no guesses, no shared pose errors, Umeyama's alignment.
Accuracy accuracy_from_scratch(const Robot& robot, const SourceErrors& errors, const SourceErrors& believed,
                               const std::vector<Station>& stations) {
  const Machine actual = build(robot, errors), controller = build(robot, believed);
  const auto count = static_cast<Eigen::Index>(stations.size());
  Eigen::Matrix3Xd meant(3, count), taken(3, count);
  Eigen::VectorXd turned(count);
  Eigen::Matrix3d home;
  double since_home = 0.0;
  Accuracy accuracy;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Pose& pose = stations[static_cast<std::size_t>(k)].commanded;
    const PlateState plate = forward(actual, inverse(controller, pose).joints).plate;
    meant.col(k) = pose.position;
    taken.col(k) = plate.position;
    turned(k) = actual.rotation_of(plate.slide) - pose.rotation;
    const Eigen::Matrix3d meant_turn = rotation_of(pose.tilt), taken_turn = rotation_of(plate.tilt);
    if (k == 0) home = taken_turn * meant_turn.transpose();  // which is commanded level
    const Eigen::AngleAxisd away(taken_turn * meant_turn.transpose());
    const Eigen::Vector3d tilt = !robot.is_level() ? away.angle() * away.axis() : plate.tilt;
    accuracy[ErrorKind::tilt] = std::max(accuracy[ErrorKind::tilt], std::hypot(tilt.x(), tilt.y()));
    since_home =
        std::max(since_home, Eigen::AngleAxisd(meant_turn.transpose() * home.transpose() * taken_turn).angle());
  }
  const Eigen::Matrix3Xd commanded_way = meant.colwise() - meant.col(0), way = taken.colwise() - taken.col(0);
  const Eigen::Matrix4d motion = Eigen::umeyama(taken, meant, false);
  const Eigen::Matrix3Xd aligned = (motion.topLeftCorner<3, 3>() * taken).colwise() + motion.topRightCorner<3, 1>();
  accuracy[ErrorKind::distance] = (way.colwise().norm() - commanded_way.colwise().norm()).cwiseAbs().maxCoeff();
  accuracy[ErrorKind::volumetric] = (way - commanded_way).colwise().norm().maxCoeff();
  accuracy[ErrorKind::volumetric_aligned] = (aligned - meant).colwise().norm().maxCoeff();
  accuracy[ErrorKind::rotation] = !robot.is_level() ? since_home : (turned.array() - turned(0)).abs().maxCoeff();
  return accuracy;
}

TEST_P(Making, IsWhatItSays) {
  const ProductionPlan plan = paper();
  for (std::uint64_t machine = 0; machine < 3; ++machine) {
    const MachineOutcome outcome = make(plan, machine);
    RandomStream random(kSeed, machine);
    const SourceErrors errors = draw_errors(robot, plan.tolerances, random);
    const Measurements readings = simulate(robot, errors, plan.stations, plan.instrument, random);
    const Calibration calibration = calibrate(robot, readings, plan.calibration);
    ASSERT_TRUE(calibration.accepted());
    EXPECT_EQ(outcome.fate, Fate::accepted);
    EXPECT_TRUE(outcome.passes);
    const Accuracy before = accuracy_from_scratch(robot, errors, {}, plan.validation),
                   after = accuracy_from_scratch(robot, errors, calibration.errors(), plan.validation);
    for (const ErrorKind kind : kErrorKinds) {
      EXPECT_NEAR(outcome.before[kind], before[kind], 1e-8) << name(kind);
      EXPECT_NEAR(outcome.after[kind], after[kind], 1e-8) << name(kind);
    }
  }
}

TEST_P(Making, AMachineDoesNotDependOnOthers) {
  const ProductionPlan plan = paper();
  const MachineOutcome alone = make(plan, 5);
  (void)make(plan, 4);
  EXPECT_EQ(make(plan, 5), alone);
  EXPECT_NE(make(plan, 6), alone);
  EXPECT_NE(produce(robot, plan, kSeed + 1, 5), alone);
}

/// What compensation can remove is removed when it is measured without noise.
TEST_P(Production, PositionErrorsVanish) {
  ProductionPlan plan = paper();
  plan.tolerances = without_tilt(plan.tolerances);
  plan.calibration.tolerances = plan.tolerances;
  plan.instrument.noise = 0.0;
  const MachineOutcome outcome = make(plan, 1);
  EXPECT_EQ(outcome.fate, Fate::accepted);
  EXPECT_GT(outcome.before[ErrorKind::volumetric_aligned], 1.0);
  EXPECT_LT(outcome.after[ErrorKind::volumetric_aligned], 1e-3);
  EXPECT_LT(outcome.after[ErrorKind::distance], 1e-3);
  EXPECT_NEAR(outcome.before[ErrorKind::tilt], 0.0, 1e-9);
  EXPECT_NEAR(outcome.after[ErrorKind::tilt], 0.0, 1e-9);
}

/// Only tight parts limit the tilt: a controller that moves the plate by millimetres changes it by their product with
/// the errors.
TEST_P(Production, CompensationLeavesTheTilt) {
  const ProductionPlan plan = paper();
  for (std::uint64_t machine = 0; machine < 5; ++machine) {
    const MachineOutcome outcome = make(plan, machine);
    EXPECT_GT(outcome.before[ErrorKind::tilt], 1e-5);
    EXPECT_NEAR(outcome.after[ErrorKind::tilt] / outcome.before[ErrorKind::tilt], 1.0, 0.05);
    EXPECT_LT(outcome.after[ErrorKind::volumetric_aligned], 0.2 * outcome.before[ErrorKind::volumetric_aligned]);
  }
}

TEST_P(Production, ARejectedCalibrationIsNotUsed) {
  ProductionPlan plan = paper();
  plan.instrument.noise = 300.0;
  const MachineOutcome outcome = make(plan, 2);
  EXPECT_NE(outcome.fate, Fate::accepted);
  EXPECT_NE(outcome.fate, Fate::does_not_close);
  EXPECT_FALSE(outcome.passes);
  EXPECT_EQ(outcome.after, outcome.before);
  plan.limits[ErrorKind::distance] = 1e3;
  EXPECT_TRUE(make(plan, 2).passes) << "a machine that keeps the limits uncalibrated is a good machine";
}

TEST_P(Making, EveryLimitCounts) {
  ProductionPlan plan = paper();
  const MachineOutcome outcome = make(plan, 3);
  for (const ErrorKind kind : kErrorKinds) {
    if (kind == ErrorKind::rotation && !turns(robot)) continue;
    if (kind == ErrorKind::tilt && outcome.after[kind] == 0.0) continue;  // guides keep it from that
    plan.limits = {};
    plan.limits[kind] = outcome.after[kind];
    EXPECT_TRUE(make(plan, 3).passes) << name(kind);
    plan.limits[kind] = 0.999 * outcome.after[kind];
    EXPECT_FALSE(make(plan, 3).passes) << name(kind);
  }
}

/// Parts so bad that machines do not close, calibrations do not converge and numbers leave their range.
TEST_P(Production, StrangeDrawsAreFates) {
  ProductionPlan plan = paper();
  int scrap = 0;
  for (const double worse : {30.0, 300.0, 1e200}) {
    for (const Source source : all_sources()) plan.tolerances[source] = worse * tolerances_of(robot)[source];
    for (std::uint64_t machine = 0; machine < 5; ++machine) {
      MachineOutcome outcome;
      EXPECT_NO_THROW(outcome = make(plan, machine));
      if (outcome.fate != Fate::does_not_close) continue;
      ++scrap;
      EXPECT_EQ(outcome, MachineOutcome());
    }
  }
  EXPECT_GE(scrap, 5);
}

TEST_P(Production, ThePlanIsCheckedOnce) {
  EXPECT_EQ(paper().calibration.stage, Stage::fine);
  ProductionPlan few = paper_production(robot, tolerances_of(robot));
  few.stations.resize(robot.limb_count() + 1);
  EXPECT_EQ(settled(robot, few).calibration.stage, Stage::rough);
  ProductionPlan far = paper();
  far.validation.back().commanded.position.x() = 5000.0;
  EXPECT_THROW((void)settled(robot, far), Unreachable);
  far = paper();
  far.stations.back().commanded.position.x() = 5000.0;
  EXPECT_THROW((void)settled(robot, far), Unreachable);
  far.stations.clear();
  EXPECT_THROW((void)settled(robot, far), InvalidArgument);
  EXPECT_THROW((void)settled(robot, paper_production(robot, {})), InvalidArgument) << "nothing to seek";
}

}  // namespace
}  // namespace paracal::production_test
