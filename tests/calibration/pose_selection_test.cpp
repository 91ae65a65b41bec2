#include "paracal/calibration/pose_selection.hpp"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <cstdint>
#include <set>

#include "calibration/fit/observation.hpp"
#include "calibration/fit/sought.hpp"
#include "calibration/plan/pose_exchange.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "support/robots.hpp"

namespace paracal::pose_selection_test {
namespace {

/// Uncertainty of a set of poses by another way: the posterior of the whole plan at once.
WorkspaceUncertainty afresh(const Robot& robot, const std::vector<Station>& stations,
                            Measurand measurand = Measurand::coordinates) {
  const KnownErrors after = promised(robot, planned(robot, stations, {.measurand = measurand}));
  return PoseSpread(robot, {}, after.parameters, workspace_stations(robot)).uncertainty(after.covariance);
}

class PoseSelectionLaw : public test::EveryRobot {
 protected:
  std::vector<Station> candidates = candidate_stations(robot, 200, 1);
};

TEST_P(PoseSelectionLaw, UpdatedCovarianceIsThatOfThePlan) {
  const Selection selection = select_stations(robot, candidates, {.poses = 15});
  const WorkspaceUncertainty again = afresh(robot, selection.stations);
  EXPECT_NEAR(selection.uncertainty.max_distance / again.max_distance, 1.0, 1e-3);
  EXPECT_NEAR(selection.uncertainty.rms_aligned / again.rms_aligned, 1.0, 1e-3);
}

/// The same of other readings, whose set-up has other unknowns or none.
TEST_P(PoseSelectionLaw, IsOfWhatIsMeasured) {
  std::vector<Station> chosen;
  for (const Measurand measurand : {Measurand::lengths, Measurand::home_distances}) {
    const Selection selection = select_stations(robot, candidates, {.poses = 15, .readings = {.measurand = measurand}});
    const WorkspaceUncertainty again = afresh(robot, selection.stations, measurand);
    EXPECT_NEAR(selection.uncertainty.max_distance / again.max_distance, 1.0, 1e-3);
    EXPECT_NEAR(selection.uncertainty.rms_aligned / again.rms_aligned, 1.0, 1e-3);
    const std::vector<Station> first(candidates.begin(), candidates.begin() + 15);
    EXPECT_LT(again.rms_aligned, afresh(robot, first, measurand).rms_aligned);
  }
  EXPECT_THROW((void)select_stations(robot, candidates, {.readings = {.measurand = Measurand::distances}}),
               InvalidArgument);
}

/// No single exchange with any candidate may be better, judged afresh.
TEST_P(PoseSelectionLaw, NoExchangeHelpsAnyMore) {
  const std::vector<Station> few(candidates.begin(), candidates.begin() + 40);
  const Selection selection = select_stations(robot, few, {.poses = 14});
  const double lever = robot.slide() ? robot.slide()->pinion_radius : 0.0;
  const auto cost = [&](const std::vector<Station>& stations) {
    const KnownErrors after = promised(robot, planned(robot, stations));
    const PoseSpread spread(robot, {}, after.parameters, workspace_stations(robot));
    return spread.mean_square(lever).cwiseProduct(after.covariance).sum();
  };
  const double chosen = cost(selection.stations);
  EXPECT_NEAR(selection.criterion / chosen, 1.0, 5e-3);  // the selection knows the frame to 1 mm beforehand
  for (std::size_t place = 1; place < selection.stations.size(); place += 4) {
    for (std::size_t k = 1; k < few.size(); k += 3) {
      std::vector<Station> exchanged = selection.stations;
      exchanged[place] = few[k];
      EXPECT_GT(cost(exchanged), chosen * (1.0 - 2 * 5e-3));  // both are that uncertain
    }
  }
}

TEST_P(PoseSelectionLaw, BeatsTheEvenlySpacedScheme) {
  const std::vector<Station> paper = fine_stations(robot, 9);
  const Selection selection = select_stations(robot, candidates, {.poses = static_cast<int>(paper.size())});
  EXPECT_LT(selection.uncertainty.rms_aligned, afresh(robot, paper).rms_aligned);
  EXPECT_LT(selection.uncertainty.max_distance, afresh(robot, paper).max_distance);
}

TEST_P(PoseSelectionLaw, EveryCriterionIsBestAtItsOwn) {
  std::vector<Selection> by;
  for (const Criterion criterion :
       {Criterion::volume, Criterion::mean_variance, Criterion::worst_direction, Criterion::pose_uncertainty}) {
    by.push_back(select_stations(robot, candidates, {.poses = 16, .criterion = criterion}));
  }
  for (const Selection& other : by) {
    EXPECT_LE(by[3].uncertainty.rms_aligned, 1.02 * other.uncertainty.rms_aligned);
  }
}

TEST_P(PoseSelectionLaw, MorePosesAreNeverWorse) {
  const Selection selection = select_stations(robot, candidates, {.poses = 25});
  ASSERT_EQ(selection.curve.size(), 24u);
  for (std::size_t k = 1; k < selection.curve.size(); ++k) {
    EXPECT_LE(selection.curve[k].rms_aligned, selection.curve[k - 1].rms_aligned * (1 + 1e-9));
  }
  EXPECT_LE(selection.uncertainty.rms_aligned, 1.05 * selection.curve.back().rms_aligned);
}

TEST_P(PoseSelectionLaw, RotationAndSecondReflectorHelp) {
  const Selection plain = select_stations(robot, candidates, {.poses = 12});
  const Selection second =
      select_stations(robot, candidates, {.poses = 12, .readings = {.rotation = true, .second = true}});
  EXPECT_LE(second.uncertainty.rms_aligned, plain.uncertainty.rms_aligned);
}

TEST_P(PoseSelectionLaw, HomeStaysFirstAndNamesAreUnique) {
  const Selection selection = select_stations(robot, candidates, {.poses = 18});
  EXPECT_EQ(selection.stations.front().name, "P0");
  std::set<std::string> names;
  for (const Station& station : selection.stations) names.insert(station.name);
  EXPECT_EQ(names.size(), 18u);
}

TEST_P(PoseSelectionLaw, WayIsShorterThanTheOrderOfChoice) {
  std::vector<Station> stations(candidates.begin(), candidates.begin() + 25);
  double plain = 0.0;
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const Joints from = believed_joints(robot, stations[k]);
    const Joints to = believed_joints(robot, stations[(k + 1) % stations.size()]);
    plain += (to - from).cwiseAbs().maxCoeff();
  }
  EXPECT_LT(shorten_way(robot, stations), 0.7 * plain);
  EXPECT_EQ(stations.front().name, "P0");
}

TEST_P(PoseSelectionLaw, CandidatesAreReachableAndRepeatable) {
  EXPECT_EQ(candidates.size(), 200u);
  const std::vector<Station> again = candidate_stations(robot, 200, 1);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    EXPECT_EQ(candidates[k].commanded.position, again[k].commanded.position);
    EXPECT_LE(candidates[k].commanded.position.head<2>().norm(), robot.workspace().radius);
    EXPECT_NO_THROW((void)believed_joints(robot, candidates[k]));
  }
}

