#include "paracal/io/robot_statement.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "paper/published.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/robots.hpp"

namespace paracal::io::robot_statement_test {
namespace {

using testing::AllOf, testing::HasSubstr, testing::StartsWith;

std::string name_in(const std::string& text) {
  const auto stated = robot_of_table({"folder/t.csv", text});
  return stated ? stated->robot.name() : "";
}

TEST(RobotOfATable, IsNamedInAComment) {
  EXPECT_EQ(name_in("# robot: rotary_delta\npose,x_mm\n"), "rotary_delta");
  EXPECT_EQ(name_in("\xEF\xBB\xBF#robot:huang2016,,,\r\npose,x_mm\r\n"), "huang2016");
  EXPECT_EQ(name_in("pose,x_mm\na,1\n#  robot:  linear_delta  "), "linear_delta");
  EXPECT_EQ(name_in("# our robot: rotary_delta\nrobot: rotary_delta\n# robots: none\n"), "");
  const auto stated = robot_of_table({"t.csv", "# a\n# robot: rotary_delta\n"});
  EXPECT_EQ(stated->by, "t.csv");
  EXPECT_EQ(stated->line, 2);
}

TEST(RobotOfATable, MustBeOne) {
  for (const char* name : {"delta", "", "none.toml"}) {
    EXPECT_THAT([&] { name_in(std::string("pose\n# robot: ") + name); },
                testing::ThrowsMessage<InputFileError>(AllOf(StartsWith("folder/t.csv:2: "), HasSubstr(name))));
  }
  EXPECT_THAT([] { name_in("# robot: rotary_delta\n# robot: huang2016\n"); },
              testing::ThrowsMessage<InputFileError>(AllOf(StartsWith("folder/t.csv:2: "), HasSubstr("huang2016"))));
  EXPECT_EQ(name_in("# robot: huang2016\n# robot: huang2016\n"), "huang2016");
}

std::string calibration_of(const Robot& robot) {
  Calibration calibration = calibrate(catalogue::huang2016(), published_huang2016().rough);
  Json json = to_json(calibration, 0);
  json["robot"] = to_json(robot);
  return json.dump(2);
}

class CalibratedRobot : public test::EveryRobot {};

TEST_P(CalibratedRobot, ReadsBack) {
  const RobotStatement stated = robot_of_calibration(JsonFile({"c.json", calibration_of(robot)}));
  EXPECT_EQ(difference(robot, stated.robot), std::nullopt);
  EXPECT_EQ(to_json(stated.robot), to_json(robot));
  EXPECT_EQ(stated.robot.workspace().radius, robot.workspace().radius);
  EXPECT_GT(stated.line, 1);
}

PARACAL_ON_EVERY_ROBOT(CalibratedRobot);
PARACAL_ON_UNUSUAL_ROBOTS(CalibratedRobot);

TEST(RobotOfACalibration, MustBeWhole) {
  const auto refused = [](const Json& robot, const std::string& why) {
    const std::string text = Json{{"format", 1}, {"robot", robot}}.dump(1);
    EXPECT_THAT(
        [&] {
          robot_of_calibration(JsonFile({"c.json", text}));
        },
        testing::ThrowsMessage<InputFileError>(AllOf(StartsWith("c.json"), HasSubstr(why))));
  };
  Json json = to_json(catalogue::huang2016());
  json["geometry"]["rod_mm"] = -950;
  refused(json, "geometry.rod_mm");
  json["geometry"].erase("rod_mm");
  refused(json, "expected geometry.rod_mm");
  json["geometry"]["rod_mm"] = nullptr;
  refused(json, "rod_mm: expected a value, got null");
  Json deep = 1;
  for (int k = 0; k < 50; ++k) deep = Json::array({deep});
  json["geometry"]["rod_mm"] = deep;
  refused(json, "deeper");
  for (int k = 0; k < 5000; ++k) deep = Json::array({deep});
  json["geometry"]["rod_mm"] = deep;
  refused(json, "at most 64 levels");
  EXPECT_THROW(robot_of_calibration(JsonFile({"c.json", "{}"})), InputFileError);
  EXPECT_THAT(
      [] {
        robot_of_calibration(JsonFile({"c.json", "{\n no JSON"}));
      },
      testing::ThrowsMessage<InputFileError>(StartsWith("c.json:2: expected JSON")));
}

Robot changed(const std::function<void(RobotDescription&)>& change) {
  RobotDescription description = catalogue::huang2016().description();
  change(description);
  return Robot(description);
}

/// A robot loses an ulp where it is written and read.
TEST(SameRobot, RoundingIsNoDifference) {
  const Robot robot = catalogue::huang2016();
  const double ulp = 1.0 + 1e-15;
  EXPECT_FALSE(difference(robot, changed([&](RobotDescription& one) {
                            test::redimension(one, [&](SharedDimensions& shared) { shared.rod *= ulp; });
                            test::redimension(one, [&](SharedDimensions& shared) { shared.limb_azimuth[1] *= ulp; });
                            one.slide->axis.x() = 1e-17;
                          })));
  EXPECT_FALSE(difference(robot, changed([](RobotDescription& one) {
                            one.workspace.radius = 400.0;
                            one.tolerances.reset();
                          })));
}

TEST(SameRobot, ThePartThatDiffersIsNamed) {
  const Robot robot = catalogue::huang2016();
  const auto found = [&](const std::function<void(RobotDescription&)>& change) {
    return difference(robot, changed(change)).value_or("the same");
  };
  EXPECT_EQ(found([](RobotDescription& one) { one.name = "other"; }), "name \"huang2016\", got \"other\"");
  EXPECT_EQ(found([](RobotDescription& one) {
              test::redimension(one, [&](SharedDimensions& shared) { shared.rod = 950.00001; });
            }),
            "geometry.rod_mm 950.0, got 950.00001");
  EXPECT_THAT(found([](RobotDescription& one) {
                test::redimension(one, [&](SharedDimensions& shared) { shared.limb_azimuth[2] += 1e-6; });
              }),
              StartsWith("geometry.limb_azimuth_deg [-45.0"));
  EXPECT_THAT(found([](RobotDescription& one) { one.slide->pinion_radius = 13.0; }),
              StartsWith("plate.pinion_radius_mm"));
  EXPECT_THAT(*difference(catalogue::rotary_delta(), catalogue::linear_delta()), StartsWith("name"));
}

/// The calibration of a robot whose axis was normalised once more is its calibration.
TEST(SameRobot, ACalibrationSurvivesTheRobotsFile) {
  const Robot oblique = changed([](RobotDescription& one) { one.slide->axis = {0.1, -0.7, 0.01}; });
  Robot robot = oblique;
  for (int k = 0; k < 3; ++k) robot = read_robot({"r.toml", robot_toml(robot)});
  Json json = to_json(calibrate(catalogue::huang2016(), published_huang2016().rough), 0);
  json["robot"] = to_json(oblique);
  for (Json& axis : json["robot"]["plate"]["slide_axis"]) axis = std::nextafter(axis.get<double>(), 2.0);
  EXPECT_NO_THROW(read_calibration(JsonFile({"c.json", json.dump()}), robot));
  json["robot"]["plate"]["pinion_radius_mm"] = 12.001;
  EXPECT_THAT(
      [&] {
        read_calibration(JsonFile({"c.json", json.dump(1)}), robot);
      },
      testing::ThrowsMessage<InputFileError>(HasSubstr("plate.pinion_radius_mm")));
}

TEST(RobotLine, NamesTheCataloguesAlone) {
  EXPECT_EQ(robot_line(catalogue::rotary_delta()), "# robot: rotary_delta\n");
  EXPECT_EQ(robot_line(changed([](RobotDescription& one) {
              test::redimension(one, [&](SharedDimensions& shared) { shared.rod = 951.0; });
            })),
            "");
  EXPECT_EQ(robot_line(changed([](RobotDescription& one) { one.name = "mine"; })), "");
}

/// Limbs that differ on purpose make another robot, by more than rounding.
TEST(SameRobot, LimbsMakeAnotherRobot) {
  RobotDescription description = test::robot_named("unlike_limbs").description();
  const Robot one(description);
  test::redimension(description, [&](SharedDimensions& shared) { shared.differences(1, "rod_mean") += 1e-13; });
  EXPECT_FALSE(difference(one, Robot(description)));
  test::redimension(description, [&](SharedDimensions& shared) { shared.differences(1, "rod_mean") += 1e-3; });
  EXPECT_THAT(difference(one, Robot(description)).value_or(""), testing::HasSubstr("limb"));
  test::redimension(description, [](SharedDimensions& shared) { shared.differences = {}; });
  EXPECT_TRUE(difference(one, Robot(description)));
}

}  // namespace
}  // namespace paracal::io::robot_statement_test
