// Laws of the compensator that runs in a controller, on every robot of the catalogue and many machines.

#include "paracal/compensation/compensator.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <utility>

#include "paracal/calibration/prediction.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/compensation/path.hpp"
#include "paracal/compensation/target_correction.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::compensator_test {
namespace {

constexpr int kPosesPerMachine = 1000;

/// What is left between the commanded pose and the one that the machine takes, as far as joints could help.
struct Remainder {
  double position = 0.0;  ///< mm
  double slide = 0.0;     ///< mm
};

Remainder remainder_of(const Machine& machine, const Pose& pose, const PlateState& plate) {
  return {(plate.position - pose.position).norm(), std::abs(plate.slide - machine.slide_of(pose.rotation))};
}

class CompensatorLaw : public test::EveryRobot {
 protected:
  /// Machines in turn with the errors of [huang2016, Table 4], with some drawn from the tolerances, and without tilt.
  SourceErrors errors_of(int number) {
    if (number % 3 == 0) return test::table4_machine(robot, number);
    const SourceErrors errors = random.realistic_errors(robot);
    return number % 3 == 1 ? errors : without_tilt_group(errors);
  }

  /// Formulas that are wrong are so for any machine: of 12, four are of each kind.
  template <typename Task>
  void for_each_pose(Task&& task) {
    for (int number = 0; number < test::machines({.claim = 100, .quick = 12}); ++number) {
      const SourceErrors errors = errors_of(number);
      const Machine machine = build(robot, errors);
      const auto parameters = compensator_parameters(robot, errors);
      for (int k = 0; k < kPosesPerMachine; ++k) task(machine, parameters, errors, random.pose(robot));
    }
  }

  test::Random random;
};

TEST_P(CompensatorLaw, ExactLeavesNothing) {
  Remainder worst;
  double worst_tilt = 0.0;
  for_each_pose([&](const Machine& machine, const auto& parameters, const SourceErrors&, const Pose& pose) {
    CompensatorJoints<double> joints{};
    CompensatorTilt<double> tilt{};
    ASSERT_EQ(compensate(parameters, CompensationWay::exact, closure_pose(pose), joints, &tilt),
              CompensationStatus::ok);
    const ForwardResult actual = forward(machine, compensated_joints(robot, joints));
    ASSERT_TRUE(actual.ok());
    const Remainder remainder = remainder_of(machine, pose, actual.plate);
    worst.position = std::max(worst.position, remainder.position);
    worst.slide = std::max(worst.slide, remainder.slide);
    worst_tilt =
        std::max(worst_tilt, std::hypot(tilt.eps_x - actual.plate.tilt.x(), tilt.eps_y - actual.plate.tilt.y()));
  });
  RecordProperty("position_mm", fmt::format("{:.2g}", worst.position));
  EXPECT_LT(worst.position, 1e-6);
  EXPECT_LT(worst.slide, 1e-6);
  EXPECT_LT(worst_tilt, 1e-9);
}

TEST_P(CompensatorLaw, ExactIsTheInverseOfTheMachine) {
  double worst = 0.0;
  for_each_pose([&](const Machine& machine, const auto& parameters, const SourceErrors&, const Pose& pose) {
    CompensatorJoints<double> joints{};
    ASSERT_EQ(compensate(parameters, CompensationWay::exact, closure_pose(pose), joints), CompensationStatus::ok);
    const InverseResult expected = inverse(machine, pose);
    ASSERT_TRUE(expected.ok());
    worst = std::max(worst, (compensated_joints(robot, joints) - expected.joints).cwiseAbs().maxCoeff());
  });
  EXPECT_LE(worst, 1e-12 * test::joint_scale(robot));
}

/// After rough calibration, errors as in Table 4: the ways are worth what docs/controllers.md says.
TEST_P(CompensatorLaw, LinearWaysLeaveLittle) {
  double uncompensated = 0.0, linear = 0.0, tilt_aware = 0.0;
  for_each_pose([&](const Machine& machine, const auto& parameters, const SourceErrors&, const Pose& pose) {
    const auto left_by = [&](const auto& machine_parameters, CompensationWay way) {
      CompensatorJoints<double> joints{};
      EXPECT_EQ(compensate(machine_parameters, way, closure_pose(pose), joints), CompensationStatus::ok);
      return remainder_of(machine, pose, forward(machine, compensated_joints(robot, joints)).plate).position;
    };
    uncompensated = std::max(uncompensated, left_by(without_errors(parameters), CompensationWay::exact));
    linear = std::max(linear, left_by(parameters, CompensationWay::linear));
    tilt_aware = std::max(tilt_aware, left_by(parameters, CompensationWay::tilt_aware));
  });
  RecordProperty("uncompensated_mm", std::to_string(uncompensated));
  RecordProperty("linear_mm", std::to_string(linear));
  RecordProperty("tilt_aware_mm", std::to_string(tilt_aware));
  EXPECT_GT(uncompensated, 1.0);
  EXPECT_LT(linear, 0.3);
  EXPECT_LT(tilt_aware,
            0.03 * 950.0 / sizes_of(robot.limbs()).rod);  // of second order: errors of one size, over the robot's
}

/// To first order the tilt-aware way is exact: errors ten times smaller leave a hundredth.
TEST_P(CompensatorLaw, TheTiltAwareRemainderIsOfSecondOrder) {
  const SourceErrors full = errors_of(1);
  SourceErrors tenth;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : all_sources()) tenth(limb, source) = 0.1 * full(limb, source);
  }
  for (int k = 0; k < 100; ++k) {
    const Pose pose = random.pose(robot);
    const auto off = [&](const SourceErrors& errors) {
      const auto parameters = compensator_parameters(robot, errors);
      CompensatorJoints<double> exact{}, linear{};
      EXPECT_EQ(compensate(parameters, CompensationWay::exact, closure_pose(pose), exact), CompensationStatus::ok);
      EXPECT_EQ(compensate(parameters, CompensationWay::tilt_aware, closure_pose(pose), linear),
                CompensationStatus::ok);
      return (compensated_joints(robot, exact) - compensated_joints(robot, linear)).norm();
    };
    EXPECT_LT(off(tenth), 0.02 * off(full) + 1e-12);
  }
}

