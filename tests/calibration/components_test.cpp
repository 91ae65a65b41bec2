// Components of variance, each on a machine of which nothing else is off.

#include "calibration/verdict/components.hpp"

#include <gmock/gmock.h>

#include "calibration/fit/sought.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::components_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr double kNoise = 0.017;  // mm

class Variances : public testing::Test {
 protected:
  /// Stated noise; errors so many times as large as tolerances say.
  Measurements read(double noise, double errors, int repeats = 1, int number = 5) const {
    MeasuredMachine machine = measured_machine(robot, stations, number, {});
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : all_sources()) machine.errors(limb, source) *= errors;
    }
    Measurements measured = measure(robot, machine.errors, stations, number, {.noise = noise, .repeats = repeats});
    state_sigma(measured, kNoise);
    return measured;
  }
  detail::StageFit fit(const Measurements& measured) const {
    detail::StageFit stage(robot, measured, options, detail::all_with_priors(robot, options), {});
    stage.settle();
    return stage;
  }
  static std::vector<std::size_t> places(std::size_t count) {
    std::vector<std::size_t> all;
    for (std::size_t k = 0; k < count; ++k) all.push_back(k);
    return all;
  }
  /// One error is so many standard deviations of its tolerance off, on one limb or with signs in turn on all.
  Calibration with_wrong(Source source, double deviations, bool all_limbs) const {
    SourceErrors errors;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      if (all_limbs || limb == 1) {
        errors(limb, source) = (limb == 1 ? 1.0 : -1.0) * deviations * (*robot.tolerances())[source] / 3.0;
      }
    }
    Measurements measured = measure(robot, errors, stations, 5, {.noise = kNoise});
    state_sigma(measured, kNoise);
    return calibrate(robot, measured, {.states_use = false, .diagnose = false});
  }

  Robot robot = catalogue::rotary_delta();
  std::vector<Station> stations = fine_stations(robot, 9);
  CalibrationOptions options;
};

TEST_F(Variances, StatedNoiseThatIsThreeTimesAsLarge) {
  const Measurements measured = read(3.0 * kNoise, 1.0, 3);
  detail::StageFit stage = fit(measured);
  stage.seek_stated_noise(1.0);
  stage.settle();
  EXPECT_NEAR(stage.observation().components().stated_noise, 3.0, 0.5);  // some 140 rows to spare: 0.06 of it
}

/// Nobody stated it: 36 rows to spare know the noise of one machine to 0.12 of it.
TEST_F(Variances, NoiseThatNobodyStated) {
  double mean = 0.0;
  for (int number = 0; number < 10; ++number) {
    const Measurements measured = measured_machine(robot, stations, number, {.noise = 0.03}).measurements;
    mean += calibrate(robot, measured, {.states_use = false, .diagnose = false}).noise / 10.0;
  }
  EXPECT_NEAR(mean, 0.03, 0.0045);
}

/// Whatever the rounds before it knew, the last answer is one for the noise that is stated with it: to solve again
/// moves nothing by more than a thousandth of its standard deviation, and what the readings scatter is within 2 % of
/// that noise.
TEST_F(Variances, SettlesAtTheAnswer) {
  for (int number = 0; number < 10; ++number) {
    const Measurements measured = measured_machine(robot, stations, number, {.noise = 0.03}).measurements;
    detail::StageFit stage = fit(measured);
    const detail::Scatter scatter = stage.scatter();
    EXPECT_NEAR(std::sqrt(scatter.sum / scatter.redundancy), 1.0, 0.02);
    const Eigen::VectorXd settled = stage.fit().parameters;
    const Eigen::ArrayXd std = stage.covariance().diagonal().cwiseSqrt();
    stage.solve();
    EXPECT_LT(((stage.fit().parameters - settled).array().abs() / std).maxCoeff(), 1e-3);
  }
}

/// About half of the errors are told by the readings: what the others leave at zero must not count. 20 errors know the
/// factor of one machine to 0.16 of it.
TEST_F(Variances, TolerancesThatAreFourTimesTooSmall) {
  double mean = 0.0;
  for (int number = 0; number < 10; ++number) {
    const Measurements measured = read(kNoise, 4.0, 1, number);
    detail::StageFit stage = fit(measured);
    stage.seek_wider_priors(places(stage.observation().sought().size()), 1.0);
    stage.settle();
    mean += stage.components().priors.front().factor / 10.0;
  }
  EXPECT_NEAR(mean, 4.0, 0.8);
}

