// What wider priors promise before they are tried, against what comes when they are.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "calibration/prior_promise.hpp"
#include "calibration/sought.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test {
namespace {

constexpr double kNoise = 0.017;  // mm

class Promise : public testing::Test {
 protected:
  /// One rod is that much too long; noise that is stated or not.
  detail::StageFit fit(double too_long, bool stated) {
    MeasuredMachine machine = measured_machine(robot, stations, 5, {});
    machine.errors(1, Source::rod_mean) += too_long;
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
      if (one.source == Source::rod_mean && (all || one.limb == 1)) places.push_back(k);
    }
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
    std::vector<std::size_t> all(stage.observation().sought().size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (const std::vector<std::size_t>& places : {rods(stage, false), rods(stage, true), all}) {
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

}  // namespace
}  // namespace paracal::test
