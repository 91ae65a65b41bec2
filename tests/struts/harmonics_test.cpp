// What repeats with each turn of a screw or an encoder, on robots of every kind of limb: closure, derivatives, files,
// fits.

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "paracal/calibration/calibration.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/compensation/compensator.hpp"
#include "paracal/compensation/export.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/compensation/target_correction.hpp"
#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/tolerance/characteristic.hpp"
#include "paracal/tolerance/drawn_feature.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::harmonics_test {
namespace {

constexpr double kAmplitude = 0.02;  // mm

/// 5 mm a turn of a screw, 10 deg of one of an encoder.
double pitch_of(const Robot& robot) { return joint_unit(robot.actuator()) == Unit::mm ? 5.0 : to_radians(10.0); }

/// @param alone  the second limb has them, no other.
Robot with_harmonics(const Robot& even, bool alone = false) {
  RobotDescription description = even.description();
  for (std::size_t i = 0; i < even.limb_count(); ++i) {
    if (i == 1 || !alone) description.limbs[i] = with_pitch(description.limbs[i], pitch_of(even));
  }
  if (description.tolerances) {
    for (const Source source : {Source("turn_sine"), Source("turn_cosine")}) {
      description.tolerances->state(source, generous_tolerances(description.limbs)[source]);
    }
  }
  return Robot(std::move(description));
}

class HarmonicLaw : public test::EveryRobot {
 protected:
  Robot turning = with_harmonics(robot);
  SourceErrors errors = [this] {
    RandomStream random(7);
    return draw_errors(turning, tolerances_of(turning), random);
  }();
  DifferentiableMachine machine = differentiable(turning, errors);
  std::vector<Pose> poses = [this] {
    std::vector<Pose> all;
    for (const Station& station : candidate_stations(turning, 100, 3)) all.push_back(station.commanded);
    return all;
  }();
};

TEST_P(HarmonicLaw, JointsLeadBackToTheirPose) {
  int reached = 0;
  for (const Pose& pose : poses) {
    const InverseResult joints = inverse(machine, pose);
    if (!joints.ok()) continue;
    ++reached;
    const ForwardResult found = forward(machine, joints.joints, {.start = plate_at(machine, pose)});
    ASSERT_TRUE(found.usable());
    EXPECT_LT((found.plate.position - pose.position).norm(), 1e-9);
  }
  EXPECT_GT(reached, 90);
}

/// By the definition: where the joints of the even machine are is where those with harmonics are commanded, plus them.
TEST_P(HarmonicLaw, AreAddedToTheJoints) {
  SourceErrors none = errors;
  for (std::size_t i = 0; i < turning.limb_count(); ++i) none(i, "turn_sine") = none(i, "turn_cosine") = 0.0;
  const Machine even = build(turning, none);
  double largest = 0.0;
  for (const Pose& pose : poses) {
    const InverseResult joints = inverse(machine, pose), actual = inverse(even, pose);
    if (!joints.ok() || !actual.ok() || turning.nominal().spare_limbs() > 0) continue;
    for (std::size_t i = 0; i < turning.limb_count(); ++i) {
      const double q = joints.joints(static_cast<Eigen::Index>(i));
      const double turn = 2.0 * std::numbers::pi * q / pitch_of(robot);
      const double off = errors(i, "turn_sine") * std::sin(turn) + errors(i, "turn_cosine") * std::cos(turn);
      EXPECT_NEAR(q + off, actual.joints(static_cast<Eigen::Index>(i)), 1e-9);
      largest = std::max(largest, std::abs(off));
    }
  }
  if (turning.nominal().spare_limbs() == 0) {
    EXPECT_GT(largest, 0.1 * tolerances_of(turning)["turn_sine"]);
  }
}

TEST_P(HarmonicLaw, DerivativesAreDifferences) {
  for (const Pose& pose : {poses[0], poses[5], poses[9]}) {
    const InverseResult joints = inverse(machine, pose);
    if (!joints.ok()) continue;
    const PlateState start = plate_at(machine, pose);
    const PlateState plate = forward(machine, joints.joints, {.start = start}).plate;
    const ExactJacobian exact = exact_jacobian(machine, plate, joints.joints);
    ASSERT_TRUE(exact.ok);
    for (const Source source : {Source("turn_sine"), Source("turn_cosine"), joint_zero(turning.actuator())}) {
      const auto moved = [&](double by) {
        SourceErrors other = errors;
        other(1, source) += by;
        return forward(build(turning, other), joints.joints, {.start = plate}).plate.position;
      };
      const double step = 1e-4 / test::joint_scale(robot) * (joint_unit(robot.actuator()) == Unit::mm ? 100.0 : 1.0);
      const Eigen::Vector3d expected = (moved(step) - moved(-step)) / (2.0 * step);
      const auto column = static_cast<Eigen::Index>(machine.parameter(1, source));
      EXPECT_LT((exact.plate.col(column).head<3>() - expected).norm(), 2e-3 * expected.norm() + 1e-6) << name(source);
    }
  }
}

TEST_P(HarmonicLaw, FilesKeepThem) {
  const io::Json json = io::to_json(turning);
  EXPECT_NE(json.dump().find("\"pitch_"), std::string::npos);
  const Robot again = io::read_robot({"again.toml", io::robot_toml(turning)});
  EXPECT_EQ(io::to_json(again), json);
  EXPECT_EQ(again.parameters().size(), turning.parameters().size());
  EXPECT_EQ(again.parameters().size(), robot.parameters().size() + 2 * robot.limb_count());
}

/// All columns of the linear model by their derivatives.
void hold_linear_model(const Robot& turning, const std::vector<Pose>& poses) {
  const Machine nominal = turning.nominal();
  const LinearModel model(turning);
  for (const Pose& pose : poses) {
    const SourceRows rows = model.rows(pose, {Quantity::position});
    const Joints joints = inverse(nominal, pose).joints;
    for (const Parameter& one : turning.parameters()) {
      const double step = 1e-5;
      const auto moved = [&](double by) {
        SourceErrors other;
        other(one.limb, one.source) = by;
        return forward(build(turning, other), joints, {.start = plate_at(nominal, pose)}).plate.position;
      };
      const Eigen::Vector3d expected = (moved(step) - moved(-step)) / (2.0 * step);
      const auto column = static_cast<Eigen::Index>(nominal.parameter(one.limb, one.source));
      EXPECT_LT((rows.col(column).head<3>() - expected).norm(), 2e-3 * expected.norm() + 1e-4)
          << name(one.source) << " of limb " << one.limb + 1;
    }
  }
}

TEST_P(HarmonicLaw, LinearModelIsTheDerivative) {
  hold_linear_model(turning, {poses[2], poses[7]});
  hold_linear_model(with_harmonics(robot, true), {poses[4]});
}

/// What a drawing shows of the other errors does not change.
TEST_P(HarmonicLaw, DrawingsAreTheSame) {
  for (const Source source : sources_of(robot.limbs())) {
    EXPECT_EQ(drawn_feature(source, turning.limbs()).kind, drawn_feature(source, robot.limbs()).kind) << name(source);
  }
}

TEST_P(HarmonicLaw, TargetsAndTheCompensatorHoldThem) {
  if (!has_compensator(turning)) return;
  const CompensatorParameters<double> parameters = compensator_parameters(turning, errors);
  const TargetCorrection correction(turning, errors);
  for (const Pose& pose : {poses[1], poses[3], poses[8]}) {
    const InverseResult exact = inverse(machine, pose);
    if (!exact.ok()) continue;
    CompensatorJoints<double> joints{};
    ASSERT_EQ(compensate(parameters, CompensationWay::exact, closure_pose(pose), joints), CompensationStatus::ok);
    EXPECT_LT((compensated_joints(turning, joints) - exact.joints).cwiseAbs().maxCoeff(), 1e-9);
    const std::optional<Pose> target = correction.target(pose);
    if (!target) continue;
    const InverseResult controller = inverse(turning.nominal(), *target);
    EXPECT_LT((controller.joints - exact.joints).cwiseAbs().maxCoeff(), 1e-9);
  }
}

PARACAL_ON_EVERY_ROBOT(HarmonicLaw);
PARACAL_ON_ROBOT_TEMPLATES(HarmonicLaw);

TEST(Harmonics, GenhexkinsRefusesThemAlone) {
  const Robot robot = with_harmonics(test::robot_named("hexapod"));
  EXPECT_NO_THROW((void)genhexkins(robot, {}, {}));
  SourceErrors errors;
  errors(4, "turn_cosine") = kAmplitude;
  EXPECT_THAT([&] { (void)genhexkins(robot, errors, {}); },
              testing::ThrowsMessage<InvalidArgument>(testing::HasSubstr("turn_cosine of limb 5")));
}

/// It has no place for them: U without them would be too small.
TEST(Harmonics, TheCompensatorsCovarianceRefusesThem) {
  const Robot robot = with_harmonics(test::robot_named("linear_delta"));
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(2, 2);
  const std::vector<SoughtSource> even{{0, "rod_mean"}, {1, "rod_mean"}}, uneven{{0, "rod_mean"}, {1, "turn_sine"}};
  EXPECT_NO_THROW((void)compensator_covariance(robot, even, covariance));
  EXPECT_THAT([&] { (void)compensator_covariance(robot, uneven, covariance); },
              testing::ThrowsMessage<InvalidArgument>(testing::HasSubstr("turn_sine: expected a calibration without")));
}

TEST(Harmonics, SteepOnesAndPitchesOfNothingAreRefused) {
  const Robot robot = with_harmonics(test::robot_named("hexapod"));
  SourceErrors errors;
  errors(2, "turn_sine") = 0.15;  // of 5 mm: 0.19 mm a mm
  EXPECT_FALSE(implausible(robot, errors));
  errors(2, "turn_sine") = 0.17;
  ASSERT_TRUE(implausible(robot, errors));
  EXPECT_THAT(*implausible(robot, errors), testing::HasSubstr("turn_sine of limb 3"));
  RobotDescription description = robot.description();
  description.limbs[1].pitch = 0.0;
  EXPECT_THROW((void)Robot(description), InvalidArgument);
  description.limbs[1].pitch = -5.0;
  EXPECT_THROW((void)Robot(description), InvalidArgument);
}

/// Where they stand in the file; 0 is not "none".
TEST(Harmonics, PitchesThatNoScrewHasAreRefusedWithTheirLine) {
  const std::string good = io::robot_toml(with_harmonics(test::robot_named("hexapod"))), key = "pitch_mm = ";
  const std::size_t at = good.find(key) + key.size();
  ASSERT_NE(good.find(key), std::string::npos);
  for (const char* pitch : {"0", "-5", "1e9", "1e-6"}) {
    std::string text = good;
    text.replace(at, good.find('\n', at) - at, pitch);
    EXPECT_THAT(
        [&] {
          (void)io::read_robot({"r.toml", text});
        },
        testing::ThrowsMessage<Error>(testing::AllOf(testing::ContainsRegex("r.toml:[0-9]+: "),
                                                     testing::HasSubstr("pitch_mm from 0.001 to 100000"))))
        << pitch;
  }
}

/// Machines whose screws wobble by 0.02 mm, fitted with and without harmonics.
struct Fits {
  int values = 0, held = 0;
  double with = 0.0, without = 0.0;  ///< mm, of poses that were not measured, root mean square
};

double left(const Robot& robot, const Calibration& found, const Robot& turning, const SourceErrors& errors) {
  const Machine actual = build(turning, errors);
  double squares = 0.0;
  const std::vector<Station> others = candidate_stations(turning, 40, 91);
  std::vector<PosePair> pairs;
  for (const Station& station : others) {
    const Joints joints = believed_joints(turning, station);
    const Pose is = pose_of(actual, forward(actual, joints, {.start = plate_at(actual, station.commanded)}).plate);
    pairs.push_back({predict(robot, known_errors(found), joints).pose, is});
    squares += std::pow(error_relative_to(pairs.front(), pairs.back()).distance, 2);
  }
  return squares / static_cast<double>(others.size());
}

Fits fits_of(const Robot& even, int machines) {
  const Robot turning = with_harmonics(even);
  const std::vector<Station> stations = candidate_stations(turning, 60, 5);
  Fits all;
  for (int number = 0; number < machines; ++number) {
    RandomStream random(11, static_cast<std::uint64_t>(number));
    SourceErrors errors = draw_errors(turning, tolerances_of(turning), random);
    for (std::size_t i = 0; i < turning.limb_count(); ++i) {
      const double phase = 2.0 * std::numbers::pi * random.uniform();
      errors(i, "turn_sine") = kAmplitude * std::cos(phase);
      errors(i, "turn_cosine") = kAmplitude * std::sin(phase);
    }
    const Measurements read = test::measure(turning, errors, stations, number, {.noise = 0.005, .repeats = 3});
    CalibrationOptions options;
    options.states_use = false;
    options.seeks_discrepancies = false;  // whose intervals also hold joints that do not repeat; these do
    const Calibration with = calibrate(turning, read, options), without = calibrate(even, read, options);
    all.with += left(turning, with, turning, errors) / machines;
    all.without += left(even, without, turning, errors) / machines;
    for (const ParameterEstimate& one : with.parameters) {
      if (!is_harmonic(one.source)) continue;
      ++all.values;
      const double off = one.with_drives.value_or(one.value) - errors(one.limb, one.source);
      all.held += std::abs(off) <= one.coverage() * one.std.value_or(0.0) ? 1 : 0;
    }
  }
  return all;
}

/// 12 values of each machine: 40 machines tell 95 % to 1 %. Intervals that are wrong by a fifth leave the range.
TEST(Harmonics, CalibrationFindsThem) {
  const Fits fits = fits_of(test::robot_named("hexapod"), 40);
  EXPECT_EQ(fits.values, 480);
  EXPECT_GE(fits.held, 0.93 * fits.values);
  EXPECT_LE(fits.held, 0.97 * fits.values);
  EXPECT_LT(std::sqrt(fits.with), 0.1 * std::sqrt(fits.without));
  EXPECT_LT(std::sqrt(fits.with), 0.0025);
}

}  // namespace
}  // namespace paracal::harmonics_test