/// In float the constants alone are rounded by up to 6e-8 of their size: 0.03 um to 0.06 um in a metre.
TEST_P(CompensatorLaw, FloatIsGoodToMicrometres) {
  // A carriage's mm count as the angles by which they turn its rods.
  const double unit_size = joint_unit(robot.actuator()) == Unit::mm ? sizes_of(robot.limbs()).rod : 1.0;
  for (const CompensationWay way : {CompensationWay::exact, CompensationWay::tilt_aware, CompensationWay::linear}) {
    double worst = 0.0;
    for (int number = 0; number < 10; ++number) {
      const SourceErrors errors = errors_of(number);
      const auto fine = compensator_parameters(robot, errors);
      const auto coarse = compensator_parameters<float>(robot, errors);
      for (int k = 0; k < kPosesPerMachine; ++k) {
        const Pose pose = random.pose(robot);
        CompensatorJoints<double> expected{};
        CompensatorJoints<float> joints{};
        ASSERT_EQ(compensate(fine, way, closure_pose(pose), expected), CompensationStatus::ok);
        ASSERT_EQ(compensate(coarse, way, closure_pose<float>(pose), joints), CompensationStatus::ok);
        for (std::size_t i = 0; i < robot.limb_count(); ++i) {
          worst = std::max(worst, std::abs(static_cast<double>(joints[i]) - expected[i]) / unit_size);
        }
      }
    }
    RecordProperty(fmt::format("float_rad_{}", static_cast<int>(way)), fmt::format("{:.2g}", worst));
    EXPECT_LT(worst, 2e-6) << static_cast<int>(way);
  }
}

TEST_P(CompensatorLaw, WithoutErrorsEveryWayIsTheNominalInverse) {
  const auto parameters = without_errors(compensator_parameters(robot, errors_of(1)));
  for (int k = 0; k < 100; ++k) {
    const Pose pose = random.pose(robot);
    for (const CompensationWay way : {CompensationWay::exact, CompensationWay::tilt_aware, CompensationWay::linear}) {
      CompensatorJoints<double> joints{};
      CompensatorTilt<double> tilt{1.0, 1.0};
      ASSERT_EQ(Compensator(parameters, way).compensate(closure_pose(pose), joints, &tilt), CompensationStatus::ok);
      EXPECT_LE((compensated_joints(robot, joints) - inverse(robot.nominal(), pose).joints).cwiseAbs().maxCoeff(),
                1e-14);
      EXPECT_EQ(std::pair(tilt.eps_x, tilt.eps_y), std::pair(0.0, 0.0));
    }
  }
}

