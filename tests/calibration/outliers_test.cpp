// Readings that contradict the others: against what leaving them out does, and what is said of them.

#include "calibration/fit/outliers.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "calibration/fit/sought.hpp"
#include "calibration/fit/stage_fit.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::outliers_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr double kNoise = 0.017;  // mm

class Outliers : public testing::Test {
 protected:
  Robot robot = catalogue::rotary_delta();
  std::vector<Station> stations = fine_stations(robot, 9);
  Measurements measured = measured_machine(robot, stations, 3, {.noise = kNoise}).measurements;
  std::vector<PointReading>& readings() { return measured.series[0].readings; }

  Calibration calibration() const {
    return calibrate(robot, measured, {.stage = Stage::fine, .states_use = false, .diagnose = false});
  }
};

/// F of a reading against the rest, from two fits: with it and without.
TEST_F(Outliers, StatisticIsTheDropOfLeavingItOut) {
  readings()[7].point.y() += 8.0 * kNoise;
  state_sigma(measured, kNoise);
  const CalibrationOptions options;
  detail::StageFit all(robot, measured, options, detail::all_with_priors(robot, options), {});
  all.solve();
  for (const detail::Contradiction& one : all.suspects()) {
    detail::StageFit without = all;
    without.observation_to_change().groups()[one.group].active = false;
    without.solve();
    const double drop = all.fit().at_answer.squared_residuals() - without.fit().at_answer.squared_residuals();
    const detail::Scatter rest = without.scatter();
    const double statistic = drop / 3.0 / (rest.sum / rest.redundancy);
    EXPECT_NEAR(one.statistic, statistic, 0.01 * statistic + 0.01) << one.group;
    EXPECT_NEAR(one.freedom, rest.redundancy, 0.01 * rest.redundancy) << one.group;
  }
  EXPECT_EQ(all.suspects().front().group, 7u);
}

/// Ten points of a sound machine, each read once: errors under their priors take up most of what they scatter. A
/// reading that chance explains is never left out, whether the noise is stated or not: of 100 machines at most one is,
/// and twelve have a reading of each pose in turn where one that judges by its residual alone leaves several out.
TEST_F(Outliers, OfFewSoundReadingsThereAreNone) {
  constexpr int kPoses = 10;
  const std::vector<Station> many = select_stations(robot, candidate_stations(robot, 200, 1), {.poses = 20}).stations;
  int left_out = 0;
  for (int number = 0; number < machines({.claim = 100, .quick = 12}); ++number) {
    std::vector<Station> some(many.begin() + number % kPoses, many.begin() + number % kPoses + kPoses);
    measured = measured_machine(robot, some, number, {.noise = kNoise}).measurements;
    if (number % 2 == 0) state_sigma(measured, kNoise);
    for (const Suspect& one : calibration().suspects) {
      EXPECT_TRUE(!one.excluded || one.chance < CalibrationOptions().outlier_chance) << number;
      left_out += one.excluded;
    }
  }
  EXPECT_LE(left_out, 1);
}

/// Once a gross reading is left out, nothing else is wrong, and nothing else is said; once or thrice read, the noise
/// stated or not, which six machines have all of.
TEST_F(Outliers, ThatAreLeftOutLeaveNoOtherNote) {
  for (int number = 0; number < machines({.claim = 12, .quick = 6}); ++number) {
    measured =
        measured_machine(robot, stations, number, {.noise = kNoise, .repeats = 1 + 2 * (number % 2)}).measurements;
    readings()[static_cast<std::size_t>(number) % readings().size()].point.x() += 5.0;
    if (number % 3 != 0) state_sigma(measured, kNoise);
    const Calibration found = calibration();
    EXPECT_THAT(found.notes, testing::ElementsAre(testing::StartsWith("outlier excluded"))) << number;
    EXPECT_TRUE(found.components.empty()) << number;
  }
}

