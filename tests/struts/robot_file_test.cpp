#include <gmock/gmock.h>

#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::io {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// The hexapod's file, changed.
std::string text_with(std::string_view found, std::string_view replaced) {
  std::string text = robot_template("hexapod").text;
  const std::size_t at = text.find(found);
  EXPECT_NE(at, std::string::npos) << found;
  return text.replace(at, found.size(), replaced);
}

void expect_refused(const std::string& text, std::string_view complaint) {
  EXPECT_THAT(
      [&] {
        read_robot({"robot.toml", text});
      },
      ThrowsMessage<InputFileError>(HasSubstr(std::string(complaint))));
}

class RobotTemplate : public test::EveryRobot {};
PARACAL_ON_ROBOT_TEMPLATES(RobotTemplate);

TEST_P(RobotTemplate, ReadsBackAsItIsWritten) {
  const std::string text = robot_toml(robot);
  const Robot again = read_robot({"robot.toml", text});
  EXPECT_EQ(robot_toml(again), text);
  EXPECT_EQ(to_json(again), to_json(robot));
  EXPECT_EQ(again.name(), GetParam());
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    EXPECT_EQ(again.nominal().limbs[i].base, robot.nominal().limbs[i].base);
    EXPECT_EQ(again.nominal().limbs[i].plate, robot.nominal().limbs[i].plate);
  }
}

TEST_P(RobotTemplate, ErrorsReadBackAsTheyAreWritten) {
  const SourceErrors errors = test::Random().errors(robot, 1.0, 0.01);
  const std::string text = source_errors_toml(errors, robot.joint_space());
  const SourceErrors again = read_source_errors({"errors.toml", text}, robot.joint_space());
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    for (const Source source : sources_of(robot.actuator())) EXPECT_EQ(again(i, source), errors(i, source));
  }
  for (const char* of_arms : {"theta_offset", "\ne_mm", "arm_length", "alpha", "rod_"}) {
    EXPECT_EQ(text.find(of_arms), std::string::npos) << of_arms;
  }
}

TEST(RobotTemplates, AKindThatIsNoneIsRefused) {
  EXPECT_THAT([] { robot_template("octopod"); }, ThrowsMessage<InvalidArgument>(HasSubstr("hexapod")));
}

TEST(StrutFile, WhatMakesNoSenseIsRefusedWithTheReason) {
  expect_refused(text_with("kind = \"strut\"", "kind = \"cord\""), "robot.toml:8: expected \"strut\" for limb.kind");
  expect_refused(text_with("length_at_zero_mm = 500.0", "length_at_zero_mm = -5"), "length_at_zero_mm of limb 1");
  expect_refused(text_with("top_z_mm = 550", "top_z_mm = 50"), "above the base, or one below");
  expect_refused(text_with("tilt_deg = 10", "tilt_deg = 95"), "workspace.tilt_deg");
  expect_refused(text_with("[workspace]",
                           "[plate]\nslide_axis = [0, -1, 0]\nslide_sign = [1, 1, 1, -1, -1, -1]\n"
                           "pinion_radius_mm = 12\n[workspace]"),
                 "no slide");
  expect_refused(text_with("gain_mm_per_m", "alpha0_deg"), "alpha0_deg");
  const std::string text = robot_template("hexapod").text;
  const std::size_t last = text.rfind("[[limb]]"), end = text.find("\n#", last);
  expect_refused(text.substr(0, last) + text.substr(end), "expected 6 struts for a plate with six freedoms, got 5");
  const std::string of_limb_2 = "base_joint_mm = [281.908, 102.606, 0.0]\nplate_joint_mm = [129.481, 125.039, 0.0]";
  expect_refused(
      text_with(of_limb_2, "base_joint_mm = [281.908, -102.606, 0.0]\nplate_joint_mm = [129.481, -125.039, 0.0]"),
      "limbs 1 and 2 both from");
}

/// Base and plate alike, each strut straight up: the plate could be turned with all of them as they are.
TEST(StrutFile, StrutsThatDoNotHoldThePlateAreRefused) {
  const Robot robot = read_robot(robot_template("hexapod"));
  RobotDescription alike = robot.description();
  std::vector<Strut> struts = alike.geometry.struts;
  for (Strut& strut : struts) strut.plate = 0.6 * strut.base;
  alike.geometry = strut_geometry(struts);
  EXPECT_THAT([&] { Robot{alike}; },
              ThrowsMessage<InvalidArgument>(HasSubstr("do not hold the plate at (0, 0, 500) mm")));
}

TEST(StrutFile, RobotsOfArmsDoNotTilt) {
  const std::string arms = robot_toml(catalogue::rotary_delta());
  std::string tilted = arms;
  tilted.replace(tilted.find("top_z_mm"), 0, "tilt_deg = 3\n");
  expect_refused(tilted, "expected nothing for a plate that stays level");
}

}  // namespace
}  // namespace paracal::io
