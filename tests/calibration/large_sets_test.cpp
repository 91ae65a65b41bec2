// What a fit does otherwise where readings are very many: kept, looked at or listed less, the numbers the same.

#include <gmock/gmock.h>

#include <algorithm>

#include "calibration/fit/sought.hpp"
#include "calibration/fit/stage_fit.hpp"
#include "observation_derivatives.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::large_sets_test {
namespace {

constexpr double kNoise = 0.017;  // mm

class LargeSets : public testing::Test {
 protected:
  Robot robot = catalogue::rotary_delta();
  CalibrationOptions options;

  detail::StageFit settled(const Measurements& measured) const {
    detail::StageFit stage(robot, measured, options, detail::all_with_priors(robot, options), {});
    stage.settle();
    return stage;
  }
};

/// The first readings of 5001 stations give the rows that they give alone.
TEST_F(LargeSets, DerivativesThatAreNotKeptAreTheSame) {
  const Measurements few = measured_machine(robot, fine_stations(robot, 9), 3, {.noise = kNoise}).measurements;
  Measurements many = few;
  many.stations.resize(5001, few.stations.back());
  const std::vector<SoughtSource> sought = detail::all_with_priors(robot, options);
  detail::Observation kept(robot, few, options, sought), anew(robot, many, options, sought);
  const Eigen::VectorXd at = kept.start({}).value();
  ASSERT_EQ(anew.start({}).value(), at);
  EXPECT_TRUE(kept.stations(at)->front().motions.has_value());
  EXPECT_FALSE(anew.stations(at)->front().motions.has_value());
  EXPECT_EQ(rows_of(anew, at), rows_of(kept, at));
}

/// Of readings of one noise, stated or not, from the root alone; of both kinds by looking at every one.
TEST_F(LargeSets, ScatterAtTheAnswerIsThatOfTheRows) {
  const std::vector<Station> stations = fine_stations(robot, 9);
  Measurements measured = measured_machine(robot, stations, 3, {.noise = 3.0 * kNoise}).measurements;
  const auto expect_that_of_rows = [&](const detail::StageFit& stage) {
    const Eigen::MatrixXd root = stage.fit().at_answer.root();
    const detail::Scatter rows =
        detail::scatter(stage.observation(), stage.fit().parameters, root, [](const auto&) { return true; });
    EXPECT_NEAR(stage.scatter().sum / rows.sum, 1.0, 1e-10);
    EXPECT_NEAR(stage.scatter().redundancy / rows.redundancy, 1.0, 1e-10);
  };
  expect_that_of_rows(settled(measured));
  for (std::size_t k = 0; k < 20; ++k) measured.series[0].readings[k].sigma = kNoise;
  expect_that_of_rows(settled(measured));
  state_sigma(measured, kNoise);
  expect_that_of_rows(settled(measured));
  detail::StageFit louder = settled(measured);
  louder.observation_to_change().let_noise_be(2.0);
  expect_that_of_rows(louder);
}

/// What is asked of a fit twice is found once, and found anew when the fit changes.
TEST_F(LargeSets, SuspectsAreThoseOfTheFitAsItStands) {
  const Measurements measured = measured_machine(robot, fine_stations(robot, 9), 3, {.noise = kNoise}).measurements;
  detail::StageFit stage = settled(measured);
  const auto worst = stage.suspects().front();
  EXPECT_EQ(&stage.suspects().front(), &stage.suspects().front());
  stage.observation_to_change().groups()[worst.group].active = false;
  stage.settle();
  const auto found = std::ranges::find(stage.suspects(), worst.group, &detail::Contradiction::group);
  ASSERT_NE(found, stage.suspects().end());
  EXPECT_NE(found->statistic, worst.statistic);
}

/// More than 20,000: 19 stations, visited 1053 times. One is read 2 mm off.
TEST_F(LargeSets, OfManyReadingsTheWorstAreListed) {
  Measurements read =
      measured_machine(robot, fine_stations(robot, 9), 3, {.noise = kNoise, .repeats = 1053}).measurements;
  state_sigma(read, kNoise);
  read.series[0].readings[4711].point.x() += 2.0;
  const Calibration found = calibrate(robot, read, {.states_use = false, .diagnose = false});
  EXPECT_EQ(found.readings, 20007U);
  EXPECT_TRUE(found.points.empty());
  ASSERT_EQ(found.suspects.size(), 100U);
  EXPECT_TRUE(found.suspects.front().excluded);
  EXPECT_EQ(std::ranges::count(found.suspects, true, &Suspect::excluded), 1);
  EXPECT_TRUE(std::ranges::is_sorted(found.suspects, std::greater{}, &Suspect::statistic));
}

}  // namespace
}  // namespace paracal::test::large_sets_test
