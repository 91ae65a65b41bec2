// What wider priors promise before they are tried, against what comes when they are.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "calibration/fit/sought.hpp"
#include "calibration/plan/prior_promise.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/simulation.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::prior_promise_test {
namespace {

constexpr double kNoise = 0.017;  // mm

class Promise : public testing::Test {
 protected:
  /// One rod is that much too long; noise that is stated or not.
  detail::StageFit fit(double too_long, bool stated) {
    MeasuredMachine machine = measured_machine(robot, stations, 5, {});
    machine.errors(1, "rod_mean") += too_long;
    measured = measure(robot, machine.errors, stations, 5, {.noise = kNoise});
    if (stated) state_sigma(measured, kNoise);
    detail::StageFit stage(robot, measured, options, detail::all_with_priors(robot, options), {});
    stage.settle();
    return stage;
  }
  /// That of limb 2, and of all limbs.
  static std::vector<std::size_t> rods(const detail::StageFit& stage, bool all) {
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < stage.observation().sought().size(); ++k) {
      const SoughtSource& one = stage.observation().sought()[k];
      if (one.source == "rod_mean" && (all || one.limb == 1)) places.push_back(k);
    }
    return places;
  }
  static std::vector<std::size_t> of_all(const detail::StageFit& stage) {
    std::vector<std::size_t> places(stage.observation().sought().size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    return places;
  }
  static double drop_of(detail::StageFit& stage, const std::vector<std::size_t>& places, double start) {
    const double before = stage.minus_twice_log_likelihood();
    stage.seek_wider_priors(places, start);
    stage.settle();
    return before - stage.minus_twice_log_likelihood();
  }

  Robot robot = catalogue::rotary_delta();
  std::vector<Station> stations =
      select_stations(robot, candidate_stations(robot, 200, 1), {.poses = 20, .largest_sweeps = 1}).stations;
  CalibrationOptions options;
  Measurements measured;  ///< which a fit reads as long as it lives
};

/// What is promised is what comes, to a hundredth, as long as the part bends little.
TEST_F(Promise, IsKept) {
  for (const bool stated : {true, false}) {
    detail::StageFit stage = fit(5.0, stated);
    for (const std::vector<std::size_t>& places : {rods(stage, false), rods(stage, true), of_all(stage)}) {
      detail::StageFit wider = stage;
      const detail::PriorPromise::Drop promised = detail::PriorPromise(stage).of(places);
      const double drop = drop_of(wider, places, promised.factor);
      EXPECT_GT(drop, 20.0);
      EXPECT_NEAR(promised.drop, drop, 0.01 * drop) << stated << places.size();
      EXPECT_NEAR(std::log(promised.factor), std::log(wider.components().priors.front().factor), 0.1) << places.size();
    }
  }
}

/// What a part bends that is farther off is taken for noise, 40 mm for some 10 mm of it. The promise is of noise that
/// is sought anew: at least half of what comes.
TEST_F(Promise, IsKeptWhereThePartWasTakenForNoise) {
  detail::StageFit stage = fit(40.0, false);
  ASSERT_GT(reading_noise(stage.observation()), 50.0 * kNoise);
  const std::vector<std::size_t> places = rods(stage, false);
  const detail::PriorPromise::Drop promised = detail::PriorPromise(stage).of(places);
  const double drop = drop_of(stage, places, promised.factor);
  EXPECT_GT(promised.drop, 0.5 * drop);
  EXPECT_LT(promised.drop, 1.01 * drop);
  EXPECT_NEAR(reading_noise(stage.observation()), kNoise, 0.3 * kNoise);
}

TEST_F(Promise, IsNothingWhereNothingIsWrong) {
  for (const bool stated : {true, false}) {
    const detail::StageFit stage = fit(0.0, stated);
    EXPECT_LT(detail::PriorPromise(stage).of(rods(stage, false)).drop, 2.0);
    EXPECT_LT(detail::PriorPromise(stage).of(rods(stage, true)).drop, 2.0);
  }
}

/// Rods of one lot: what all limbs share correlates their priors, and is widened with them.
TEST_F(Promise, IsKeptOfErrorsThatAllLimbsShare) {
  CommonError lot{.text = "lot of rods", .direction = {}, .std = 2.0};
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) lot.direction(limb, "rod_mean") = 1.0;
  options.common = {lot};
  detail::StageFit stage = fit(5.0, true);
  for (const std::vector<std::size_t>& places : {rods(stage, true), of_all(stage)}) {
    detail::StageFit wider = stage;
    const detail::PriorPromise::Drop promised = detail::PriorPromise(stage).of(places);
    const double drop = drop_of(wider, places, promised.factor);
    EXPECT_NEAR(promised.drop, drop, 0.02 * std::abs(drop) + 0.1) << places.size();
  }
}

