// Numbers of a calibration against what they are by their definitions.

#include <gmock/gmock.h>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "calibration/readings/points.hpp"
#include "calibration/verdict/evidence.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::evidence_test {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr double kNoise = 0.02;  // mm

/// Offsets alone are off, and nothing else may be: least squares without priors.
class Bare : public testing::Test {
 protected:
  Bare() {
    for (const Source source : all_sources()) {
      if (source != "theta_offset") options.fixed.push_back({source, {}});
    }
  }
  Calibration of(std::optional<double> sigma, int number = 1) const {
    SourceErrors offsets;
    offsets(1, "theta_offset") = to_radians(0.02);
    const Measurements read = measure(robot, offsets, rough_stations(robot, 9), number, {.noise = kNoise});
    Measurements measured{.stations = read.stations};
    for (DistanceReading one : all_distances(read.series[0])) {
      one.distance_sigma = sigma;
      if (one.from == 0) measured.distances.push_back(one);
    }
    return calibrate(robot, measured, options);
  }
  static double sum_of_squares(const Calibration& calibration, double DistanceResidual::*residual) {
    double sum = 0.0;
    for (const DistanceResidual& one : calibration.distances) sum += one.*residual * one.*residual;
    return sum;
  }

  Robot robot = catalogue::rotary_delta();
  CalibrationOptions options{.stage = Stage::rough, .scale_std = 0.0, .states_use = false, .diagnose = false};
  static constexpr double kFound = 3.0, kFreedom = 6.0;  // 9 distances, 3 offsets
};

/// Degrees of freedom that tell the noise count in what is stated of a set-up, too.
TEST_F(Bare, TheStdOfABiasHasStudentsFactor) {
  options.noise.distance_bias = 10.0;  // far beyond what the readings leave open
  const Calibration found = of({});
  options.noise_is_known = true;
  options.noise.distance = 1.001 * found.noise;  // by which the readings scatter no more than they may
  const Calibration known = of({});
  ASSERT_TRUE(found.distance_bias_std && known.distance_bias_std);
  EXPECT_NEAR(*found.distance_bias_std / *known.distance_bias_std, coverage_factor(found.noise_dof) / kCoverageFactor,
              0.01);
}

/// Without stated sigmas the residuals alone decide: s^2 = r^2 / (n - p), and F of what the offsets explain.
TEST_F(Bare, ScatterAndChanceOfUnstatedReadings) {
  const Calibration found = of({});
  const double before = sum_of_squares(found, &DistanceResidual::distance_before),
               after = sum_of_squares(found, &DistanceResidual::distance_after), variance = after / kFreedom;
  EXPECT_NEAR(found.noise, std::sqrt(variance), 1e-9);
  const boost::math::fisher_f_distribution<> fisher(kFound, kFreedom);
  const double chance = boost::math::cdf(boost::math::complement(fisher, (before - after) / kFound / variance));
  EXPECT_NEAR(*found.chance, chance, 1e-6 * chance);
  EXPECT_NEAR(found.noise_dof, kFreedom, 1e-9);
}

/// Stated sigmas that the residuals keep to are believed; those that they do not keep to are widened, never narrowed.
TEST_F(Bare, StatedSigmasCountAsStatedOrMore) {
  const Calibration wide = of(10.0 * kNoise), narrow = of(0.1 * kNoise), unstated = of({});
  const double after = sum_of_squares(wide, &DistanceResidual::distance_after),
               before = sum_of_squares(wide, &DistanceResidual::distance_before);
  const auto variance = [](const Calibration& one) { return one.noise_covariance(0, 0); };
  const double scatter = std::sqrt(after / kFreedom);
  EXPECT_NEAR(*wide.unit_weight_std, scatter / (10.0 * kNoise), 1e-6);
  EXPECT_NEAR(*narrow.unit_weight_std, scatter / (0.1 * kNoise), 1e-4);
  EXPECT_NEAR(variance(unstated), variance(wide) * std::pow(scatter / (10.0 * kNoise), 2), 1e-6 * variance(unstated));
  EXPECT_NEAR(variance(narrow), variance(unstated), 1e-6 * variance(unstated));
  EXPECT_TRUE(std::isinf(wide.noise_dof));
  EXPECT_NEAR(narrow.noise_dof, kFreedom, 1e-9);
  const boost::math::chi_squared_distribution<> of_rest(kFreedom), of_found(kFound);
  const double in_sigmas = std::pow(10.0 * kNoise, -2);
  EXPECT_NEAR(*wide.fit_probability, boost::math::cdf(boost::math::complement(of_rest, after * in_sigmas)), 1e-9);
  EXPECT_NEAR(*wide.chance, boost::math::cdf(boost::math::complement(of_found, (before - after) * in_sigmas)), 1e-9);
}