/// A closed controller turns the corrected target into the corrected joints.
TEST_P(CompensatorLaw, TheTargetsNominalInverseGivesTheJoints) {
  const auto parameters = compensator_parameters(robot, errors_of(1));
  for (int k = 0; k < 100; ++k) {
    CompensatorJoints<double> joints{};
    const Pose pose = random.pose(robot);
    ASSERT_EQ(compensate(parameters, CompensationWay::exact, closure_pose(pose), joints), CompensationStatus::ok);
    const Joints corrected = compensated_joints(robot, joints);
    const std::optional<Pose> target = corrected_target(robot, corrected, pose);
    ASSERT_TRUE(target);
    EXPECT_TRUE(robot.slide() || target->rotation == 0.0);
    EXPECT_LE((inverse(robot.nominal(), *target).joints - corrected).cwiseAbs().maxCoeff(), 1e-11);
  }
}

// ---- stated uncertainty

/// Some covariance of all errors, correlated between limbs and groups; standard deviations of a tenth of the
/// tolerances.
KnownErrors known_with_covariance(const Robot& robot, const SourceErrors& errors, test::Random& random) {
  KnownErrors known{errors, {}, {}};
  const Tolerances tolerances = tolerances_of(robot);
  std::vector<double> stds;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Source source : sources_of(robot.actuator())) {
      known.parameters.push_back({limb, source});
      stds.push_back(0.1 * tolerances.std(source));
    }
  }
  const auto n = static_cast<Eigen::Index>(stds.size());
  Eigen::MatrixXd root(n, n);
  for (Eigen::Index r = 0; r < n; ++r) {
    for (Eigen::Index c = 0; c < n; ++c) root(r, c) = stds[static_cast<std::size_t>(r)] * random.uniform(-1.0, 1.0);
  }
  known.covariance = root * root.transpose();
  return known;
}

/// The linear model at the nominal machine against the exact derivative at the identified one, of any machine.
TEST_P(CompensatorLaw, TheStatedUncertaintyIsThePredictions) {
  double worst = 0.0;
  for (int number = 0; number < test::machines({.claim = 20, .quick = 4}); ++number) {
    const KnownErrors known = known_with_covariance(robot, test::table4_machine(robot, number), random);
    const auto parameters = compensator_parameters(robot, known.errors);
    const auto covariance = compensator_covariance(robot, known.parameters, known.covariance);
    for (int k = 0; k < 20; ++k) {
      const CompensatorPose<double> pose = closure_pose(random.pose(robot));
      CompensatorJoints<double> joints{};
      CompensatorUncertainty<double> stated;
      ASSERT_EQ(compensate(parameters, CompensationWay::exact, pose, joints), CompensationStatus::ok);
      ASSERT_EQ(stated_uncertainty(parameters, covariance, pose, stated), CompensationStatus::ok);
      const Eigen::Matrix4d expected = predict(robot, known, compensated_joints(robot, joints)).covariance;
      const Eigen::Vector4d U = 2.0 * expected.diagonal().cwiseSqrt();
      const Eigen::Vector4d difference = Eigen::Vector4d(stated.x, stated.y, stated.z, stated.phi) - U;
      worst = std::max(worst, difference.head<3>().cwiseAbs().maxCoeff() / U.head<3>().maxCoeff());
      EXPECT_LE(std::abs(difference(3)), 0.03 * U(3));
    }
  }
  RecordProperty("share", fmt::format("{:.2g}", worst));
  EXPECT_LT(worst, 0.03);
  EXPECT_GT(worst, 0.0);
}

TEST_P(CompensatorLaw, WhereThereIsNoPoseThereIsNoUncertainty) {
  const auto parameters = compensator_parameters(robot, errors_of(1));
  const CompensatorCovariance<double> covariance{};
  CompensatorUncertainty<double> stated{1.0, 2.0, 3.0, 4.0};
  EXPECT_EQ(stated_uncertainty(parameters, covariance, {5000, 0, -5000, 0}, stated), CompensationStatus::unreachable);
  EXPECT_EQ(stated_uncertainty(parameters, covariance, {0, std::nan(""), -900, 0}, stated),
            CompensationStatus::not_finite);
  EXPECT_EQ(stated.x, 1.0);
}

// ---- what a controller must survive

constexpr CompensatorJoints<double> kLast{0.1, 0.2, 0.3, 0.4};