/// Few poses, whose coordinates errors can take up: then nothing tells the noise, and less of it is no promise. Nor is
/// what an iteration leaves of errors that no reading shows.
TEST_F(Promise, IsNothingWhereErrorsTakeUpTheReadings) {
  for (const Robot& one : {catalogue::huang2016(), catalogue::linear_delta()}) {
    robot = one;
    for (const int poses : {7, 9, 12, 15}) {
      stations =
          select_stations(robot, candidate_stations(robot, 200, 1), {.poses = poses, .largest_sweeps = 1}).stations;
      for (const bool generous : {false, true}) {
        options.tolerances = generous ? std::optional(generous_tolerances(robot.geometry())) : std::nullopt;
        const detail::StageFit stage = fit(0.0, false);
        EXPECT_LT(detail::PriorPromise(stage).of(of_all(stage)).drop, 10.0) << robot.name() << poses << generous;
      }
    }
  }
}

/// As many heights as a printer's owner probes, and a few distances.
TEST_F(Promise, IsNothingWhereErrorsTakeUpHeights) {
  robot = catalogue::linear_delta();
  for (int number = 0; number < 6; ++number) {
    const int heights = 10 + number;
    Measurements plan{.stations =
                          select_stations(robot, candidate_stations(robot, 200, 1), {.poses = heights}).stations};
    plan.lengths = {{"bed", LengthKind::height, {}}};
    for (std::size_t k = 0; k < plan.stations.size(); ++k) plan.lengths[0].readings.push_back({.station = k});
    for (std::size_t k = 1; k < 7; ++k) plan.distances.push_back({.from = 0, .to = k});
    RandomStream random(7, static_cast<std::uint64_t>(number));
    const SourceErrors truth = measured_machine(robot, plan.stations, number, {}).errors;
    measured = simulate(robot, truth, plan, {.noise = 0.1}, random);
    detail::StageFit stage(robot, measured, options, detail::all_with_priors(robot, options), {});
    stage.settle();
    EXPECT_LT(detail::PriorPromise(stage).of(of_all(stage)).drop, 10.0) << number;
  }
}

/// What is asked for at least spares work, and changes no promise that reaches it.
TEST_F(Promise, IsTheSameWhereLessIsNotLookedFor) {
  for (const double too_long : {0.0, 1.0, 5.0, 40.0}) {
    const detail::StageFit stage = fit(too_long, false);
    const detail::PriorPromise promise(stage);
    std::vector<std::vector<std::size_t>> sets{rods(stage, false), rods(stage, true), of_all(stage)};
    for (const std::size_t place : of_all(stage)) sets.push_back({place});
    for (const std::vector<std::size_t>& places : sets) {
      const detail::PriorPromise::Drop all = promise.of(places);
      const detail::PriorPromise::Drop reached = promise.of(places, all.drop);
      EXPECT_EQ(reached.drop, all.drop) << too_long << places.size();
      EXPECT_EQ(reached.factor, all.factor) << too_long << places.size();
      EXPECT_LT(promise.of(places, all.drop + 1e-3).drop, all.drop + 1e-3);
    }
  }
}

/// Errors that are a tenth of their tolerances: priors do not shrink to that, for by chance half the machines are
/// better than their tolerances.
TEST_F(Promise, OfNarrowerPriorsIsNone) {
  detail::StageFit stage = fit(0.0, true);
  detail::StageFit generous = stage;
  std::vector<std::size_t> places = of_all(stage);
  EXPECT_LE(drop_of(generous, places, 10.0), 1e-9);
  EXPECT_GE(generous.components().priors.front().factor, 1.0);
}

/// A candidate that is dropped leaves nothing behind, not in the last digit.
TEST_F(Promise, LeavesPriorsAsTheyWere) {
  detail::StageFit stage = fit(0.0, true);
  const detail::StageFit::State before = stage.state();
  const Eigen::MatrixXd priors = stage.observation().prior_covariance();
  stage.seek_wider_priors(rods(stage, true), 3.0);
  stage.seek_wider_priors(of_all(stage), 7.0);
  EXPECT_NE(stage.observation().prior_covariance(), priors);
  stage.restore(before);
  EXPECT_EQ(stage.observation().prior_covariance(), priors);
}

}  // namespace
}  // namespace paracal::test::prior_promise_test