/// The six unknowns of its frame take half of a series of four: its residuals are smaller, its sizes are not.
TEST_F(Outliers, SizesDoNotDependOnLeverage) {
  double few = 0.0, many = 0.0;
  for (int number = 0; number < 20; ++number) {
    Measurements two = measure(robot, {}, stations, number, {.noise = kNoise});
    const Measurements second = measure(robot, {}, stations, 100 + number, {.noise = kNoise});
    two.series.push_back({"second", {}});
    for (const std::size_t k : {1u, 4u, 7u, 14u}) two.series[1].readings.push_back(second.series[0].readings[k]);
    const CalibrationOptions options;
    detail::StageFit fit(robot, two, options, detail::encoder_offsets(robot, options), {});
    fit.solve();
    const std::vector<double> sizes = detail::studentised(fit.observation(), fit.fit().parameters, fit.covariance());
    for (std::size_t g = 0; g < sizes.size(); ++g) {
      (fit.observation().groups()[g].series == 1 ? few : many) += sizes[g] * sizes[g];
    }
  }
  EXPECT_NEAR((few / 4.0) / (many / static_cast<double>(stations.size())), 1.0, 0.3);  // 240 rows know it to 0.1
}

/// Tables of the normal distribution and of chi-square with three degrees of freedom.
TEST(SizeByChance, IsAQuantileOverTheMedian) {
  EXPECT_NEAR(detail::size_by_chance(1.0, 0.0455003), 2.0 / 0.6744898, 1e-5);
  EXPECT_NEAR(detail::size_by_chance(3.0, 0.01), std::sqrt(11.344867 / 2.365974), 1e-6);
}

/// Of 435 good distances one in a hundred sets has one beyond 6.3 medians (4.2 standard deviations), and 190 are few.
TEST_F(Outliers, AReadingStandsOutByHowManyThereAre) {
  const CalibrationOptions options;
  const auto stands_out = [&](std::size_t poses, double size) {
    Measurements read{.stations = stations};
    for (std::size_t to = 0; to < poses; ++to) {
      for (std::size_t from = 0; from < to; ++from) read.distances.push_back({.from = from, .to = to, .distance = 1.0});
    }
    const detail::Observation observation(robot, read, options, detail::encoder_offsets(robot, options));
    std::vector<double> sizes(read.distances.size(), 1.0);
    sizes[7] = size;
    return detail::one_stands_out(observation, sizes);
  };
  stations.resize(30, stations.back());
  EXPECT_FALSE(stands_out(20, 3.4));
  EXPECT_TRUE(stands_out(20, 3.6));
  EXPECT_FALSE(stands_out(30, 6.2));
  EXPECT_TRUE(stands_out(30, 6.4));
}

/// Three numbers for the lever of a second reflector that was read once: nothing is left to check them with.
TEST_F(Outliers, WhatCannotBeCheckedIsNoSuspect) {
  measured = measured_machine(robot, stations, 3, {.noise = kNoise, .second = Eigen::Vector3d(60.0, -20.0, -150.0)})
                 .measurements;
  for (std::size_t k = 0; k < readings().size(); ++k) {
    if (k != 5) readings()[k].second.reset();
  }
  for (const Suspect& one : calibration().suspects) EXPECT_GT(one.chance, 1e-3) << one.text;
}

/// A gross reading among good ones is ignored after a few rounds, and further ones change nothing.
TEST_F(Outliers, RoundsOfTheRobustLossEndWhereTheySettle) {
  readings()[7].point.y() += 50.0 * kNoise;
  const CalibrationOptions options;
  detail::StageFit fit(robot, measured, options, detail::all_with_priors(robot, options), {});
  fit.settle();
  fit.exclude_outliers(options.outlier_chance);
  EXPECT_GT(fit.robust_rounds(), 2);
  EXPECT_LT(fit.robust_rounds(), 15);
  EXPECT_FALSE(fit.observation().groups()[7].active);
}

TEST_F(Outliers, RepeatsAreTold) {
  measured = measured_machine(robot, stations, 3, {.noise = kNoise, .repeats = 2}).measurements;
  for (std::size_t k = 0, seen = 0; k < readings().size(); ++k) {
    if (readings()[k].station == 3 && ++seen == 2) readings()[k].point += Eigen::Vector3d(0.6, -0.64, 0.48);
  }
  EXPECT_THAT(calibration().notes,
              Contains(HasSubstr("outlier excluded: P3 of " + measured.series[0].name + ", repeat 2")));
}

