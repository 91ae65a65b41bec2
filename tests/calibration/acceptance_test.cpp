// What an accepted calibration must have explained, and the causes that are named where it has not.

#include <gmock/gmock.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calibration/diagnosis/mistakes.hpp"
#include "calibration/fit/sought.hpp"
#include "calibration/verdict/acceptance.hpp"
#include "calibration/verdict/evidence.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::acceptance_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNoise = 0.017;  // mm

/// A calibration that explains everything, of which a test spoils one thing.
class Accepted : public testing::Test {
 protected:
  Accepted() {
    found.identifies_errors = true;
    found.use = Use{.distance = {0.03}, .aligned = {0.04}};
    found.uncalibrated = Use{.distance = {3.0}, .aligned = {4.0}};
    found.allowed = 1.0;
  }
  std::vector<std::string> reasons() const { return detail::unexplained(found, options); }

  CalibrationOptions options;
  detail::Compared found;
};

TEST_F(Accepted, WhereAllIsExplained) { EXPECT_THAT(reasons(), IsEmpty()); }

TEST_F(Accepted, NotWhereNothingIsIdentified) {
  found.identifies_errors = false;
  EXPECT_THAT(reasons(), ElementsAre(HasSubstr("no error is identified")));
  found.combinations = 1.5;  // as of heights, which determine sums of errors
  EXPECT_THAT(reasons(), IsEmpty());
}

TEST_F(Accepted, NoiseOfTenTimesTheStatedIsTheLimit) {
  found.stated_noise = 9.9;
  EXPECT_THAT(reasons(), IsEmpty());
  found.stated_noise = 11.0;
  EXPECT_THAT(reasons(), ElementsAre(HasSubstr("scatter 11 times as much as their stated sigmas")));
}

TEST_F(Accepted, NoiseOfAHundredTimesTheExpectedIsTheLimit) {
  found.unstated_noise = 99.0;
  EXPECT_THAT(reasons(), IsEmpty());
  found.unstated_noise = 500.0;
  found.noise = 8.5;
  EXPECT_THAT(reasons(), ElementsAre(HasSubstr("scatter 8.5 mm, 500 times the noise")));
}

TEST_F(Accepted, JointsThatDoHalfOfWhatTolerancesDoAreTheLimit) {
  found.absorbed = 0.49;
  EXPECT_THAT(reasons(), IsEmpty());
  found.absorbed = 0.6;
  EXPECT_THAT(reasons(), ElementsAre(HasSubstr("by 0.6 mm at the plate, and the tolerances allow errors of 1 mm")));
}

/// Better in one quantity, and in none worse by more than a tenth.
TEST_F(Accepted, UIsComparedWithTheUncalibratedMachine) {
  found.use->distance.U = 3.2;
  EXPECT_THAT(reasons(), IsEmpty());
  found.use->aligned.U = 4.1;
  EXPECT_THAT(reasons(), ElementsAre(HasSubstr("not below that of the uncalibrated machine (distances of 3.2 mm, by "
                                               "the tolerances alone 3 mm)")));
  found.use->aligned.U = 4.5;
  EXPECT_THAT(reasons(), ElementsAre(HasSubstr("U of aligned positions over the workspace is 4.5 mm; before")));
}

/// U of the uncalibrated machine is that of errors drawn from its tolerances.
TEST(Uncalibrated, UIsThatOfTheTolerances) {
  const Robot robot = catalogue::rotary_delta();
  KnownErrors known{.errors = {}, .parameters = detail::all_with_priors(robot, {}), .covariance = {}};
  Posterior posterior;
  for (const SoughtSource& one : known.parameters) posterior.parameters.push_back({one.limb, one.source});
  const Eigen::MatrixXd tolerances = detail::covariance_of_tolerances(robot, {}, posterior);
  known.covariance = 1e-4 * tolerances;
  const UseOfVisits use = use_over_workspace(robot, known, tolerances);
  ASSERT_TRUE(use.uncalibrated);
  EXPECT_NEAR(use.uncalibrated->distance.U, 100.0 * use.any.distance.U, 1e-6 * use.uncalibrated->distance.U);
  EXPECT_NEAR(use.uncalibrated->aligned.U, 100.0 * use.any.aligned.U, 1e-6 * use.uncalibrated->aligned.U);
  for (std::size_t k = 0; k < known.parameters.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(std::sqrt(tolerances(at, at)), *known.parameters[k].prior_std, 1e-12);
  }
  // A table of variances expects parts to be beyond them: of exp(u), u of mean 0.3, a mean square of 1 / (1 - 0.6).
  posterior.visit_std = Eigen::VectorXd::Zero(3);
  EXPECT_NEAR(detail::covariance_of_tolerances(robot, {}, posterior)(0, 0), 2.5 * tolerances(0, 0), 1e-12);
}

