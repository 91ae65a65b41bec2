// One series of readings in another unit than the others.

#include "calibration/diagnosis/mistakes.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "paracal/calibration/diagnosis.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::test::unit_mistakes_test {
namespace {

using testing::ElementsAre;

constexpr double kNoise = 0.017;  // mm

/// Two series of points.
Measurements two_trackers(const Robot& robot, int number) {
  const std::vector<Station> stations = candidate_stations(robot, 20, 3);
  Measurements read = measured_machine(robot, stations, number, {.noise = kNoise, .repeats = 2}).measurements;
  PointSeries other{"two", {}};
  std::vector<PointReading>& readings = read.series[0].readings;
  other.readings.assign(readings.begin() + static_cast<std::ptrdiff_t>(readings.size() / 2), readings.end());
  readings.resize(readings.size() / 2);
  read.series[0].name = "one";
  read.series.push_back(std::move(other));
  return read;
}

/// Heights over the bed of a machine, and distances.
Measurements heights_and_distances(const Robot& robot, int number) {
  const std::vector<Station> stations = candidate_stations(robot, 20, 3);
  RandomStream random(static_cast<std::uint64_t>(number), 7);
  const SourceErrors errors = draw_errors(robot, *robot.tolerances(), random);
  Measurements read = simulate(robot, errors, planned(robot, stations, {.measurand = Measurand::home_distances}),
                               {.noise = kNoise}, random);
  read.lengths =
      simulate(robot, errors, planned(robot, stations, {.measurand = Measurand::lengths}), {.noise = kNoise}, random)
          .lengths;
  for (LengthReading& one : read.lengths[0].readings) one.length += 900.0;
  return read;
}

std::vector<std::string> causes(const Robot& robot, const Measurements& read) {
  const auto diagnosis = diagnose(robot, read);
  return diagnosis ? diagnosis->causes : std::vector<std::string>{"nothing"};
}

TEST(UnitMistakes, NameTheSeriesThatIsInAnotherUnit) {
  const Robot robot = robot_named("delta");
  for (const int number : {1, 2, 3}) {
    const Measurements sound = two_trackers(robot, number);
    EXPECT_FALSE(diagnose(robot, sound));
    for (const auto& [unit, mm] : {std::pair("metres", 1000.0), {"inches", 25.4}, {"centimetres", 10.0}}) {
      for (const std::size_t wrong : {std::size_t{0}, std::size_t{1}}) {
        Measurements read = sound;
        for (PointReading& one : read.series[wrong].readings) one.point /= mm;
        EXPECT_THAT(causes(robot, read),
                    ElementsAre(std::string("the readings of ") + (wrong == 0 ? "one" : "two") + " are in " + unit));
      }
    }
  }
}

TEST(UnitMistakes, NameTheKindThatIsInAnotherUnit) {
  const Robot robot = robot_named("delta");
  for (const int number : {1, 2, 3}) {
    const Measurements sound = heights_and_distances(robot, number);
    EXPECT_FALSE(diagnose(robot, sound));
    for (const auto& [unit, mm] : {std::pair("metres", 1000.0), {"inches", 25.4}, {"centimetres", 10.0}}) {
      Measurements read = sound;
      for (DistanceReading& one : read.distances) one.distance /= mm;
      EXPECT_THAT(causes(robot, read), ElementsAre(std::string("the distances are in ") + unit));
    }
  }
}

/// Each series, then all of a kind that has several; nothing of a single one.
TEST(UnitMistakes, AreOfEachSeriesAndKind) {
  const Robot robot = robot_named("delta");
  const auto texts = [&](const Measurements& read) {
    std::vector<std::string> all;
    for (const detail::Mistake& one : detail::unit_mistakes({robot, read, {}})) {
      if (one.text.ends_with("metres") && one.text.find("centi") == std::string::npos) all.push_back(one.text);
    }
    return all;
  };
  const std::string commanded = "the commanded poses are in metres";
  const std::string both = "the readings and the commanded poses are in metres";
  Measurements read{.stations = candidate_stations(robot, 3, 1), .series = {{"a", {}}}};
  EXPECT_THAT(texts(read), ElementsAre("the readings are in metres", commanded, both));
  read.series.push_back({"", {}});
  read.lengths = {{"c", LengthKind::height}, {"", LengthKind::dial}, {"e", LengthKind::height}};
  read.distances.push_back({0, 1, 100.0});
  EXPECT_THAT(texts(read), ElementsAre("the readings are in metres", "the readings of a are in metres",
                                       "the points of series 2 are in metres", "the readings of c are in metres",
                                       "the dial readings of series 2 are in metres", "the readings of e are in metres",
                                       "the distances are in metres", "the points are in metres",
                                       "the heights are in metres", commanded, both));
}

}  // namespace
}  // namespace paracal::test::unit_mistakes_test
