#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "paper/published.hpp"
#include "paracal/calibration/identification.hpp"
#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::io::robot_files_test {
namespace {

class RobotFileLaw : public test::EveryRobot {};

TEST_P(RobotFileLaw, WrittenRobotReadsBack) {
  const std::string text = robot_toml(robot);
  const Robot again = read_robot({"robot.toml", text});
  EXPECT_EQ(robot_toml(again), text);
  EXPECT_EQ(to_json(again), to_json(robot));
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    const double apart = azimuth_of(again.limbs()[i]) - azimuth_of(robot.limbs()[i]);
    EXPECT_NEAR(std::remainder(apart, 2.0 * std::numbers::pi), 0.0, 1e-15);
  }
  EXPECT_EQ(again.limb_count(), robot.limb_count());
}

PARACAL_ON_EVERY_ROBOT(RobotFileLaw);
PARACAL_ON_UNUSUAL_ROBOTS(RobotFileLaw);

TEST(RobotFile, NameMayHoldAnythingThatCanBeShown) {
  RobotDescription description = catalogue::huang2016().description();
  description.name = "\xC3\xA4 \"quoted\" \\ </script>";
  EXPECT_EQ(read_robot({"r", robot_toml(Robot(description))}).name(), description.name);
  for (const std::string name : {"line\nbreak", "\x1b[31m",
                                 "\xC2\x9B"
                                 "2J",
                                 "bell\a"}) {
    description.name = name;
    EXPECT_THROW(Robot{description}, InvalidArgument) << name;
  }
}

TEST(RobotFile, RefusedGeometryNamesTheLine) {
  std::string text = robot_toml(catalogue::huang2016());
  text.replace(text.find("arm_mm = 375"), 12, "arm_mm = -37");
  EXPECT_THAT(
      [&] {
        read_robot({"robot.toml", text});
      },
      testing::ThrowsMessage<InputFileError>(testing::StartsWith("robot.toml:6: geometry.arm_mm: expected")));
}

/// What [geometry] can describe: three or four limbs, from which the plate hangs.
TEST(RobotFile, TheShortFormIsOfThreeOrFourLimbsAbove) {
  const auto refused = [](const Robot& robot, std::string_view key, const std::string& line, const char* why) {
    std::string text = robot_toml(robot);
    const std::size_t at = text.find(key);
    text.replace(at, text.find('\n', at) - at, line);
    EXPECT_THAT([&] { read_robot({"r", text}); }, testing::ThrowsMessage<InputFileError>(testing::HasSubstr(why)));
  };
  refused(catalogue::huang2016(), "limb_azimuth_deg", "limb_azimuth_deg = [0, 60, 120, 180, 270]",
          "r:9: geometry.limb_azimuth_deg: expected 4 limbs for a plate with a slide, got 5");
  refused(catalogue::rotary_delta(), "limb_azimuth_deg", "limb_azimuth_deg = [0, 60, 120, 180]",
          "geometry.limb_azimuth_deg: expected 3 limbs for a rigid plate, got 4");
  refused(catalogue::rotary_delta(), "limb_azimuth_deg", "limb_azimuth_deg = []", "got 0");
  refused(catalogue::rotary_delta(), "top_z_mm", "top_z_mm = 763", "workspace.top_z_mm: expected a depth below");
}

/// What limbs differ in counts from what most of them have, whatever the file counted it from.
TEST(RobotFile, DifferencesCountFromMostLimbs) {
  const std::string text = robot_toml(catalogue::rotary_delta());
  const Robot robot =
      read_robot({"r", text + "\n[[limb]]\nrod_mean_mm = 3\n[[limb]]\nrod_mean_mm = 3\ne_mm = [0, 0, 2.5]\n[[limb]]\n"
                              "theta_offset_deg = 1.5\n"});
  EXPECT_EQ(to_json(robot)["geometry"]["rod_mm"], 953.0);
  EXPECT_EQ(to_json(robot)["limb"], Json::parse(R"([{}, {"e_mm": [0.0, 0.0, 2.5]},
                                                     {"theta_offset_deg": 1.5, "rod_mean_mm": -3.0}])"));
  const Machine again = read_robot({"r", robot_toml(robot)}).nominal();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(again.limbs[i].rod, robot.nominal().limbs[i].rod);
    EXPECT_EQ(again.limbs[i].base, robot.nominal().limbs[i].base);
    EXPECT_EQ(again.limbs[i].joint_offset, robot.nominal().limbs[i].joint_offset);
  }
}