TEST_P(CompensatorLaw, ABadPoseLeavesTheLastJoints) {
  const auto parameters = compensator_parameters(robot, errors_of(1));
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const double phi = robot.slide() ? 0.1 : 0.0;
  const std::vector<std::pair<CompensatorPose<double>, CompensationStatus>> cases{
      {{nan, 0, -900, phi}, CompensationStatus::not_finite},
      {{0, 0, -900, nan}, CompensationStatus::not_finite},
      {{0, -infinity, -900, phi}, CompensationStatus::not_finite},
      {{5000, 0, -5000, phi}, CompensationStatus::unreachable},
      {{1e300, 0, -900, phi}, CompensationStatus::unreachable},
      {{3000, 0, -900, phi}, CompensationStatus::unreachable}};
  for (const CompensationWay way : {CompensationWay::exact, CompensationWay::tilt_aware, CompensationWay::linear}) {
    for (const auto& [pose, status] : cases) {
      CompensatorJoints<double> joints = kLast;
      CompensatorTilt<double> tilt{5.0, 6.0};
      EXPECT_EQ(compensate(parameters, way, pose, joints, &tilt), status) << pose.x << " " << pose.z;
      EXPECT_EQ(joints, kLast);
      EXPECT_EQ(tilt.eps_x, 5.0);
    }
  }
}

TEST_P(CompensatorLaw, ARigidPlateDoesNotTurn) {
  const auto parameters = compensator_parameters(robot, errors_of(1));
  const Eigen::Vector3d home = robot.workspace().centre();
  CompensatorJoints<double> joints = kLast;
  const CompensationStatus status =
      compensate(parameters, CompensationWay::exact, {home.x(), home.y(), home.z(), 0.1}, joints);
  EXPECT_EQ(status, robot.slide() ? CompensationStatus::ok : CompensationStatus::unreachable);
  EXPECT_EQ(joints == kLast, !robot.slide());
}

/// Lanes do as one call after the other does, bad poses among good ones included, whatever their number.
TEST_P(CompensatorLaw, APathIsItsPoses) {
  for (const std::size_t size : {0, 1, 7, 8, 9, 1003}) {
    for (int number = 0; number < 9; ++number) {
      const auto parameters = compensator_parameters(robot, errors_of(number));
      std::vector<CompensatorPose<double>> poses;
      for (std::size_t k = 0; k < size; ++k) {
        poses.push_back(closure_pose(random.pose(robot)));
        if (k % 11 == 3) poses.back().x = k % 2 == 0 ? -5000.0 : std::nan("");
        if (k % 13 == 4) poses.back().phi = 0.3;
      }
      std::vector<CompensatorJoints<double>> joints(size, kLast), expected(size, kLast);
      std::vector<CompensatorTilt<double>> tilts(size), expected_tilts(size);
      std::vector<CompensationStatus> statuses(size);
      compensate_path(parameters, poses, joints, statuses, tilts);
      for (std::size_t k = 0; k < size; ++k) {
        ASSERT_EQ(statuses[k],
                  compensate(parameters, CompensationWay::exact, poses[k], expected[k], &expected_tilts[k]));
        const double tolerance = (parameters.tilts_plate != 0 ? 1e-12 : 2e-15) * test::joint_scale(robot);
        for (std::size_t i = 0; i < kCompensatorLimbs; ++i) EXPECT_NEAR(joints[k][i], expected[k][i], tolerance);
        EXPECT_NEAR(tilts[k].eps_x, expected_tilts[k].eps_x, 1e-10);
        EXPECT_NEAR(tilts[k].eps_y, expected_tilts[k].eps_y, 1e-10);
      }
    }
  }
}

