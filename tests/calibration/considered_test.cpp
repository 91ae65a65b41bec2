// The covariance of encoder offsets found while all other errors are held, against fits to machines of which one error
// is off by a little.

#include <gmock/gmock.h>

#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::considered_test {
namespace {

constexpr double kShare = 1e-3;  // of its standard deviation that an error is off by

class ConsideredLaw : public test::EveryRobot {
 protected:
  /// Without noise: tolerances are all there is.
  Calibration rough(const SourceErrors& errors, double scale = 1.0) const {
    Measurements read = test::measure(robot, errors, rough_stations(robot, 6), 1, {});
    for (PointReading& one : read.series[0].readings) one.point *= scale;
    return calibrate(robot, read, {.stage = Stage::rough, .states_use = false, .diagnose = false});
  }
  /// Sought less true, of every limb's offset, per standard deviation.
  Eigen::VectorXd by(const ParameterEstimate& error) const {
    SourceErrors errors;
    errors(error.limb, error.source) = kShare * *error.prior_std;
    return offsets_of(rough(errors), errors) / kShare;
  }
  /// What points tell of offsets: nothing of rails' that are all alike, which are the robot's height.
  Eigen::MatrixXd seen() const {
    const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
    const Eigen::MatrixXd all = Eigen::MatrixXd::Identity(limbs, limbs);
    return robot.actuator() == Actuator::revolute
               ? all
               : all - Eigen::MatrixXd::Constant(limbs, limbs, 1.0 / static_cast<double>(limbs));
  }
  Eigen::VectorXd offsets_of(const Calibration& calibration, const SourceErrors& truth) const {
    const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
    Eigen::VectorXd off(limbs);
    for (Eigen::Index limb = 0; limb < limbs; ++limb) {
      const auto place = static_cast<std::size_t>(limb);
      off(limb) = calibration.errors()(place, "theta_offset") - truth(place, "theta_offset");
    }
    return off;
  }
};

TEST_P(ConsideredLaw, CovarianceIsThatOfEveryErrorByItself) {
  const Calibration nominal = rough({});
  const auto limbs = static_cast<Eigen::Index>(robot.limb_count());
  ASSERT_EQ(nominal.covariance.rows(), std::ssize(nominal.parameters));
  Tolerances tolerances = *robot.tolerances();
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(limbs, limbs);
  const double size = std::sqrt(nominal.covariance(0, 0));
  for (Eigen::Index k = 0; k < std::ssize(nominal.parameters); ++k) {
    ParameterEstimate one = nominal.parameters[static_cast<std::size_t>(k)];
    one.prior_std = tolerances[one.source] / 3.0;
    const Eigen::VectorXd found = by(one);
    expected += found * found.transpose();
    if (!one.held) continue;
    EXPECT_NEAR(nominal.covariance(k, k), *one.prior_std * *one.prior_std, 1e-9 * nominal.covariance(k, k));
    // Found too large by so much, it is itself too small by all that it is.
    const Eigen::VectorXd with_held = -found * *one.prior_std;
    EXPECT_LT((seen() * (nominal.covariance.block(0, k, limbs, 1) - with_held)).norm(), 0.02 * size * *one.prior_std)
        << k;
    EXPECT_EQ(nominal.covariance.block(0, k, limbs, 1), nominal.covariance.block(k, 0, 1, limbs).transpose());
  }
  constexpr double kScale = 1e-4;
  const Eigen::VectorXd by_scale = offsets_of(rough({}, 1.0 + kScale), {}) / kScale * CalibrationOptions().scale_std;
  expected += by_scale * by_scale.transpose();
  const Eigen::MatrixXd ours = (nominal.covariance - nominal.noise_covariance).topLeftCorner(limbs, limbs);
  EXPECT_LT((seen() * (ours - expected) * seen()).norm(), 0.02 * (seen() * expected * seen()).norm());
}

/// The scale of the instrument by itself: nothing else is off.
TEST_P(ConsideredLaw, TheScaleOfTheInstrumentCounts) {
  CalibrationOptions options{.stage = Stage::rough, .scale_std = 1e-4, .states_use = false, .diagnose = false};
  for (const Source source : all_sources()) {
    if (source != "theta_offset") options.fixed.push_back({source, {}});
  }
  const auto found = [&](double scale) {
    Measurements read = test::measure(robot, {}, rough_stations(robot, 6), 1, {});
    for (PointReading& one : read.series[0].readings) one.point *= scale;
    return calibrate(robot, read, options);
  };
  const Calibration calibration = found(1.0);
  const double by_scale = found(1.0 + 1e-4).parameters[0].value - calibration.parameters[0].value;
  const double ours = calibration.covariance(0, 0) - calibration.noise_covariance(0, 0);
  if (robot.actuator() == Actuator::linear) {  // offsets of all rails alike are the robot's height, which nothing tells
    const double prior = (*robot.tolerances())["theta_offset"] / 3.0;
    EXPECT_GE(ours, by_scale * by_scale + prior * prior / static_cast<double>(robot.limb_count()));
  } else {
    EXPECT_NEAR(ours, by_scale * by_scale, 0.02 * ours);
  }
}

/// A point that was left out as gross is not there.
TEST_P(ConsideredLaw, ReadingsLeftOutDoNotCount) {
  Measurements read = test::measure(robot, {}, fine_stations(robot, 4), 1, {});
  const CalibrationOptions options{.stage = Stage::rough, .states_use = false, .diagnose = false};
  Measurements without = read;
  without.series[0].readings.erase(without.series[0].readings.begin() + 3);
  read.series[0].readings[3].point.x() += 300.0;
  const Calibration calibration = calibrate(robot, read, options), expected = calibrate(robot, without, options);
  ASSERT_TRUE(calibration.points[3].excluded);
  EXPECT_LT((calibration.covariance - expected.covariance).norm(), 1e-3 * expected.covariance.norm());
}

PARACAL_ON_EVERY_ROBOT(ConsideredLaw);

}  // namespace
}  // namespace paracal::considered_test