TEST(RobotFile, LimbsMayDifferOnPurpose) {
  const std::string text = robot_toml(catalogue::rotary_delta());
  const std::string own =
      text + "\n[[limb]]\nrod_mean_mm = 3\ne_mm = [0, 0, 25]\n[[limb]]\n[[limb]]\narm_length_mm = -2\n";
  const Robot robot = read_robot({"robot.toml", own});
  const Machine& nominal = robot.nominal();
  EXPECT_NEAR(nominal.limbs[0].mean_rod(), 950.0 + 3.0, 1e-12);
  EXPECT_NEAR(nominal.limbs[0].base[2], 25.0, 1e-12);
  EXPECT_NEAR(nominal.limbs[2].arm, 400.0 - 2.0, 1e-12);
  EXPECT_EQ(nominal.limbs[1].mean_rod(), 950.0);
  SourceErrors errors;
  errors(0, "rod_mean") = 0.5;
  EXPECT_NEAR(build(robot, errors).limbs[0].mean_rod(), 950.0 + 3.5, 1e-12);
}

TEST(RobotFile, RefusesWhatNoLimbIsMeantToBe) {
  const std::string text = robot_toml(catalogue::rotary_delta());
  const auto refused = [&](const std::string& more, const std::string& complaint) {
    EXPECT_THAT(
        [&] {
          read_robot({"robot.toml", text + more});
        },
        testing::ThrowsMessage<InputFileError>(testing::HasSubstr(complaint)))
        << more;
  };
  refused("\n[[limb]]\n[[limb]]\n", "expected 3 [[limb]] tables, one for each limb, got 2");
  refused("\n[[limb]]\nalpha2_deg = 1\n[[limb]]\n[[limb]]\n", "limb: expected no alpha2 of limb 1");
  refused("\n[[limb]]\nrod_mean_mm = -950\n[[limb]]\n[[limb]]\n",
          "limb: rod_mm of limb 1: expected a length above 0 mm, got 0 mm");
  refused("\n[[limb]]\nrod_mean_mm = nan\n[[limb]]\n[[limb]]\n", "rod_mean");
  refused("\n[controller]\norigin_mm = [0, 1]\n", "origin_mm");
  refused("\n[controller]\n", "origin_mm");
  refused("\n[joints]\nmax_speed_deg_per_s = 90\n", "max_acceleration_deg_per_s2");
  refused("\n[joints]\nmax_speed_mm_per_s = 90\nmax_acceleration_mm_per_s2 = 9\n", "max_speed_deg_per_s");
  refused("\n[joints]\nmax_speed_deg_per_s = 0\nmax_acceleration_deg_per_s2 = 9\n", "above 0");
}

TEST(RobotFile, LimbsAreTables) {
  for (const auto& [limbs, complaint] : {std::pair{"5", "r.toml:2: expected an array of tables for limb, got a number"},
                                         {"[5]", "r.toml:2: expected a table for limb, got a number"}}) {
    EXPECT_THAT(([&, limbs = std::string(limbs)] {
                  (void)read_robot({"r.toml", "name = \"r\"\nlimb = " + limbs});
                }),
                testing::ThrowsMessage<InputFileError>(complaint));
  }
}

TEST(RobotFile, RefusesMoreLimbsThanAnyRobotHas) {
  std::string text = robot_toml(catalogue::rotary_delta());
  std::string azimuths;
  for (int limb = 0; limb < 40; ++limb) azimuths += fmt::format("{}{}", limb > 0 ? ", " : "", 9 * limb);
  text.replace(text.find("[0, 120, 240]"), 13, "[" + azimuths + "]");
  for (int limb = 0; limb < 40; ++limb) text += "\n[[limb]]\nrod_mean_mm = 5\n";
  EXPECT_THAT(
      [&] {
        read_robot({"r.toml", text});
      },
      testing::ThrowsMessage<InputFileError>(testing::HasSubstr(
          "expected 3 limbs for a rigid plate, got 40: describe a robot with other limbs by [plate] and [[limb]]")));
}