/// Far outside, where assembly modes meet, lanes find that of the nominal forward kinematics or none. Of 9000 poses
/// more than 1000 have one.
TEST_P(CompensatorLaw, TargetsInLanesAreOfTheRightAssemblyMode) {
  int compared = 0;
  for (int number = 0; number < 9; ++number) {
    const auto parameters = compensator_parameters(robot, errors_of(number));
    std::vector<CompensatorPose<double>> poses;
    for (int k = 0; k < test::machines({.claim = 20'000, .quick = 1000}); ++k) {
      poses.push_back(closure_pose(random.pose(robot)));
      poses.back().x *= random.uniform(0.0, 3.0);
      poses.back().y *= random.uniform(0.0, 3.0);
      poses.back().z *= random.uniform(0.0, 1.5);
    }
    std::vector<std::optional<CompensatorPose<double>>> targets(poses.size());
    nominal_targets(parameters, poses, targets);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      if (!targets[k]) continue;
      CompensatorJoints<double> joints{};
      // Where a joint stands at the height of the base, singly the iteration may stop where lanes settle.
      if (compensate(parameters, CompensationWay::exact, poses[k], joints) != CompensationStatus::ok) continue;
      ++compared;
      const auto expected = corrected_target(robot, compensated_joints(robot, joints),
                                             {{poses[k].x, poses[k].y, poses[k].z}, poses[k].phi});
      ASSERT_TRUE(expected) << k;
      const Eigen::Vector3d position(targets[k]->x, targets[k]->y, targets[k]->z);
      EXPECT_LT((position - expected->position).norm(), 1e-7);
    }
  }
  EXPECT_GT(compared, 1000);
}

/// In the workspace lanes find every target; wherever they find one it is that of the nominal forward kinematics.
TEST_P(CompensatorLaw, TargetsInLanesAreThoseOfTheNominalRobot) {
  std::mt19937_64 engine(5);
  for (int number = 0; number < 9; ++number) {
    const auto parameters = compensator_parameters(robot, errors_of(number));
    std::vector<CompensatorPose<double>> poses;
    for (int k = 0; k < 1003; ++k) {
      poses.push_back(closure_pose(random.pose(robot)));
      if (k % 11 == 3) poses.back().x = k % 2 == 0 ? -5000.0 : std::nan("");
      if (k % 13 == 4) poses.back().phi += 0.3;
      if (k % 5 == 2) poses.back().x *= 1.0 + 0.2 * static_cast<double>(engine() % 10);  // towards the singular
    }
    std::vector<std::optional<CompensatorPose<double>>> targets(poses.size());
    nominal_targets(parameters, poses, targets);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      CompensatorJoints<double> joints{};
      const bool reaches = compensate(parameters, CompensationWay::exact, poses[k], joints) == CompensationStatus::ok;
      const Pose wanted{{poses[k].x, poses[k].y, poses[k].z}, poses[k].phi};
      const auto expected = reaches ? corrected_target(robot, compensated_joints(robot, joints), wanted) : std::nullopt;
      if (k % 11 != 3 && k % 13 != 4 && k % 5 != 2) {
        ASSERT_TRUE(targets[k]) << k;
      }
      if (!targets[k]) continue;
      ASSERT_TRUE(expected) << k;
      const Eigen::Vector3d position(targets[k]->x, targets[k]->y, targets[k]->z);
      EXPECT_LT((position - expected->position).norm(), 1e-9);
      EXPECT_NEAR(targets[k]->phi, expected->rotation, 1e-9);
    }
  }
  std::vector<std::optional<CompensatorPose<double>>> one(1);
  EXPECT_THROW(nominal_targets(compensator_parameters(robot, {}), std::vector<CompensatorPose<double>>(2), one),
               std::invalid_argument);
}

/// Where rods lie nearly in one plane, or the target is far away, lanes leave the answer to the exact way.
TEST_P(CompensatorLaw, DoubtfulTargetsAreNotTakenFromLanes) {
  const auto sound = compensator_parameters(robot, errors_of(1));
  std::vector<CompensatorPose<double>> rising;
  for (double z = robot.workspace().centre().z(); z < 0.0; z += 0.1) rising.push_back({1.0, 2.0, z, 0.0});
  std::vector<std::optional<CompensatorPose<double>>> targets(rising.size());
  nominal_targets(sound, rising, targets);
  int held_back = 0;
  for (std::size_t k = 0; k < rising.size(); ++k) {
    CompensatorJoints<double> joints{};
    const bool reaches = compensate(sound, CompensationWay::exact, rising[k], joints) == CompensationStatus::ok;
    held_back += reaches && !targets[k] ? 1 : 0;
  }
  // Carriages rise with the plate, arms do not; twisted rods never lie in one plane.
  EXPECT_EQ(held_back > 0, robot.actuator() == Actuator::revolute && robot.name() != "levelled");

  SourceErrors far = errors_of(0);
  far(0, "theta_offset") += robot.actuator() == Actuator::linear ? 120.0 : 0.25;
  const Pose home{robot.workspace().centre(), 0.0};
  std::vector<std::optional<CompensatorPose<double>>> one(1);
  nominal_targets(compensator_parameters(robot, far), std::vector{closure_pose(home)}, one);
  EXPECT_FALSE(one.front());
  const TargetCorrection correction(robot, far);
  const std::optional<Joints> joints = correction.joints(home);
  ASSERT_TRUE(joints);
  const auto expected = corrected_target(robot, *joints, home);
  ASSERT_TRUE(expected && correction.target(home));
  EXPECT_EQ(correction.target(home)->position, expected->position);
  EXPECT_GT((expected->position - home.position).norm(), 50.0);
}