/// Measured less predicted, of machines and readings that are off by hand.
TEST(Residuals, AreMeasuredLessPredicted) {
  const Robot robot = catalogue::huang2016();
  Measurements read = measure(robot, {}, fine_stations(robot, 9), 1, {.reads_rotation = true});
  const double off = 0.4, turned = 5e-3;
  const Eigen::Vector3d beyond = (read.series[0].readings[5].point - read.series[0].readings[0].point).normalized();
  read.series[0].readings[5].point += off * beyond;
  *read.series[0].readings[5].rotation += turned;
  state_sigma(read, 0.1);
  CalibrationOptions options{.stage = Stage::fine, .states_use = false, .exclude_outliers = false, .diagnose = false};
  const Calibration points = calibrate(robot, read, options);
  const PointResidual& point = points.points[5];
  const Eigen::Vector3d away = (read.stations[5].commanded.position - read.stations[0].commanded.position).normalized();
  EXPECT_GT(point.before.dot(away), 0.5 * off);
  EXPECT_GT(point.after.dot(away), 0.2 * off);
  EXPECT_GT(*point.rotation_before, 0.5 * turned);
  EXPECT_NEAR(points.before.max_abs_distance, off, 0.2 * off);
  EXPECT_NEAR(*points.before.max_abs_rotation, turned, 0.2 * turned);

  Measurements lengths{.stations = read.stations, .distances = all_distances(read.series[0])};
  options.noise.distance_bias = 0.01;  // else they are taken for points
  const Calibration distances = calibrate(robot, lengths, options);
  double squares = 0.0;
  for (const DistanceResidual& one : distances.distances) {
    squares += one.distance_after * one.distance_after;
    if (one.from != "P0" || one.to != read.stations[5].name) continue;
    EXPECT_NEAR(one.distance_before, off, 0.2 * off);
    EXPECT_GT(one.distance_after, 0.1 * off);
  }
  EXPECT_NEAR(distances.after.rms_distance, std::sqrt(squares / static_cast<double>(distances.distances.size())), 1e-9);

  Measurements heights{.stations = read.stations, .lengths = {{"bed"}}};
  for (std::size_t k = 0; k < read.stations.size(); ++k) {
    heights.lengths[0].readings.push_back(
        {.station = k, .length = read.stations[k].commanded.position.z() + (k == 5 ? off : 0.0)});
  }
  const Calibration above = calibrate(robot, heights, options);
  EXPECT_GT(above.lengths[5].before, 0.5 * off);
  EXPECT_GT(above.lengths[5].after, 0.05 * off);
}

/// The rms of distances to home is that of all of them, home not counted.
TEST(Residuals, RmsOfPointsIsThatOfTheirDistancesToHome) {
  const Robot robot = catalogue::rotary_delta();
  Measurements read = measure(robot, {}, fine_stations(robot, 4), 1, {.noise = 0.05});
  const Calibration found =
      calibrate(robot, read, {.stage = Stage::fine, .states_use = false, .exclude_outliers = false, .diagnose = false});
  double squares = 0.0;
  const Eigen::Vector3d home = read.series[0].readings[0].point;
  for (std::size_t k = 1; k < read.stations.size(); ++k) {
    const double commanded = (read.stations[k].commanded.position - read.stations[0].commanded.position).norm();
    squares += std::pow((read.series[0].readings[k].point - home).norm() - commanded, 2);
  }
  EXPECT_NEAR(found.before.rms_distance, std::sqrt(squares / static_cast<double>(read.stations.size() - 1)), 2e-3);
}

