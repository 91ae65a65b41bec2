#include "paracal/tolerance/monte_carlo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/tolerance/analysis.hpp"
#include "support/robots.hpp"

namespace paracal::monte_carlo_test {
namespace {

std::vector<Pose> workspace_poses(const Robot& robot, std::size_t every = 1) {
  std::vector<Pose> poses;
  const std::vector<Station> stations = workspace_stations(robot);
  for (std::size_t k = 0; k < stations.size(); k += every) poses.push_back(stations[k].commanded);
  return poses;
}

/// The robot's tolerances, each times a factor between 1/4 and 4.
Tolerances random_tolerances(const Robot& robot, std::uint64_t number) {
  Tolerances tolerances = *robot.tolerances();
  RandomStream random(77, number);
  for (double& half_width : tolerances.half_width) half_width *= std::exp2(4.0 * random.uniform() - 2.0);
  return tolerances;
}

class MonteCarloLaw : public test::EveryRobot {};
PARACAL_ON_EVERY_ROBOT(MonteCarloLaw);
PARACAL_ON_HEXAPODS(MonteCarloLaw);

/// What is left behind compensation, or all of it where nothing is.
Characteristic left_of(const Robot& robot, Quantity quantity) {
  return {quantity, why_not_asked(robot, {quantity, true}).empty()};
}

/// At every pose and for every requirement, 3 sigma by the root of the sum of squares lies within the interval of the
/// drawn one about as often as stated.
TEST_P(MonteCarloLaw, AgreesWithTheRootOfTheSumOfSquares) {
  const std::vector<Pose> poses = workspace_poses(robot, 10);
  const std::vector<Requirement> requirements{
      {{Quantity::tilt}, 1e-3}, {{Quantity::position}, 5.0}, {left_of(robot, Quantity::distance), 0.3}};
  const LinearModel model(robot);
  int inside = 0, all = 0;
  for (std::uint64_t set = 0; set < 10; ++set) {
    Tolerances tolerances = random_tolerances(robot, set);
    tolerances.distribution = static_cast<Distribution>(set % 3);
    const MonteCarlo drawn =
        monte_carlo(robot, tolerances, requirements, poses, {.seed = set + 1, .sigma_error = 0.02});
    ASSERT_TRUE(drawn.converged);
    for (const RequirementStatistics& one : drawn.requirements) {
      const SigmaAtPose& worst = one.at_worst();
      const double sigma = sigma_of(
          squared_sensitivities(robot, model.rows(worst.pose, one.requirement.characteristic)), variances(tolerances));
      // The worst of the drawn poses is a little too large by selection: 3 half-widths instead of one.
      EXPECT_NEAR(worst.sigma, sigma, 1.5 * (worst.interval.high - worst.interval.low));
      for (const SigmaAtPose& at : one.poses) {
        const PerSource local = squared_sensitivities(robot, model.rows(at.pose, one.requirement.characteristic));
        const double expected = sigma_of(local, variances(tolerances));
        if (expected == 0.0) continue;  // the distance of home to itself
        inside += at.interval.contains(expected) ? 1 : 0;
        ++all;
      }
    }
  }
  EXPECT_GT(static_cast<double>(inside) / all, 0.90);
}

TEST_P(MonteCarloLaw, DoesNotDependOnThreads) {
  const std::vector<Requirement> requirements{{{Quantity::tilt}, 1e-3}, {left_of(robot, Quantity::position), 0.2}};
  for (const Model model : {Model::linear, Model::exact}) {
    const auto drawn = [&](unsigned threads) {
      return monte_carlo(robot, *robot.tolerances(), requirements, workspace_poses(robot, 40),
                         {.model = model, .sigma_error = 1e-9, .max_machines = 700, .threads = threads});
    };
    const MonteCarlo one = drawn(1), two = drawn(2);
    ASSERT_EQ(one.machines, 700U);
    EXPECT_EQ(one.passed, two.passed);
    for (std::size_t k = 0; k < requirements.size(); ++k) {
      EXPECT_EQ(one.requirements[k].largest.counts(), two.requirements[k].largest.counts());
      for (std::size_t p = 0; p < one.requirements[k].poses.size(); ++p) {
        EXPECT_EQ(one.requirements[k].poses[p].sigma, two.requirements[k].poses[p].sigma);
      }
    }
  }
}

/// Machine m is the machine that draw_errors() makes of stream m, whatever is left out because it moves nothing.
TEST_P(MonteCarloLaw, DrawsTheMachinesOfTheBatch) {
  const Tolerances& tolerances = *robot.tolerances();
  const Pose pose = workspace_poses(robot).back();
  const MonteCarlo drawn = monte_carlo(robot, tolerances, {{{Quantity::tilt}, 1e-3}}, {pose},
                                       {.seed = 5, .sigma_error = 1e-9, .max_machines = 50});
  const SourceRows rows = LinearModel(robot).rows(pose, {Quantity::tilt});
  Histogram expected;
  for (std::uint64_t m = 0; m < 50; ++m) {
    RandomStream random(5, m);
    const SourceErrors errors = draw_errors(robot, tolerances, random);
    Eigen::VectorXd tilt = Eigen::VectorXd::Zero(2);
    for (Eigen::Index column = 0; column < rows.cols(); ++column) {
      const Parameter& one = robot.parameters()[static_cast<std::size_t>(column)];
      tilt += rows.col(column) * errors(one.limb, one.source);
    }
    expected.add(tilt.norm());
  }
  EXPECT_EQ(drawn.requirements[0].largest.counts(), expected.counts());
}

/// A shift of the mean moves the capability, not sigma.
TEST_P(MonteCarloLaw, MeasuredPartsShiftTheMean) {
  Tolerances tolerances;
  const std::array<Source, 3> lengths{"rod_mean", "rod_length", "zero"};
  const Source rod = *std::ranges::find_if(lengths, [&](Source one) { return has(robot.actuator(), one); });
  tolerances.measured[rod] = {0.9, 1.0, 1.1};  // all rods too long: the plate goes down
  const Pose pose{robot.workspace().centre(), 0.0};
  const MonteCarlo drawn = monte_carlo(robot, tolerances, {{{Quantity::position}, 3.0}}, {pose}, {.sigma_error = 0.05});
  const RequirementStatistics& one = drawn.requirements.front();
  const SourceRows rows = LinearModel(robot).rows(pose, {Quantity::position});
  EXPECT_NEAR(one.at_worst().sigma, sigma_of(squared_sensitivities(robot, rows), variances(tolerances)),
              0.1 * one.at_worst().sigma);
  EXPECT_GT(one.at_worst().mean, 3.0 * one.at_worst().sigma);
  EXPECT_NEAR(one.cpk(), (3.0 - one.at_worst().mean) / (3.0 * one.at_worst().sigma), 1e-12);
}

TEST_P(MonteCarloLaw, ExactAndLinearAgreeAtTheTolerances) {
  const std::vector<Pose> poses = workspace_poses(robot, 20);
  const std::vector<LinearityPoint> points =
      linearity(robot, *robot.tolerances(), {Quantity::tilt}, poses, {0.01, 0.1, 1.0, 10.0}, 20);
  EXPECT_LT(points[0].difference, 1e-3);
  EXPECT_LT(points[2].difference, 0.05);
  for (std::size_t k = 1; k < points.size(); ++k) EXPECT_GT(points[k].difference, points[k - 1].difference);
  // The remainder is of second order.
  EXPECT_NEAR(points[1].difference / points[0].difference, 10.0, 1.0);
}

TEST(MonteCarlo, YieldGoesWithTheLimit) {
  const Robot robot = catalogue::huang2016();
  const std::vector<Pose> poses = workspace_poses(robot, 10);
  const auto yield = [&](double limit) {
    return monte_carlo(robot, *robot.tolerances(), {{{Quantity::tilt}, limit}}, poses, {.sigma_error = 0.05})
        .yield()
        .value;
  };
  EXPECT_EQ(yield(1.0), 1.0);
  EXPECT_EQ(yield(1e-9), 0.0);
  EXPECT_GT(yield(6e-4), yield(4e-4));
}

/// Machines that do not close have no error: mean square at a pose is that of the others, as their histogram has it.
TEST(MonteCarlo, SpreadIsThatOfMachinesThatClose) {
  const Robot robot = catalogue::huang2016();
  Tolerances tolerances = *robot.tolerances();
  for (double& half_width : tolerances.half_width) half_width *= 150.0;  // of which many machines do not close
  const MonteCarlo drawn =
      monte_carlo(robot, tolerances, {{{Quantity::position}, 1e3}}, {{robot.workspace().centre(), 0.0}},
                  {.model = Model::exact, .sigma_error = 1e-9, .max_machines = 2000});
  ASSERT_GT(drawn.not_closed, drawn.machines / 10);
  const RequirementStatistics& one = drawn.requirements[0];
  const double rms = std::hypot(one.largest.mean(), one.largest.std());
  EXPECT_NEAR(std::hypot(one.at_worst().mean, one.at_worst().sigma) / rms, 1.0, 0.01);
}

/// A long job takes its chunks as texts and adds them in their order: the same to the last bit. Some do not close.
TEST(MonteCarlo, IsTheSameAsALongJob) {
  const Robot robot = catalogue::huang2016();
  Tolerances tolerances = *robot.tolerances();
  for (double& half_width : tolerances.half_width) half_width *= 100.0;
  const std::vector<Requirement> requirements{{{Quantity::tilt}, 0.3}, {{Quantity::position}, 1e3}};
  const MonteCarloOptions options{.model = Model::exact, .sigma_error = 1e-9, .max_machines = 1500};
  const std::vector<Pose> poses = workspace_poses(robot, 40);
  JobInMemory job;
  const MonteCarlo here = monte_carlo(robot, tolerances, requirements, poses, options);
  const MonteCarlo there = monte_carlo(robot, tolerances, requirements, poses, options, {}, &job);
  ASSERT_GT(here.not_closed, 0U);
  ASSERT_GT(here.passed, 0U);
  EXPECT_EQ(here.machines, there.machines);
  EXPECT_EQ(here.not_closed, there.not_closed);
  EXPECT_EQ(here.passed, there.passed);
  for (std::size_t k = 0; k < requirements.size(); ++k) {
    const RequirementStatistics &one = here.requirements[k], &other = there.requirements[k];
    EXPECT_EQ(one.passed, other.passed);
    EXPECT_EQ(one.largest.counts(), other.largest.counts());
    for (std::size_t pose = 0; pose < poses.size(); ++pose) {
      EXPECT_EQ(one.poses[pose].sigma, other.poses[pose].sigma);
      EXPECT_EQ(one.poses[pose].mean, other.poses[pose].mean);
      EXPECT_EQ(one.poses[pose].interval.high, other.poses[pose].interval.high);
    }
  }
}

TEST(MonteCarlo, StopsWhenAskedAndSaysSo) {
  const Robot robot = catalogue::huang2016();
  const MonteCarlo drawn =
      monte_carlo(robot, *robot.tolerances(), {{{Quantity::tilt}, 1e-3}}, workspace_poses(robot, 40),
                  {.sigma_error = 1e-4}, [](std::uint64_t, std::uint64_t) { return false; });
  EXPECT_FALSE(drawn.converged);
  EXPECT_EQ(drawn.machines, 1024U);
  EXPECT_THROW((void)monte_carlo(robot, {}, {}, {}), InvalidArgument);
}

/// What is normal and has one component: its sample variance scatters by sigma^2 sqrt(2 / n), so a 90 % interval holds
/// sigma in 90 % of the batches, and has that width.
TEST(MonteCarlo, IntervalOfANormalSpreadCovers) {
  const Robot robot = catalogue::huang2016();
  const std::vector<Pose> pose{{Workspace::on_circle(400.0, 0.3, -900.0), 0.0}};
  const Characteristic what{Quantity::rotation};
  const double sigma =
      sigma_of(squared_sensitivities(robot, LinearModel(robot).rows(pose[0], what)), variances(*robot.tolerances()));
  constexpr int kBatches = 400;
  int inside = 0;
  for (int batch = 0; batch < kBatches; ++batch) {
    const MonteCarlo drawn = monte_carlo(
        robot, *robot.tolerances(), {{what, 1.0}}, pose,
        {.model = Model::linear, .seed = static_cast<std::uint64_t>(batch), .sigma_error = 1.0, .confidence = 0.9});
    const Interval interval = drawn.requirements[0].poses[0].interval;
    inside += interval.contains(sigma) ? 1 : 0;
    const double relative = 1.6449 * std::sqrt(2.0 / static_cast<double>(drawn.machines));
    EXPECT_NEAR((interval.high - interval.low) / sigma / relative, 1.0, 0.25);
  }
  EXPECT_TRUE(proportion_interval(static_cast<std::uint64_t>(inside), kBatches, 0.999).contains(0.9)) << inside;
}

/// A sum of normal sources: a mean far away makes the length one, its indices are exactly the contributors' shares, and
/// 90 % intervals hold them in 90 % of all seeds.
TEST(Sobol, IntervalsOfALinearFunctionCover) {
  const Robot robot = catalogue::huang2016();
  Tolerances tolerances;
  tolerances["arm_length"] = 0.3;
  tolerances["e_x"] = 0.3;
  tolerances["e_z"] = 0.2;
  tolerances.measured["rod_mean"] = {99.999, 100.0, 100.001};
  const Pose pose{Workspace::on_circle(400.0, 0.3, -1000.0), 0.0};
  const Characteristic what{Quantity::distance};
  const std::vector<Contributor> shares = contributors(robot, LinearModel(robot).rows(pose, what), tolerances);
  constexpr int kSeeds = 150;
  std::uint64_t inside = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    for (const SobolIndex& one :
         sobol_indices(robot, tolerances, what, pose,
                       {.model = Model::linear, .seed = seed, .samples = 512, .confidence = 0.9, .threads = 1})) {
      const double exact = std::ranges::find(shares, one.source, &Contributor::source)->share;
      if (exact < 0.02) continue;
      inside += (one.first_interval.contains(exact) ? 1U : 0U) + (one.total_interval.contains(exact) ? 1U : 0U);
      all += 2;
    }
  }
  EXPECT_GT(all, 500U);
  EXPECT_NEAR(static_cast<double>(inside) / static_cast<double>(all), 0.9, 0.03);
}

/// Of a sum (a large mean makes the length one) the indices are the contributors' shares.
TEST(Sobol, AreTheSharesOfALinearFunction) {
  const Robot robot = catalogue::huang2016();
  Tolerances tolerances;
  tolerances.measured["rod_mean"] = {0.8, 0.9, 1.0, 1.1, 1.2};
  tolerances.measured["arm_length"] = {0.95, 1.0, 1.05};
  tolerances.measured["e_z"] = {-0.05, 0.05};
  const Pose pose{robot.workspace().centre(), 0.0};
  const Characteristic what{Quantity::position};
  const std::vector<Contributor> shares = contributors(robot, LinearModel(robot).rows(pose, what), tolerances);
  const std::vector<SobolIndex> indices =
      sobol_indices(robot, tolerances, what, pose, {.model = Model::linear, .samples = 8192, .confidence = 0.999});
  ASSERT_EQ(indices.size(), 3U);
  for (const SobolIndex& one : indices) {
    const auto share = std::ranges::find(shares, one.source, &Contributor::source);
    // Limbs pull sideways, too: a few percent of the variance are no sum.
    EXPECT_NEAR(one.first, share->share, 0.06) << name(one.source);
    EXPECT_NEAR(one.total, share->share, 0.06) << name(one.source);
  }
}

/// The length of the tilt has no main effects to speak of (its components change sign), but every source matters.
TEST(Sobol, SeeInteractions) {
  const Robot robot = catalogue::huang2016();
  Tolerances only = *robot.tolerances();
  for (const Source source : all_sources()) {
    if (!tilts_plate(source)) only[source] = 0.0;
  }
  const Pose pose{robot.workspace().centre(), 0.0};
  const SobolOptions options{.model = Model::linear, .samples = 4096, .confidence = 0.999, .threads = 1};
  const std::vector<SobolIndex> linear = sobol_indices(robot, only, {Quantity::tilt}, pose, options);
  SobolOptions two = options;
  two.threads = 2;
  const std::vector<SobolIndex> again = sobol_indices(robot, only, {Quantity::tilt}, pose, two);
  double first = 0.0, total = 0.0;
  for (std::size_t k = 0; k < linear.size(); ++k) {
    EXPECT_EQ(linear[k].total, again[k].total);
    EXPECT_LE(linear[k].first_interval.low, linear[k].total_interval.high);
    first += linear[k].first;
    total += linear[k].total;
  }
  EXPECT_LT(first, 1.0);
  EXPECT_GT(total, 1.0);
  only.half_width.values.fill(0.0);
  only["alpha2"] = 1e-3;
  const std::vector<SobolIndex> alone = sobol_indices(robot, only, {Quantity::tilt}, pose, options);
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_NEAR(alone[0].first, 1.0, 1e-9);
  EXPECT_NEAR(alone[0].total, 1.0, 0.05);
}

}  // namespace
}  // namespace paracal::monte_carlo_test