TEST(SourceErrorFile, KeysAreInDegAndMm) {
  const SourceErrors errors = read_source_errors(
      {"errors.toml", "[[limb]]\ntheta_offset_deg = 1\ne_mm = [1, 2, 3.5]\n[[limb]]\n[[limb]]\nbeta2_deg = -0.5\n"}, 3);
  EXPECT_EQ(errors(0, "theta_offset"), to_radians(1.0));
  EXPECT_EQ(errors(0, "e_z"), 3.5);
  EXPECT_EQ(errors(1, "arm_length"), 0.0);
  EXPECT_EQ(errors(2, "beta2"), to_radians(-0.5));
}

TEST(SourceErrorFile, MisspeltKeyIsRefusedWithItsLine) {
  EXPECT_THAT(
      [] {
        read_source_errors({"e.toml", "[[limb]]\n[[limb]]\narm_lenght_mm = 1\n[[limb]]\n"}, 3);
      },
      testing::ThrowsMessage<InputFileError>(
          testing::AllOf(testing::StartsWith("e.toml:3: expected one of"),
                         testing::HasSubstr("\"limb 2.arm_lenght_mm\" (did you mean arm_length_mm?)"))));
}

TEST(CalibrationFile, ErrorsReadBack) {
  const Robot robot = catalogue::huang2016();
  const Calibration calibration = calibrate(robot, published_huang2016().rough);
  const CalibratedMachine again = read_calibration(JsonFile({"c.json", to_json(calibration, 0).dump()}), robot);
  for (std::size_t limb = 0; limb < 4; ++limb) {
    for (const Source source : all_sources()) {
      EXPECT_NEAR(again.errors(limb, source), calibration.errors()(limb, source), 1e-15);
    }
  }
  EXPECT_EQ(again.parameters.size(), 4 * sources_of(Actuator::revolute).size());
  EXPECT_LT((again.noise_covariance - calibration.noise_covariance).norm(), 1e-12 * calibration.covariance.norm());
  EXPECT_EQ(again.noise_dof, calibration.noise_dof);
  EXPECT_LT((again.covariance - calibration.covariance).norm(), 1e-12 * calibration.covariance.norm());
  EXPECT_THROW(read_calibration(JsonFile({"c.json", to_json(calibration, 0).dump()}), catalogue::rotary_delta()),
               InputFileError);
}

TEST(CalibrationFile, OneThatWasNotAcceptedIsRefused) {
  const Robot robot = catalogue::huang2016();
  Measurements too_few = published_huang2016().rough;
  too_few.distances.resize(3);
  const std::string text = to_json(calibrate(robot, too_few), 0).dump();
  EXPECT_THAT(
      [&] {
        read_calibration(JsonFile({"c.json", text}), robot);
      },
      testing::ThrowsMessage<InputFileError>(testing::HasSubstr("got the verdict \"not identifiable\"")));
}

TEST(CalibrationFile, HoldsEverythingToRepeatTheFit) {
  const Json json = to_json(calibrate(catalogue::huang2016(), published_huang2016().rough), 0);
  EXPECT_EQ(json["date"], "1970-01-01T00:00:00Z");
  EXPECT_EQ(json["parameters"].size(), 4 * sources_of(Actuator::revolute).size());
  EXPECT_EQ(json["parameters"][0]["unit"], "deg");
  EXPECT_EQ(json["parameters"][0]["status"], "identified");
  EXPECT_EQ(json["parameters"][4]["status"], "prior");  // held at nominal, its tolerance counts
  EXPECT_EQ(json["covariance"].size(), 4 * sources_of(Actuator::revolute).size());
  const double std = json["parameters"][0]["std"];
  EXPECT_NEAR(std * std, json["covariance"][0][0].get<double>(), 1e-15);
  EXPECT_EQ(json["inputs"][0]["sha256"].get<std::string>().size(), 64u);
  EXPECT_EQ(json["robot"]["name"], "huang2016");
  EXPECT_TRUE(json["null_space"].is_array());
}

}  // namespace
}  // namespace paracal::io::robot_files_test