/// The second half of a file in metres: of a machine whose fit settles, and of one whose fit does not.
TEST(PartInAnotherUnit, IsNotAcceptedAndNamed) {
  for (const char* name : {"rotary_delta", "huang2016"}) {
    SCOPED_TRACE(name);
    const Robot robot = robot_named(name);
    const std::vector<Station> stations = candidate_stations(robot, 14, 3);
    Measurements read = measured_machine(robot, stations, 4, {.noise = kNoise, .repeats = 2}).measurements;
    std::vector<PointReading>& readings = read.series[0].readings;
    std::ranges::stable_sort(readings, {}, &PointReading::station);
    for (std::size_t k = readings.size() / 2; k < readings.size(); ++k) readings[k].point /= 1000.0;
    const Calibration calibration = calibrate(robot, read);
    EXPECT_FALSE(calibration.accepted());
    EXPECT_THAT(
        calibration.reasons,
        Contains(HasSubstr(fmt::format("readings {} to {} are in metres", readings.size() / 2 + 1, readings.size()))));
    EXPECT_EQ(calibration.use.has_value(), calibration.verdict == Verdict::rejected);
  }
}

/// A part that is not at one end, of distances, and units of two kinds; and nothing where there is nothing.
TEST(PartInAnotherUnit, IsAnyPart) {
  const Robot robot = catalogue::rotary_delta();
  const std::vector<Station> stations = candidate_stations(robot, 12, 3);
  const Measurements read = measured_machine(robot, stations, 4, {.noise = kNoise}).measurements;
  EXPECT_FALSE(detail::part_in_another_unit(read));
  Measurements points = read;
  for (std::size_t k = 3; k < 6; ++k) points.series[0].readings[k].point /= 25.4;
  const auto part = detail::part_in_another_unit(points);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->text, "readings 4 to 6 are in inches");
  const auto undone = detail::undone({robot, points, {}}, *part);
  ASSERT_TRUE(undone);
  for (std::size_t k = 0; k < read.series[0].readings.size(); ++k) {
    EXPECT_LT((undone->measurements.series[0].readings[k].point - read.series[0].readings[k].point).norm(), 1e-9);
  }
  Measurements distances{.stations = stations, .distances = all_distances(read.series[0])};
  for (std::size_t k = 0; k < distances.distances.size(); k += 2) distances.distances[k].distance /= 10.0;
  const auto others = detail::part_in_another_unit(distances);
  ASSERT_TRUE(others);
  EXPECT_THAT(others->text, HasSubstr(fmt::format("of {} readings are in centimetres", distances.distances.size())));
}

/// Lengths of a kind at these poses, from a point far below, along a direction askew, or above a plane.
LengthSeries lengths_at(const std::vector<Station>& stations, LengthKind kind) {
  const Eigen::Vector3d point(100.0, 50.0, -1500.0), along(0.0, 0.6, 0.8);
  LengthSeries series{.name = "lengths", .kind = kind};
  if (kind == LengthKind::ball_bar) series.at = point;
  if (kind == LengthKind::dial) series.at = along;
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const Eigen::Vector3d& place = stations[k].commanded.position;
    const double height = place.z() + 0.02 * place.x() + 1100.0;
    const double length = kind == LengthKind::ball_bar ? (place - point).norm()
                          : kind == LengthKind::dial   ? along.dot(place)
                                                       : height;
    series.readings.push_back({.station = k, .length = length + kNoise * std::sin(3.0 * static_cast<double>(k))});
  }
  return series;
}

/// Lengths of any size: where they were read shows that a part is in another unit.
TEST(PartInAnotherUnit, IsFoundAmongLengthsOfAnySize) {
  const Robot robot = catalogue::rotary_delta();
  const std::vector<Station> stations = candidate_stations(robot, 14, 3);
  for (const LengthWords& kind : length_kinds()) {
    SCOPED_TRACE(kind.name);
    const Measurements read{.stations = stations, .lengths = {lengths_at(stations, kind.kind)}};
    EXPECT_FALSE(detail::part_in_another_unit(read));
    Measurements last = read, first = read;
    for (std::size_t k = 7; k < stations.size(); ++k) last.lengths[0].readings[k].length /= 1000.0;
    for (std::size_t k = 0; k < 5; ++k) first.lengths[0].readings[k].length /= 25.4;
    const auto in_metres = detail::part_in_another_unit(last), in_inches = detail::part_in_another_unit(first);
    ASSERT_TRUE(in_metres && in_inches);
    EXPECT_EQ(in_metres->text, fmt::format("readings 8 to {} are in metres", stations.size()));
    EXPECT_EQ(in_inches->text, "readings 1 to 5 are in inches");
    const Calibration calibration = calibrate(robot, last);
    EXPECT_FALSE(calibration.accepted());
    EXPECT_THAT(calibration.reasons, Contains(HasSubstr(in_metres->text)));
  }
}