/// The prior of an error that no reading tells of does not matter, however wide it is.
TEST_F(Variances, LikelihoodKnowsNothingOfWhatIsNotTold) {
  const Measurements measured = read(kNoise, 1.0);
  detail::StageFit stage = fit(measured);
  const Eigen::MatrixXd covariance = stage.covariance();
  std::size_t untold = 0;
  double most = 0.0;
  for (std::size_t k = 0; k < stage.observation().sought().size(); ++k) {
    const Eigen::Index at = stage.observation().nuisance_count() + static_cast<Eigen::Index>(k);
    const double prior = *stage.observation().sought()[k].prior_std, left = covariance(at, at) / (prior * prior);
    if (left > most) most = left, untold = k;
  }
  ASSERT_GT(most, 0.99);
  const double before = stage.minus_twice_log_likelihood();
  stage.seek_wider_priors({untold}, 2.0);
  stage.solve();
  EXPECT_NEAR(stage.minus_twice_log_likelihood(), before, 0.2);
}

TEST_F(Variances, AComponentTriedInVainLeavesNoTrace) {
  const Measurements measured = read(kNoise, 4.0);
  detail::StageFit stage = fit(measured);
  const auto prior = [&] { return *stage.observation().sought()[0].prior_std; };
  const double tolerance = prior();
  const detail::StageFit::State before = stage.state();
  stage.seek_wider_priors({0, 1}, 5.0);
  const detail::StageFit::State after = stage.state();
  stage.restore(before);
  EXPECT_NEAR(prior(), tolerance, 1e-12);
  stage.restore(after);
  EXPECT_NEAR(prior(), 5.0 * tolerance, 1e-12);
}

/// What a group's factor came to is known by no more errors than it has; one error by itself needs no factor.
TEST_F(Variances, FreedomOfFactorsIsThatOfTheSmallestGroup) {
  const Measurements measured = read(kNoise, 1.0);
  detail::StageFit stage = fit(measured);
  stage.seek_wider_priors({0}, 5.0);
  EXPECT_FALSE(stage.prior_freedom());
  stage.seek_wider_priors({0, 1}, 2.0);
  stage.seek_wider_priors(places(stage.observation().sought().size()), 2.0);
  ASSERT_TRUE(stage.prior_freedom());
  EXPECT_LE(*stage.prior_freedom(), 2.0);
}

/// Visits and poses of a sound machine scatter alike, as stated.
TEST_F(Variances, ScatterOfVisitsAndOfPosesIsTheNoise) {
  const Measurements measured = read(kNoise, 1.0, 3);
  const detail::FitScatter scatter = detail::fit_scatter(fit(measured));
  EXPECT_EQ(scatter.visits.redundancy, 19.0 * 2.0 * 3.0);
  EXPECT_NEAR(scatter.visits.sum / scatter.visits.redundancy, 1.0, 0.4);  // deviation 0.13
  EXPECT_NEAR(scatter.poses.sum / scatter.poses.redundancy, 1.0, 0.8);    // deviation 0.25
}

TEST_F(Variances, AWrongPartIsNamed) {
  EXPECT_THAT(with_wrong("arm_length", 30.0, false).notes,
              Contains(AllOf(HasSubstr("arm_length of limb 2 is"), HasSubstr("check the part and the tolerance"))));
}

TEST_F(Variances, AKindOfPartIsNamed) {
  EXPECT_THAT(with_wrong("arm_length", 8.0, true).notes, Contains(HasSubstr("arm_length is, on all limbs,")));
}

/// Without repeats the noise is what was stated, and there may be more of it, as there is here.
TEST_F(Variances, WithoutRepeatsJointsAreToldByTheStatedNoise) {
  robot = catalogue::huang2016();
  Measurements measured = measured_machine(robot, fine_stations(robot, 9), 3, {.noise = kNoise}).measurements;
  state_sigma(measured, 0.005);
  EXPECT_THAT(calibrate(robot, measured, {.states_use = false, .diagnose = false}).notes,
              Contains(AllOf(HasSubstr("more than the noise explains (stated noise 0.005 mm)"),
                             HasSubstr("load or larger noise"))));
}

}  // namespace
}  // namespace paracal::test::components_test