PARACAL_ON_EVERY_ROBOT(PoseSelectionLaw);

/// Five candidates: one bundle of four, and one with nothing beside it.
TEST(PackedRows, TimesSixColumns) {
  const Eigen::MatrixXd weighted = Eigen::MatrixXd::Random(11, 15), columns = Eigen::MatrixXd::Random(11, 6);
  const detail::PackedRows packed(weighted);
  Eigen::MatrixXd product(24, 6);
  product << packed.times(0, columns), packed.times(1, columns);
  EXPECT_LT((product.topRows(15) - weighted.transpose() * columns).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_TRUE(product.bottomRows(9).isZero(0.0));
}

/// Blocks of candidates do not depend on each other, so the number of threads leaves no trace; 300 candidates are five.
TEST(PoseSelection, IsTheSameForAnyNumberOfThreads) {
  const Robot robot = catalogue::huang2016();
  const std::vector<Station> candidates = candidate_stations(robot, 300, 1);
  const Selection one = select_stations(robot, candidates, {.poses = 8, .threads = 1});
  for (const unsigned threads : {2U, 5U, 0U}) {
    const Selection other = select_stations(robot, candidates, {.poses = 8, .threads = threads});
    EXPECT_EQ(one.criterion, other.criterion);
    ASSERT_EQ(one.stations.size(), other.stations.size());
    for (std::size_t k = 0; k < one.stations.size(); ++k) EXPECT_EQ(one.stations[k].name, other.stations[k].name);
  }
}

/// Every pose but home is added once and compared once a sweep; what is expected grows by a sweep when there is one
/// more.
TEST(SelectionProgress, CountsAdditionsAndComparisons) {
  const Robot robot = catalogue::rotary_delta();
  std::vector<std::uint64_t> done, expected;
  const Selection selection = select_stations(robot, candidate_stations(robot, 60, 1),
                                              {.poses = 12, .progress = [&](std::uint64_t one, std::uint64_t all) {
                                                 done.push_back(one);
                                                 expected.push_back(all);
                                               }});
  ASSERT_EQ(done.size(), 11u * static_cast<std::size_t>(1 + selection.sweeps));
  for (std::size_t k = 0; k < done.size(); ++k) {
    EXPECT_EQ(done[k], k + 1);
    EXPECT_GE(expected[k], done[k]);
  }
  EXPECT_EQ(expected.front(), 22u);
  EXPECT_EQ(expected.back(), done.back());
}

TEST(Visibility, SeesWithinTheConeOnly) {
  Visibility visibility{.tracker = {3000, 0, -900}, .facing = {1, 0, 0}, .half_angle = to_radians(30)};
  EXPECT_TRUE(visibility.sees({{0, 0, -900}, 0.0}));
  EXPECT_FALSE(visibility.sees({{0, 0, -900}, to_radians(31)}));
  visibility.mount = ReflectorMount::plate;
  EXPECT_TRUE(visibility.sees({{0, 0, -900}, to_radians(31)}));
  visibility.tracker = {-3000, 0, -900};
  EXPECT_FALSE(visibility.sees({{0, 0, -900}, 0.0}));
}

TEST(PoseSelection, CandidatesAreVisible) {
  const Robot robot = catalogue::huang2016();
  const Visibility visibility{.tracker = {3000, 0, -900}, .facing = {1, 0, 0}, .half_angle = to_radians(30)};
  const std::vector<Station> candidates = candidate_stations(robot, 100, 5, visibility);
  ASSERT_EQ(candidates.size(), 100u);
  for (std::size_t k = 1; k < candidates.size(); ++k) EXPECT_TRUE(visibility.sees(candidates[k].commanded));
}

TEST(PoseSelection, TooFewCandidatesAreRefused) {
  const Robot robot = catalogue::huang2016();
  const std::vector<Station> candidates = candidate_stations(robot, 5, 1);
  EXPECT_THAT([&] { (void)select_stations(robot, candidates, {.poses = 6}); },
              testing::ThrowsMessage<InvalidArgument>(testing::HasSubstr("expected 2 to 5 poses, got 6")));
  EXPECT_THROW((void)select_stations(robot, candidates, {.poses = 1}), InvalidArgument);
}

}  // namespace
}  // namespace paracal::pose_selection_test