TEST_F(Outliers, WhereAReadingWasTakenIsToldWhenItWasThere) {
  const Eigen::Vector3d there = readings()[11].point;
  readings()[4].point = there;
  EXPECT_THAT(calibration().notes,
              Contains(testing::AllOf(HasSubstr("outlier excluded: P4"), HasSubstr("it was taken at P11"))));
  readings()[4].point = there + Eigen::Vector3d(0.0, 20.0, 0.0);  // near no station
  EXPECT_THAT(calibration().notes, Contains(HasSubstr("outlier excluded: P4")));
  EXPECT_THAT(calibration().notes, Not(Contains(HasSubstr("taken at"))));
}

/// The paper's method takes its readings as they are.
TEST_F(Outliers, ThePapersMethodHasNoSuspects) {
  EXPECT_TRUE(calibrate(robot, measured, {.method = Method::paper, .states_use = false}).suspects.empty());
}

/// Eq. (19) knows no rotations.
TEST(PapersMethod, ReadsNoRotations) {
  const Robot robot = catalogue::huang2016();
  const MeasuredMachine machine = measured_machine(robot, fine_stations(robot, 4), 3, {.noise = kNoise});
  const auto offsets = [&](double rotation) {
    Measurements read{.stations = machine.measurements.stations,
                      .distances = all_distances(machine.measurements.series[0])};
    for (DistanceReading& one : read.distances) one.rotation = rotation;
    return calibrate(robot, read, {.method = Method::paper, .stage = Stage::rough, .states_use = false}).errors();
  };
  for (std::size_t limb = 0; limb < 4; ++limb) {
    EXPECT_EQ(offsets(0.0)(limb, "theta_offset"), offsets(0.1)(limb, "theta_offset"));
  }
}

/// 27 errors want 34 numbers. Twelve points are worth 30, whether they come as points in a frame of their own or as 66
/// distances; ninety of seven poses leave more open than motions.
TEST(AutomaticStage, CountsWhatReadingsAreWorth) {
  const Robot robot = catalogue::huang2016();
  const auto goes_fine = [&](const Measurements& read) {
    const CalibrationOptions options{.noise = {.distance_bias = 0.0}, .states_use = false, .diagnose = false};
    return calibrate(robot, read, options).stages.back().name == "fine";
  };
  std::vector<Station> stations = fine_stations(robot, 9);
  stations.erase(stations.begin() + 3, stations.begin() + 10);
  ASSERT_EQ(stations.size(), 12u);
  const auto points = [&](const std::vector<Station>& at, int repeats) {
    return measured_machine(robot, at, 3, {.noise = kNoise, .repeats = repeats}).measurements;
  };
  EXPECT_FALSE(goes_fine(points(stations, 1)));
  EXPECT_FALSE(goes_fine({.stations = stations, .distances = all_distances(points(stations, 1).series[0])}));
  EXPECT_TRUE(goes_fine(points(fine_stations(robot, 9), 1)));
  EXPECT_FALSE(goes_fine(points(rough_stations(robot, 6), 13)));
}

/// To heights offsets alone are hardly more than the height and the tilt of their plane.
TEST(AutomaticStage, HeightsSkipTheRoughOne) {
  const Robot robot = catalogue::rotary_delta();
  Measurements heights{.stations = fine_stations(robot, 9), .lengths = {{"bed"}}};
  for (std::size_t k = 0; k < heights.stations.size(); ++k) {
    heights.lengths[0].readings.push_back({.station = k, .length = heights.stations[k].commanded.position.z()});
  }
  const Calibration found = calibrate(robot, heights, {.stage = Stage::fine, .states_use = false, .diagnose = false});
  ASSERT_EQ(found.stages.size(), 1u);
  EXPECT_EQ(found.stages.front().name, "fine");
}

}  // namespace
}  // namespace paracal::test::outliers_test