TEST_P(CompensatorLaw, APathWithoutRoomForItsJointsIsRefused) {
  const std::vector<CompensatorPose<double>> poses(2);
  std::vector<CompensatorJoints<double>> joints(1);
  std::vector<CompensationStatus> statuses(2);
  EXPECT_THROW(compensate_path(compensator_parameters(robot, {}), poses, joints, statuses), std::invalid_argument);
}

/// Any bits as a pose, and as parameters too.
template <typename Scalar, typename Bits>
void survive(const CompensatorParameters<Scalar>& good, int calls) {
  std::mt19937_64 engine(3);
  const auto any = [&] { return std::bit_cast<Scalar>(static_cast<Bits>(engine())); };
  const auto some = [&] { return engine() % 2 == 0 ? any() : static_cast<Scalar>(engine() % 2000) - Scalar(1000); };
  CompensatorParameters<Scalar> parameters = good;
  const auto covariance = std::make_unique<CompensatorCovariance<Scalar>>();
  for (auto& row : *covariance) {
    for (Scalar& one : row) one = some();
  }
  for (int call = 0; call < calls; ++call) {
    if (call % 8 == 0) parameters = good;
    parameters.identified[engine() % 4].arm = call % 3 == 0 ? any() : good.identified[0].arm;
    parameters.identified[engine() % 4].base[engine() % 3] = call % 5 == 0 ? any() : Scalar(100);
    const CompensatorPose<Scalar> pose{some(), some(), some(), parameters.limb_count == 4 ? some() : Scalar(0)};
    CompensatorJoints<Scalar> joints{};
    CompensatorTilt<Scalar> tilt{};
    const auto way = static_cast<CompensationWay>(engine() % 3);
    const CompensationStatus status = compensate(call % 2 == 0 ? good : parameters, way, pose, joints, &tilt);
    CompensatorUncertainty<Scalar> stated;
    if (stated_uncertainty(parameters, *covariance, pose, stated) == CompensationStatus::ok) {
      ASSERT_TRUE(std::isfinite(stated.x) && std::isfinite(stated.y) && std::isfinite(stated.z));
      ASSERT_TRUE(std::isfinite(stated.phi));
    }
    if (status != CompensationStatus::ok) continue;
    for (const Scalar joint : joints) ASSERT_TRUE(std::isfinite(joint));
    ASSERT_TRUE(std::isfinite(tilt.eps_x) && std::isfinite(tilt.eps_y));
  }
}

/// Every number is nonsense in one call of a few: 20,000 meet every pair of them.
TEST_P(CompensatorLaw, RandomBitsNeverGiveNonsenseAsGood) {
  const int calls = test::machines({.claim = 200'000, .quick = 20'000});
  survive<double, std::uint64_t>(compensator_parameters(robot, errors_of(1)), calls);
  survive<float, std::uint32_t>(compensator_parameters<float>(robot, errors_of(1)), calls);
}

/// Each number of an eighth of the poses is nonsense, of 2000 in every lane.
TEST_P(CompensatorLaw, RandomBitsInAPathAreJudgedAsAlone) {
  std::mt19937_64 engine(4);
  const auto parameters = compensator_parameters(robot, errors_of(1));
  std::vector<CompensatorPose<double>> poses(
      static_cast<std::size_t>(test::machines({.claim = 20'000, .quick = 2000})));
  for (CompensatorPose<double>& pose : poses) {
    pose = closure_pose(random.pose(robot));
    for (double* one : {&pose.x, &pose.y, &pose.z, &pose.phi}) {
      if (engine() % 8 == 0) *one = std::bit_cast<double>(engine());
    }
  }
  std::vector<CompensatorJoints<double>> joints(poses.size(), kLast);
  std::vector<CompensationStatus> statuses(poses.size());
  compensate_path(parameters, poses, joints, statuses);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    CompensatorJoints<double> expected = kLast;
    ASSERT_EQ(statuses[k], compensate(parameters, CompensationWay::exact, poses[k], expected));
    for (std::size_t i = 0; i < kCompensatorLimbs; ++i) ASSERT_NEAR(joints[k][i], expected[i], 1e-9);
  }
}

PARACAL_ON_EVERY_ROBOT(CompensatorLaw);
PARACAL_ON_UNUSUAL_ROBOTS(CompensatorLaw);

}  // namespace
}  // namespace paracal::compensator_test
