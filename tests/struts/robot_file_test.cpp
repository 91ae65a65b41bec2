#include <gmock/gmock.h>

#include <cmath>

#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::io::robot_file_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// A template's file, changed where a text stands first.
std::string text_with(std::string_view found, std::string_view replaced, std::string_view kind = "hexapod") {
  std::string text = robot_template(kind).text;
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
    for (const Source source : sources_of(robot.actuator())) EXPECT_DOUBLE_EQ(again(i, source), errors(i, source));
  }
  for (const char* of_parallelograms : {"theta_offset", "\ne_mm", "rod_mean", "rod_difference", "alpha2"}) {
    EXPECT_EQ(text.find(of_parallelograms), std::string::npos) << of_parallelograms;
  }
}

class LevelTemplate : public test::EveryRobot {};
INSTANTIATE_TEST_SUITE_P(Template, LevelTemplate, testing::ValuesIn(test::level_template_names()), test::robot_name);

TEST_P(LevelTemplate, ReadsBackAsItIsWrittenWithTolerancesOfItsOwn) {
  const std::string text = robot_toml(robot);
  EXPECT_EQ(robot_toml(read_robot({"robot.toml", text})), text);
  EXPECT_EQ(robot.name(), GetParam());
  EXPECT_TRUE(robot.tolerances().has_value());
}

TEST(RobotTemplates, AreWhatTheirNamesSay) {
  for (const std::string_view kind : {"delta", "quattro", "line-printer"}) {
    const Robot robot = test::robot_named(kind);
    EXPECT_EQ(robot.slide().has_value(), kind == "quattro") << kind;
    EXPECT_EQ(robot.actuator(), kind == "line-printer" ? Actuator::linear : Actuator::revolute) << kind;
  }
}

/// The nominal machine closes all over its workspace, and so does one whose parts are off by a millimetre and half a
/// degree.
TEST_P(LevelTemplate, ReachesItsWorkspaceWithAndWithoutErrors) {
  test::Random random;
  for (int k = 0; k < 100; ++k) {
    const Machine machine = build(robot, random.errors(robot, 1.0, 0.01));
    const Pose pose = random.pose(robot);
    const InverseResult joints = inverse(robot.nominal(), pose);
    ASSERT_TRUE(joints.ok());
    EXPECT_NEAR((forward(robot.nominal(), joints.joints).plate.position - pose.position).norm(), 0.0, 1e-9);
    const ForwardResult reached = forward(machine, joints.joints);
    ASSERT_TRUE(reached.ok());
    EXPECT_LT((reached.plate.position - pose.position).norm(), 30.0);
  }
}

TEST(RobotTemplates, AKindThatIsNoneIsRefused) {
  EXPECT_THAT([] { robot_template("octopod"); }, ThrowsMessage<InvalidArgument>(HasSubstr("hexapod")));
}

TEST(StrutFile, WhatMakesNoSenseIsRefusedWithTheReason) {
  expect_refused(text_with("kind = \"strut\"", "kind = \"cord\""),
                 "robot.toml:8: expected \"strut\", \"arm\" or \"rail\"");
  expect_refused(text_with("length_at_zero_mm = 500.0", "length_at_zero_mm = -5"), "length_at_zero_mm of limb 1");
  expect_refused(text_with("top_z_mm = 550", "top_z_mm = 50"), "above or below the base");
  expect_refused(text_with("tilt_deg = 10", "tilt_deg = 95"), "workspace.tilt_deg");
  expect_refused(text_with("[workspace]",
                           "[plate]\nslide_axis = [0, -1, 0]\nslide_sign = [1, 1, 1, -1, -1, -1]\n"
                           "pinion_radius_mm = 12\n[workspace]"),
                 "no slide");
  expect_refused(text_with("gain_mm_per_m", "alpha0_deg"), "alpha0_deg");
  const std::string text = robot_template("hexapod").text;
  const std::size_t last = text.rfind("[[limb]]"), end = text.find("\n#", last);
  expect_refused(text.substr(0, last) + text.substr(end),
                 "expected 6 to 8 limbs for a plate with six degrees of freedom, got 5");
  const std::string of_limb_2 = "base_joint_mm = [281.908, 102.606, 0.0]\nplate_joint_mm = [129.481, 125.039, 0.0]";
  expect_refused(
      text_with(of_limb_2, "base_joint_mm = [281.908, -102.606, 0.0]\nplate_joint_mm = [129.481, -125.039, 0.0]"),
      "limbs 1 and 2 both from");
}

