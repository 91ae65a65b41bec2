// Failures too rare to be counted: against closed forms, against plain Monte Carlo where that can tell, and what is
// said where nothing can be told.

#include "paracal/tolerance/failure.hpp"

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numbers>

#include "numerics/dense.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/tolerance/analysis.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"
#include "tolerance/source_law.hpp"

namespace paracal::failure_test {
namespace {

using testing::HasSubstr, testing::IsEmpty, testing::Not;

constexpr double kZ95 = 1.959964;  // half-widths of 95 % intervals

double normal_tail(double z) { return boost::math::cdf(boost::math::complement(boost::math::normal(), z)); }

std::vector<Pose> workspace_poses(const Robot& robot) {
  std::vector<Pose> poses;
  for (const Station& station : workspace_stations(robot)) poses.push_back(station.commanded);
  return poses;
}

/// Half of the logarithm of an interval's ends, in standard deviations.
double log_error(const WeighedShare& share) { return std::log(share.interval.high / share.interval.low) / (2 * kZ95); }

/// Within so many standard deviations, of which the other has some of its own.
void expect_agreement(const WeighedShare& share, double truth, double relative_error = 0.0) {
  EXPECT_LT(std::abs(std::log(share.value / truth)), 4.0 * std::hypot(log_error(share), relative_error))
      << share.value << " against " << truth;
}

// ---- one source error

/// The three distributions, then parts that were measured.
Tolerances spread_as(int number) {
  Tolerances tolerances;
  tolerances.distribution = static_cast<Distribution>(number % 3);
  tolerances["e_x"] = 0.3;
  if (number == 3) tolerances.measured["e_x"] = {0.1, -0.05, 0.2, 0.02};
  return tolerances;
}

class SourceLawTest : public testing::TestWithParam<int> {
 protected:
  const Tolerances tolerances_ = spread_as(GetParam());
  const detail::SourceLaw law_{tolerances_, "e_x"};
};
INSTANTIATE_TEST_SUITE_P(All, SourceLawTest, testing::Range(0, 4));

/// Means of a function of drawn numbers, by the middle of each of many equal parts of the probability.
double mean_of_drawn(const detail::SourceLaw& law, double t, const std::function<double(double)>& function) {
  constexpr int kParts = 200'000;
  double sum = 0.0;
  for (int k = 0; k < kParts; ++k) {
    sum += function(law.draw(t, boost::math::quantile(boost::math::normal(), (k + 0.5) / kParts)));
  }
  return sum / kParts;
}

TEST_P(SourceLawTest, DrawsTheTiltedLaw) {
  for (const double t : {0.0, 1e-6, 2.0, -2.0, 15.0, -15.0, 60.0, 250.0}) {
    EXPECT_NEAR(mean_of_drawn(law_, t, [](double e) { return e; }), law_.mean(t), 2e-5) << t;
    constexpr double kStep = 1e-4;
    EXPECT_NEAR((law_.cumulant(t + kStep) - law_.cumulant(t - kStep)) / (2 * kStep), law_.mean(t), 1e-7) << t;
    // E_t exp(-t e) = exp(-K(t)) of the law as drawn: its weights undo the tilt.
    if (std::abs(t) > 20.0) continue;
    EXPECT_NEAR(mean_of_drawn(law_, t, [&](double e) { return std::exp(-t * e + law_.cumulant(t)); }), 1.0, 3e-3) << t;
  }
  EXPECT_EQ(law_.cumulant(0.0), 0.0);
}

TEST_P(SourceLawTest, WithoutTiltIsTheErrorOfAMachine) {
  for (const double z : {-2.5, -0.3, 0.0, 1.7}) {
    EXPECT_EQ(law_.draw(0.0, z), source_error(tolerances_, "e_x", z));
    EXPECT_NEAR(law_.draw(1e-9, z), source_error(tolerances_, "e_x", z), 1e-7);
  }
  EXPECT_NEAR(law_.std(), tolerances_.std("e_x"), 1e-15);
}

TEST_P(SourceLawTest, StaysWithinItsEndsHoweverTilted) {
  for (const double t : {-1.0, 1.0}) {
    const double far = std::isinf(law_.largest_tilt()) ? 1e3 : law_.largest_tilt();
    for (const double z : {-8.0, 0.0, 8.0}) {
      const double drawn = law_.draw(t * far, z);
      EXPECT_TRUE(std::isfinite(drawn));
      EXPECT_GE(drawn, law_.least());
      EXPECT_LE(drawn, law_.most());
    }
    const double mean = law_.mean(t * far), end = t > 0 ? law_.most() : law_.least();
    if (std::isfinite(end)) {
      EXPECT_LT(std::abs(mean - end), 0.05 * std::abs(end));
    }
  }
}

// ---- shares in closed form

/// Of a component y ~ N(0, sigma^2): P(|y| > L) = 2 Phi(-L / sigma).
TEST(FailureShare, OfOneComponentIsTheNormalTail) {
  const Robot robot = catalogue::huang2016();
  const Pose pose{{300.0, -100.0, -950.0}, 0.5};
  const SourceRows rows = LinearModel(robot).rows(pose, {Quantity::twist});
  const double sigma = sigma_of(squared_sensitivities(robot, rows), variances(*robot.tolerances()));
  for (const double z : {1.0, 2.0, 4.0, 6.0, 7.5}) {
    const FailureShare found =
        failure_share(robot, *robot.tolerances(), {{{Quantity::twist}, z * sigma}}, {pose}, {.max_exact = 0});
    ASSERT_EQ(found.status, FailureStatus::settled) << found.reason;
    expect_agreement(found.linear, 2.0 * normal_tail(z));
    expect_agreement(found.check, 2.0 * normal_tail(z));
    EXPECT_LT(log_error(found.linear), 0.05 / kZ95 * 1.2);
    EXPECT_FALSE(found.exact);
  }
}

/// Parts so good that both models take the same machines for failures: the exact share is the linear one, and as well
/// known.
TEST(FailureShare, IsKnownAsTheLinearOneWhereTheModelsAgree) {
  const Robot robot = catalogue::huang2016();
  Tolerances tolerances = *robot.tolerances();
  for (double& half_width : tolerances.half_width) half_width *= 1e-3;
  const Pose pose{{300.0, -100.0, -950.0}, 0.5};
  const SourceRows rows = LinearModel(robot).rows(pose, {Quantity::twist});
  const double sigma = sigma_of(squared_sensitivities(robot, rows), variances(tolerances));
  const FailureShare found = failure_share(robot, tolerances, {{{Quantity::twist}, 3.0 * sigma}}, {pose},
                                           {.relative_error = 0.2, .max_exact = 2000});
  ASSERT_TRUE(found.exact) << found.reason;
  EXPECT_NEAR(found.exact->value / found.linear.value, 1.0, 0.02);
  EXPECT_NEAR(log_error(*found.exact) / log_error(found.linear), 1.0, 0.2);
}

/// Of two components with principal standard deviations s, t:
///
///   P(|y| > L) = mean over phi of exp(-L^2 / (2 (s^2 cos^2 phi + t^2 sin^2 phi)))
double tail_of_two(const Eigen::Matrix2d& covariance, double limit) {
  const Eigen::Vector2d variances = detail::symmetric_eigenvalues(covariance);
  constexpr int kParts = 100'000;
  double sum = 0.0;
  for (int k = 0; k < kParts; ++k) {
    const double phi = 2.0 * std::numbers::pi * k / kParts;
    const double along = variances(0) * std::pow(std::cos(phi), 2) + variances(1) * std::pow(std::sin(phi), 2);
    sum += std::exp(-limit * limit / (2.0 * along));
  }
  return sum / kParts;
}

class FailureLaw : public test::EveryRobot {
 protected:
  /// A tilt, or of a plate with six freedoms a turn, about x and y.
  Eigen::Matrix2d covariance_of_tilt(const Pose& pose) const {
    const SourceRows rows = LinearModel(robot).rows(pose, {Quantity::tilt});
    Eigen::VectorXd variances(rows.cols());
    std::ranges::transform(robot.parameters(), variances.begin(),
                           [&](const Parameter& one) { return std::pow(robot.tolerances()->std(one.source), 2); });
    return rows * variances.asDiagonal() * rows.transpose();
  }
  const Pose aside_{robot.workspace().centre() + Eigen::Vector3d(0.3 * robot.workspace().radius, 0.0, 0.0), 0.0};
};
PARACAL_ON_EVERY_ROBOT(FailureLaw);
PARACAL_ON_HEXAPODS(FailureLaw);

/// Intervals hold the truth as often as they say, down to one in 10^9. Twelve random numbers for each tail, everywhere:
/// of four, huang2016 would not show weights that leave out the machines drawn as they are.
TEST_P(FailureLaw, IntervalsHoldTheTailOfTwoComponents) {
  const Eigen::Matrix2d covariance = covariance_of_tilt(aside_);
  const double largest = std::sqrt(detail::symmetric_eigenvalues(covariance).maxCoeff());
  int inside = 0, all = 0;
  for (const double z : {3.0, 4.5, 6.2}) {
    const double truth = tail_of_two(covariance, z * largest);
    for (std::uint64_t seed = 1; seed <= 12; ++seed, ++all) {
      const FailureShare found = failure_share(robot, *robot.tolerances(), {{{Quantity::tilt}, z * largest}}, {aside_},
                                               {.seed = seed, .max_exact = 0});
      ASSERT_EQ(found.status, FailureStatus::settled) << found.reason;
      inside += found.linear.interval.contains(truth) ? 1 : 0;
      expect_agreement(found.linear, truth);
    }
  }
  EXPECT_GE(inside, 29) << "of " << all;  // 36 at 95 %: fewer in 1 of 1000
}

/// Shares of machines that plain Monte Carlo can count, over the workspace, by the linear model. Every tenth pose makes
/// limits break at several, as all of them do.
TEST_P(FailureLaw, AgreesWithCountedMachines) {
  std::vector<Pose> poses;
  const std::vector<Pose> all = workspace_poses(robot);
  for (std::size_t k = 0; k < all.size(); k += test::every_machine() ? 1 : 10) poses.push_back(all[k]);
  for (int distribution = 0; distribution < 3; ++distribution) {
    Tolerances tolerances = *robot.tolerances();
    tolerances.distribution = static_cast<Distribution>(distribution);
    const std::vector<Requirement> any{{{Quantity::tilt}, 1.0}, {{Quantity::position}, 1.0}};
    const MonteCarlo drawn = monte_carlo(robot, tolerances, any, poses, {.sigma_error = 1e-9, .max_machines = 60'000});
    std::vector<Requirement> requirements = any;
    for (std::size_t k = 0; k < any.size(); ++k) requirements[k].limit = drawn.requirements[k].largest.quantile(0.997);
    const MonteCarlo counted =
        monte_carlo(robot, tolerances, requirements, poses, {.seed = 2, .sigma_error = 1e-9, .max_machines = 60'000});
    const FailureShare found = failure_share(robot, tolerances, requirements, poses, {.max_exact = 0});
    ASSERT_EQ(found.status, FailureStatus::settled) << found.reason;
    const double share = 1.0 - counted.yield().value;
    ASSERT_GT(share, 1e-3);
    expect_agreement(found.linear, share, 1.0 / std::sqrt(60'000 * share));
    expect_agreement(found.check, share, 1.0 / std::sqrt(60'000 * share));
    // Either limit may break: more than by one, less than by both.
    double sum = 0.0, most = 0.0;
    for (const Requirement& one : requirements) {
      const double alone = failure_share(robot, tolerances, {one}, poses, {.max_exact = 0}).linear.value;
      sum += alone;
      most = std::max(most, alone);
    }
    EXPECT_GT(found.linear.value, most * 0.87);  // each known to 5 %
    EXPECT_LT(found.linear.value, sum * 1.13);
  }
}

/// The share by the exact model is that of machines put through the closure, where these can be counted, though the
/// linear one says something else.
TEST_P(FailureLaw, TheExactShareIsThatOfTheClosure) {
  Tolerances tolerances = *robot.tolerances();
  for (double& half_width : tolerances.half_width) half_width *= 2.5;
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < 121; k += 12) poses.push_back(workspace_poses(robot)[k]);
  const Characteristic what{Quantity::tilt};
  constexpr std::uint64_t kMachines = 20'000;
  const auto exactly = [&](double limit, std::uint64_t seed) {
    return monte_carlo(robot, tolerances, {{what, limit}}, poses,
                       {.model = Model::exact, .seed = seed, .sigma_error = 1e-9, .max_machines = kMachines});
  };
  const double limit = exactly(1.0, 1).requirements[0].largest.quantile(0.98);
  const MonteCarlo counted = exactly(limit, 2);
  const FailureShare found = failure_share(robot, tolerances, {{what, limit}}, poses);
  ASSERT_EQ(found.status, FailureStatus::settled) << found.reason;
  ASSERT_TRUE(found.exact) << found.reason;
  const double share = 1.0 - counted.yield().value;
  expect_agreement(*found.exact, share, 1.0 / std::sqrt(kMachines * share));
}

TEST_P(FailureLaw, DoesNotDependOnThreads) {
  const std::vector<Pose> poses = workspace_poses(robot);
  const double limit = 8.0 * std::sqrt(covariance_of_tilt(aside_).trace());
  const auto found = [&](unsigned threads) {
    return failure_share(robot, *robot.tolerances(), {{{Quantity::tilt}, limit}}, poses,
                         {.relative_error = 0.2, .max_exact = 200, .threads = threads});
  };
  const FailureShare one = found(1), two = found(2);
  EXPECT_EQ(one.linear.value, two.linear.value);
  EXPECT_EQ(one.check.value, two.check.value);
  ASSERT_EQ(one.exact.has_value(), two.exact.has_value());
  if (one.exact) {
    EXPECT_EQ(one.exact->value, two.exact->value);
  }
}

// ---- what is said where it is not known

/// The limit that a share of 1e-6 of the machines of huang2016 breaks by tilt, about.
constexpr double kRareTilt = 1.23e-3;

TEST(FailureShare, TellsTheModelsApartWhereFailuresAreRare) {
  const Robot robot = catalogue::huang2016();
  const FailureShare found =
      failure_share(robot, *robot.tolerances(), {{{Quantity::tilt}, 1.6e-3}}, workspace_poses(robot));
  ASSERT_TRUE(found.exact) << found.reason;
  EXPECT_LT(found.linear.value, 1e-10);
  // The exact tilt is a little larger, which is much of such a share: the intervals say so.
  EXPECT_GT(found.exact->interval.low, found.linear.interval.high);
  EXPECT_EQ(found.not_closed, 0U);
}

TEST(FailureShare, OfPartsThatCannotFailIsSaidToBeImpossible) {
  const Robot robot = catalogue::huang2016();
  Tolerances tolerances = *robot.tolerances();
  tolerances.distribution = Distribution::uniform;
  const std::vector<Pose> poses{{robot.workspace().centre(), 0.0}};
  const double worst = worst_case(robot, LinearModel(robot).rows(poses[0], {Quantity::tilt}), tolerances).value;
  const auto found = [&](double limit) { return failure_share(robot, tolerances, {{{Quantity::tilt}, limit}}, poses); };
  EXPECT_EQ(found(1.01 * worst).status, FailureStatus::impossible);
  EXPECT_THAT(found(1.01 * worst).reason, HasSubstr("no machine within its tolerances"));
  EXPECT_EQ(found(0.5 * worst).status, FailureStatus::settled);
  EXPECT_GT(found(0.5 * worst).best().value, 0.0);
}

TEST(FailureShare, FromTooFewMachinesCannotBeTold) {
  const Robot robot = catalogue::huang2016();
  const FailureShare found = failure_share(robot, *robot.tolerances(), {{{Quantity::tilt}, kRareTilt}},
                                           workspace_poses(robot), {.max_machines = 64});
  EXPECT_EQ(found.status, FailureStatus::unsettled);
  EXPECT_THAT(found.reason, HasSubstr("effective failures"));
  EXPECT_FALSE(found.exact);
}

TEST(FailureShare, WhereTheModelsPartTheExactOneIsNotGuessed) {
  const Robot robot = catalogue::huang2016();
  Tolerances tolerances = *robot.tolerances();
  for (double& half_width : tolerances.half_width) half_width *= 12.0;  // of which many machines do not close
  const FailureShare found =
      failure_share(robot, tolerances, {{{Quantity::tilt}, 12.0 * kRareTilt}}, workspace_poses(robot));
  EXPECT_FALSE(found.exact);
  EXPECT_THAT(found.reason, HasSubstr("exact model"));
}

TEST(FailureShare, StopsWhenAsked) {
  const Robot robot = catalogue::huang2016();
  const FailureShare found =
      failure_share(robot, *robot.tolerances(), {{{Quantity::tilt}, kRareTilt}}, workspace_poses(robot), {},
                    [](std::uint64_t, std::uint64_t) { return false; });
  EXPECT_EQ(found.status, FailureStatus::unsettled);
  EXPECT_EQ(found.reason, "stopped");
}

TEST(FailureShare, DecidesTheYieldWhereItIsSettled) {
  const Robot robot = catalogue::huang2016();
  MonteCarlo drawn{.machines = 1000, .passed = 999};
  FailureShare failures{.status = FailureStatus::settled, .linear = {.value = 1e-6, .interval = {9e-7, 2e-6}}};
  EXPECT_EQ(yield(failures, drawn, 0.95).value, 1.0 - 1e-6);
  EXPECT_EQ(yield(failures, drawn, 0.95).interval.low, 1.0 - 2e-6);
  failures.exact = {.value = 3e-6, .interval = {2e-6, 4e-6}};
  EXPECT_EQ(yield(failures, drawn, 0.95).interval.high, 1.0 - 2e-6);
  for (const FailureStatus status : {FailureStatus::unsettled, FailureStatus::impossible}) {
    failures.status = status;
    EXPECT_EQ(yield(failures, drawn, 0.95).value, 0.999);
  }
}

/// The linear model says nothing of machines where the exact one contradicts it, or was not asked.
TEST(FailureShare, ProvesAYieldByTheExactModelAlone) {
  MonteCarlo drawn{.machines = 1000, .passed = 999};
  FailureShare failures{.status = FailureStatus::settled, .linear = {.value = 1e-6, .interval = {9e-7, 2e-6}}};
  EXPECT_FALSE(is_proven(failures, drawn));
  drawn.model = Model::exact;
  EXPECT_TRUE(is_proven(failures, drawn));
  EXPECT_EQ(yield(failures, drawn, 0.95).value, 0.999) << "the machines that were counted";
  failures.exact = {.value = 3e-6, .interval = {2e-6, 4e-6}};
  EXPECT_EQ(yield(failures, drawn, 0.95).value, 1.0 - 3e-6);
  drawn.model = Model::linear;
  EXPECT_TRUE(is_proven(failures, drawn));
  failures = {.status = FailureStatus::unsettled};
  EXPECT_FALSE(is_proven(failures, drawn));
  failures.status = FailureStatus::impossible;
  EXPECT_TRUE(is_proven(failures, drawn));
}

TEST(FailureShare, AsksForWhatMakesSense) {
  const Robot robot = catalogue::huang2016();
  const std::vector<Requirement> tilt{{{Quantity::tilt}, 1e-3}};
  const std::vector<Pose> poses{{robot.workspace().centre(), 0.0}};
  EXPECT_THROW((void)failure_share(robot, *robot.tolerances(), {}, poses), InvalidArgument);
  EXPECT_THROW((void)failure_share(robot, *robot.tolerances(), tilt, {}), InvalidArgument);
  EXPECT_THROW((void)failure_share(robot, *robot.tolerances(), tilt, poses, {.relative_error = 0.0}), InvalidArgument);
  EXPECT_THROW((void)failure_share(robot, *robot.tolerances(), tilt, poses, {.confidence = 1.0}), InvalidArgument);
}

/// A machine is worst where its own errors make it so. The share at the poses that are judged is that of the whole
/// workspace, here five times as many poses, inside included: within 15 %, of which the two drawings have 5 %.
class JudgedPoses : public testing::TestWithParam<double> {};

TEST_P(JudgedPoses, AreWhereLimitsBreak) {
  const Robot robot = catalogue::huang2016();
  const Tolerances& tolerances = *robot.tolerances();
  const std::vector<Requirement> limits{{{Quantity::tilt}, GetParam()}};
  const std::vector<RequirementAnalysis> analyses = analyze(robot, tolerances, limits);
  const auto share = [&](const std::vector<Pose>& poses) {
    return failure_share(robot, tolerances, limits, poses, {.max_exact = 0}).linear.value;
  };
  const double judged = share(judged_poses(robot, tolerances, analyses));
  const double dense = share(polar_grid(robot, {.radii = 3, .azimuths = 48, .layers = 5}, true));
  EXPECT_NEAR(judged, dense, 0.15 * dense);
  EXPECT_GT(judged, 1.5 * share(workspace_poses(robot)));  // the plan's, 39 places with a rotation each
}
INSTANTIATE_TEST_SUITE_P(Limits, JudgedPoses, testing::Values(0.0008));

}  // namespace
}  // namespace paracal::failure_test