/// Backlash that repeats: its standard deviation is stated and few poses know it.
TEST(Components, JointsThatStandElsewhereAreStated) {
  const Robot robot = catalogue::rotary_delta();
  Measurements read{.stations = fine_stations(robot, 9), .series = {{"tracker", {}}}};
  const double off = to_radians(0.01);
  const Machine machine = build(robot, {});
  RandomStream random(4);
  for (std::size_t k = 0; k < read.stations.size(); ++k) {
    Joints joints = believed_joints(robot, read.stations[k]);
    for (double& joint : joints) joint += random.uniform() < 0.5 ? off : -off;
    const Eigen::Vector3d place = forward(machine, joints).plate.position;
    for (int visit = 0; visit < 3; ++visit) {
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      read.series[0].readings.push_back({.station = k, .point = place + 0.005 * noise});
    }
  }
  const Calibration found = calibrate(robot, read, {.states_use = false});
  EXPECT_THAT(
      found.notes,
      Contains(testing::ContainsRegex("the poses differ from the model by 0\\.0.*\\(repeatability 0\\.005 mm\\)")));
  EXPECT_THAT(found.notes, testing::Not(Contains(HasSubstr("larger noise"))));
  EXPECT_NEAR(found.joint_std.norm() / std::sqrt(3.0), off, 0.35 * off);  // 57 joints, a third of which the errors take
  EXPECT_LT(found.visit_std.norm(), 0.2 * off);
}

/// Stated noise is known, unless the readings say otherwise; then the poses that say so know it.
TEST(Components, WhatTheReadingsToldHasTheirDegreesOfFreedom) {
  const Robot robot = catalogue::rotary_delta();
  const auto calibrated = [&](double sigma, double errors) {
    MeasuredMachine machine = measured_machine(robot, fine_stations(robot, 4), 3, {});
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : all_sources()) machine.errors(limb, source) *= errors;
    }
    Measurements read = measure(robot, machine.errors, fine_stations(robot, 4), 3, {.noise = kNoise, .repeats = 3});
    state_sigma(read, sigma);
    return calibrate(robot, read, {.stage = Stage::fine, .states_use = false, .diagnose = false});
  };
  const Calibration sound = calibrated(kNoise, 1.0), noisy = calibrated(0.3 * kNoise, 1.0),
                    wide = calibrated(kNoise, 4.0);
  EXPECT_TRUE(std::isinf(sound.noise_dof)) << sound.brief();
  EXPECT_LE(noisy.noise_dof, 3.0 * 27.0);
  EXPECT_GE(noisy.noise_dof, 27.0);
  ASSERT_THAT(wide.notes, Contains(HasSubstr("times as large as the tolerances")));
  EXPECT_GT(wide.covariance.trace(), 2.0 * sound.covariance.trace());  // what no reading tells is as wide as they are
}

/// Nothing is wrong but the noise, which nobody stated and is ten times what was expected: the chance of what the fit
/// explains is uniform, a half in the mean (0.05 its deviation over 30 machines).
TEST(Chance, OfNothingIsUniform) {
  const Robot robot = catalogue::rotary_delta();
  double mean = 0.0;
  constexpr int kMachines = 30;
  for (int number = 0; number < kMachines; ++number) {
    const Measurements read = measure(robot, {}, fine_stations(robot, 9), number, {.noise = 0.17});
    mean += *calibrate(robot, read,
                       {.stage = Stage::fine, .seeks_discrepancies = false, .states_use = false, .diagnose = false})
                 .chance /
            kMachines;
  }
  EXPECT_NEAR(mean, 0.5, 0.2);
}

TEST(Chance, AReadingThatWasLeftOutIsNotOfTheNominalMachineEither) {
  const Robot robot = catalogue::rotary_delta();
  Measurements read = measure(robot, {}, fine_stations(robot, 9), 1, {.noise = kNoise});
  read.series[0].readings[4].point.x() += 2.0;
  const Calibration found = calibrate(robot, read, {.stage = Stage::fine, .states_use = false, .diagnose = false});
  ASSERT_TRUE(found.points[4].excluded);
  EXPECT_LT(found.before.max_abs_distance, 10.0 * kNoise);
  EXPECT_GT(*found.chance, 1e-3);
  // 2 mm along one of three coordinates: some 2 / 0.02 / sqrt(3) times the noise.
  ASSERT_FALSE(found.notes.empty());
  const std::size_t number = found.notes.front().find("(residual ");
  ASSERT_NE(number, std::string::npos) << found.notes.front();
  EXPECT_NEAR(std::stod(found.notes.front().substr(number + 10)), 2.0 / kNoise / std::sqrt(3.0), 25.0);
}