TEST(ArmFile, WhatMakesNoSenseIsRefusedWithTheReason) {
  const auto refused = [](std::string_view found, std::string_view replaced, std::string_view complaint) {
    expect_refused(text_with(found, replaced, "6-rss"), complaint);
  };
  refused("kind = \"arm\"", "kind = \"rail\"", "robot.toml:8: expected limb.direction");
  refused("arm_mm = 110.0", "arm_mm = 0", "arm_mm of limb 1: expected a length above 0 mm");
  refused("rod_mm = 280.0", "rod_mm = -1", "rod_mm of limb 1");
  refused("axis = [-1.0, 0.0, 0.0]", "axis = [0.0, 0.0, 0.0]", "axis of limb 1: expected a direction, got (0, 0, 0)");
  refused("arm_at_zero = [0.0, -1.0, 0.0]", "arm_at_zero = [2.0, 0.1, 0.0]",
          "arm_at_zero of limb 1: expected an arm that points away from its axis (-1, 0, 0), got (2, 0.1, 0)");
  refused("arm_at_zero = [0.0, -1.0, 0.0]", "", "arm_at_zero");
  refused("axis = ", "length_at_zero_mm = 3\naxis = ", "length_at_zero_mm");
  refused("rod_mm = 280.0", "rod_mm = 180.0",
          "workspace: limb 1 cannot reach (30, 0, 270) mm tilted by (0, -8, 0) deg: "
          "with an arm of 110 mm it needs a rod of ");
  refused("zero_deg = 0.5", "zero_mm = 0.5", "zero_mm");
}

TEST(RailFile, WhatMakesNoSenseIsRefusedWithTheReason) {
  const auto refused = [](std::string_view found, std::string_view replaced, std::string_view complaint) {
    expect_refused(text_with(found, replaced, "6-pss"), complaint);
  };
  refused("carriage = \"behind\"", "carriage = \"beside\"",
          "robot.toml:14: expected \"ahead\" or \"behind\" for limb.carriage, got \"beside\"");
  refused("direction = [0.0, 1.0, 0.0]", "direction = [0.0, 0.0, 0.0]", "direction of limb 1");
  refused("rod_mm = 500.0", "rod_mm = 300.0", "its rail needs a rod of at least ");
  std::string mixed = robot_template("6-pss").text;
  mixed.replace(mixed.rfind("kind = \"rail\""), 13, "kind = \"strut\"");
  expect_refused(mixed, "expected limb.length_at_zero_mm");
  // Ahead where nothing is said.
  std::string silent = robot_template("6-pss").text;
  for (std::size_t at = silent.find("carriage = \"ahead\""); at != std::string::npos;
       at = silent.find("carriage = \"ahead\"", at)) {
    silent.erase(at, 18);
  }
  EXPECT_EQ(to_json(read_robot({"robot.toml", silent})), to_json(read_robot(robot_template("6-pss"))));
}

/// Base and plate alike, each strut straight up: the plate could be turned with all of them as they are.
TEST(StrutFile, StrutsThatDoNotHoldThePlateAreRefused) {
  const Robot robot = read_robot(robot_template("hexapod"));
  RobotDescription alike = robot.description();
  std::vector<LimbDescription> struts = alike.geometry.limbs;
  for (LimbDescription& strut : struts) strut.plate = 0.6 * strut.base;
  alike.geometry = geometry_of_limbs(Actuator::strut, struts);
  EXPECT_THAT([&] { Robot{alike}; }, ThrowsMessage<InvalidArgument>(HasSubstr("singular at (0, 0, 500) mm")));
}

/// Rods that stand upright, side by side, where their arms are 30 deg up: the plate could be turned and shifted.
TEST(ArmFile, RodsThatDoNotHoldThePlateAreRefused) {
  RobotDescription upright = read_robot(robot_template("6-rss")).description();
  std::vector<LimbDescription> limbs = upright.geometry.limbs;
  const double up = to_radians(30.0);
  for (LimbDescription& limb : limbs) limb.plate = limb.base + limb.arm * std::cos(up) * limb.at_zero.normalized();
  const double height = limbs[0].length + limbs[0].arm * std::sin(up);
  upright.geometry = geometry_of_limbs(Actuator::crank, limbs);
  upright.workspace = {.radius = 5.0, .height = 10.0, .top_z = height + 5.0, .max_tilt = to_radians(1.0)};
  EXPECT_THAT([&] { Robot{upright}; }, ThrowsMessage<InvalidArgument>(HasSubstr("singular at (0, 0, 335)")));
}

/// Where the plate is tilted so far that the way there goes through a singular pose.
TEST(StrutFile, WorkspacesWithASingularSurfaceInsideAreRefused) {
  for (const auto& [name, degrees] : {std::pair{"hexapod", 35.0}, {"6-pss", 25.0}}) {
    RobotDescription tilted = read_robot(robot_template(name)).description();
    tilted.workspace.max_tilt = to_radians(degrees);
    EXPECT_THAT([&] { Robot{tilted}; }, ThrowsMessage<InvalidArgument>(HasSubstr("workspace: singular "))) << name;
    tilted.workspace.max_tilt = to_radians(degrees - 10.0);
    EXPECT_NO_THROW(Robot{tilted}) << name;
  }
}

TEST(StrutFile, RobotsOfArmsDoNotTilt) {
  const std::string arms = robot_toml(catalogue::rotary_delta());
  std::string tilted = arms;
  tilted.replace(tilted.find("top_z_mm"), 0, "tilt_deg = 3\n");
  expect_refused(tilted, "expected nothing for a plate that stays level");
}

}  // namespace
}  // namespace paracal::io::robot_file_test