/// A fit that diverged has no p-value, and no library throws for it.
TEST(Improvement, HasNoPValueWhereTheFitDiverged) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kMost = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(detail::chance_of(8.0, 2.0, {4.0, 4.0}, false).value(), 1.0 / 9.0, 1e-9);  // (1 + 4 / 2)^-2
  for (const double wrong : {kNone, kMost}) {
    EXPECT_FALSE(detail::chance_of(wrong, 2.0, {4.0, 4.0}, false));
    EXPECT_FALSE(detail::chance_of(8.0, wrong, {4.0, 4.0}, true));
    EXPECT_FALSE(detail::chance_of(8.0, 2.0, {wrong, 4.0}, false));
    EXPECT_FALSE(detail::chance_of(8.0, 2.0, {4.0, wrong}, false));
  }
}

/// Points of a reflector beside the plate's centre: of a plate that tilts, and of one that turns with phi.
Measurements beside_centre(const Robot& robot, ReflectorMount mount, const Eigen::Vector3d& place) {
  const std::vector<Station> stations = candidate_stations(robot, 16, 3);
  Measurements read =
      measured_machine(robot, stations, 4, {.noise = kNoise, .repeats = 2, .second = place, .mount = mount})
          .measurements;
  for (PointReading& one : read.series[0].readings) {
    one.point = *one.second;
    one.second.reset();
  }
  return read;
}

TEST(Reflector, BesideTheCentreIsNotAcceptedAndNamed) {
  struct Case {
    const char* robot;
    ReflectorMount mount;
    Eigen::Vector3d place;
    std::string text;
  };
  for (const Case& one : std::array{Case{"hexapod",
                                         ReflectorMount::plate,
                                         {30.0, -40.0, 0.0},
                                         "the reflector is about 50 mm beside the plate's centre"},
                                    Case{"huang2016",
                                         ReflectorMount::end_effector,
                                         {20.0, 0.0, 10.0},
                                         "the reflector is about 20 mm beside the axis of phi and turns with it"}}) {
    SCOPED_TRACE(one.robot);
    const Robot robot = robot_named(one.robot);
    const Calibration calibration = calibrate(robot, beside_centre(robot, one.mount, one.place));
    EXPECT_FALSE(calibration.accepted());
    EXPECT_THAT(calibration.reasons, Contains(HasSubstr(one.text)));
    EXPECT_EQ(calibration.use.has_value(), calibration.verdict == Verdict::rejected);
  }
}

/// Each pose visited once, and no noise stated: U of a single visit holds what joints may do of it, and only then.
TEST(AmbiguousNoise, IsPartOfASingleVisit) {
  const Robot robot = catalogue::rotary_delta();
  const std::vector<Station> stations = candidate_stations(robot, 24, 3);
  const auto found = [&](double noise, int repeats, bool is_known = false) {
    return calibrate(robot, measured_machine(robot, stations, 4, {.noise = noise, .repeats = repeats}).measurements,
                     {.noise = {.point = noise}, .noise_is_known = is_known, .diagnose = false});
  };
  const Calibration once = found(kNoise, 1), twice = found(kNoise, 2), known = found(kNoise, 1, true);
  ASSERT_TRUE(once.use && twice.use && known.use);
  EXPECT_GT(once.use->aligned.U, 1.05 * known.use->aligned.U);  // more than 1000 drawn machines differ by
  EXPECT_LT(twice.use->aligned.U, 0.7 * once.use->aligned.U);
  const auto alike = Contains(HasSubstr("noise and joints that do not repeat look alike"));
  EXPECT_THAT(once.assumed, alike);
  EXPECT_THAT(twice.assumed, testing::Not(alike));
  EXPECT_THAT(known.assumed, testing::Not(alike));
  EXPECT_THAT(once.notes, IsEmpty());
}

TEST(AmbiguousNoise, IsANoteWhereItIsManyTimesTheExpected) {
  const Robot robot = catalogue::rotary_delta();
  const std::vector<Station> stations = candidate_stations(robot, 24, 3);
  const auto notes = [&](double noise) {
    return calibrate(robot, measured_machine(robot, stations, 4, {.noise = noise}).measurements, {.diagnose = false})
        .notes;
  };
  EXPECT_THAT(notes(8.0 * kNoise), Contains(HasSubstr("times what was expected of them. This is noise, or joints")));
  EXPECT_THAT(notes(1.5 * kNoise), IsEmpty());
}

}  // namespace
}  // namespace paracal::test::acceptance_test