TEST(StationPairs, AreWhatWasMeantAndWhatWasRead) {
  const Robot robot = catalogue::huang2016();
  Measurements read{.stations = fine_stations(robot, 4), .series = {{"hand", {}}}};
  for (std::size_t k = 0; k < read.stations.size(); ++k) {
    const Pose& pose = read.stations[k].commanded;
    read.series[0].readings.push_back(
        {.station = k, .point = pose.position + Eigen::Vector3d(0.1, 0.2, 0.3), .rotation = pose.rotation + 0.01});
  }
  const CalibrationOptions options{.frame = Frame::robot, .rotation_zero = RotationZero::known};
  detail::Observation observation(robot, read, options, {});
  const Eigen::VectorXd unknowns = *observation.start({});
  const auto stations = observation.stations(unknowns);
  const auto& points = dynamic_cast<const detail::Points&>(*observation.series().front());
  const auto pairs = points.station_pairs(observation.groups_of(0), {*stations, unknowns});
  ASSERT_EQ(pairs.size(), read.stations.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    EXPECT_LT((pairs[k].actual.position - read.series[0].readings[k].point).norm(), 1e-9);
    EXPECT_NEAR(pairs[k].actual.rotation, *read.series[0].readings[k].rotation, 1e-9);
  }
}

/// Without any prior, motions of the whole robot stay open: not the rough stage's, but the fine one's are asked for.
TEST(Determined, WithoutPriorsNothingMayBeOpen) {
  const Robot robot = catalogue::linear_delta();
  const Measurements read = measure(robot, {}, fine_stations(robot, 9), 1, {.noise = kNoise});
  CalibrationOptions options{.stage = Stage::fine, .states_use = false, .exclude_outliers = false, .diagnose = false};
  options.free.push_back({"theta_offset", {}});
  for (const Source source : all_sources()) {
    const bool length = source == "e_x" || source == "e_y" || source == "e_z";
    if (source != "theta_offset") (length ? options.free : options.fixed).push_back({source, {}});
  }
  EXPECT_EQ(calibrate(robot, read, options).verdict, Verdict::not_identifiable);
  EXPECT_NE(calibrate(robot, read, {.stage = Stage::rough, .states_use = false, .diagnose = false}).verdict,
            Verdict::not_identifiable);
}

/// e_x of all limbs alike moves the base, which no point in an unknown frame sees: without a prior nothing holds it,
/// and nothing may be said of it. arm_length is seen; a base whose frame is known is, too.
TEST(Determined, ErrorsWithoutAPriorMayNotBeOpenBesideOthersThatHaveOne) {
  const Robot robot = catalogue::huang2016();
  const auto freed = [&](Source source, Frame frame) {
    const Measurements read = measure(robot, {}, fine_stations(robot, 9), 1, {.noise = kNoise});
    CalibrationOptions options{.frame = frame, .states_use = true, .diagnose = false};
    options.free.push_back({source, {}});
    return calibrate(robot, read, options);
  };
  const Calibration open = freed("e_x", Frame::unknown);
  EXPECT_EQ(open.verdict, Verdict::not_identifiable);
  EXPECT_THAT(open.reasons,
              Contains(HasSubstr("give the errors of --free a tolerance, or fix a correlated one (--fix)")));
  EXPECT_EQ(open.covariance.size(), 0);
  EXPECT_FALSE(open.use);
  for (const Source source : {Source("arm_length"), Source("theta_offset")}) {
    const Calibration seen = freed(source, Frame::unknown);
    EXPECT_NE(seen.verdict, Verdict::not_identifiable) << name(source);
    EXPECT_GT(seen.covariance.size(), 0);
  }
  EXPECT_NE(freed("e_x", Frame::robot).verdict, Verdict::not_identifiable);
}

TEST(Stage, ConditionIsTheLargestOverTheSmallestSingularValue) {
  const Robot robot = catalogue::huang2016();
  const Measurements read = measure(robot, {}, fine_stations(robot, 9), 1, {.noise = kNoise});
  const Calibration found = calibrate(robot, read, {.stage = Stage::fine, .states_use = false});
  for (const StageReport& stage : found.stages) EXPECT_GT(stage.condition, 1.0) << stage.name;
}

}  // namespace
}  // namespace paracal::test::evidence_test
