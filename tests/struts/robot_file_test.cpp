#include <gmock/gmock.h>

#include <algorithm>
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
  for (LimbDescription& strut : alike.limbs) strut.plate = 0.6 * strut.base;
  EXPECT_THAT([&] { Robot{alike}; }, ThrowsMessage<InvalidArgument>(HasSubstr("singular at (0, 0, 500) mm")));
}

/// Rods that stand upright, side by side, where their arms are 30 deg up: the plate could be turned and shifted.
TEST(ArmFile, RodsThatDoNotHoldThePlateAreRefused) {
  RobotDescription upright = read_robot(robot_template("6-rss")).description();
  Limbs& limbs = upright.limbs;
  const double up = to_radians(30.0);
  for (LimbDescription& limb : limbs) limb.plate = limb.base + limb.arm * std::cos(up) * limb.at_zero.normalized();
  const double height = limbs[0].length + limbs[0].arm * std::sin(up);
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
  expect_refused(tilted, "expected nothing for a plate with the degrees of freedom x, y, z");
}

/// The template with its first limb alone, which stands for all.
std::string repeated(std::string_view kind, std::string_view keys) {
  std::string text = robot_template(kind).text;
  const std::size_t first = text.find("\n[[limb]]") + 1, second = text.find("\n[[limb]]", first) + 1;
  const std::size_t behind = text.find("\n[", text.rfind("\n[[limb]]") + 1);
  text.erase(second, behind - second);
  return text.insert(text.find('\n', first) + 1, std::string(keys) + "\n");
}

/// Dimensions of the template are rounded to 0.001 mm.
TEST(LimbTables, RepeatedAndMirroredLimbsAreThoseOfTheTemplate) {
  const Robot whole = read_robot(robot_template("6-rss"));
  const Robot robot = read_robot({"r.toml", repeated("6-rss", "repeat = 3\nmirrored = true")});
  const auto& limbs = robot.limbs();
  ASSERT_EQ(limbs.size(), 6u);
  for (const LimbDescription& wanted : whole.limbs()) {
    EXPECT_TRUE(std::ranges::any_of(limbs, [&](const LimbDescription& one) {
      const double off = (one.base - wanted.base).norm() + (one.plate - wanted.plate).norm() +
                         (one.axis - wanted.axis).norm() + (one.at_zero - wanted.at_zero).norm();
      return off < 0.01;
    })) << wanted.base.transpose();
  }
  EXPECT_EQ(robot_toml(read_robot({"r.toml", robot_toml(robot)})), robot_toml(robot));
}

TEST(LimbTables, CopiesThatMakeNoSenseAreRefused) {
  expect_refused(repeated("6-rss", "repeat = 2.5"), "expected a number of limbs from 1 to 8 for limb.repeat, got 2.5");
  expect_refused(repeated("6-rss", "repeat = 9"), "limb.repeat, got 9");
  expect_refused(repeated("6-rss", "repeat = 6\nmirrored = true"), "expected 6 to 8 limbs");
  expect_refused(repeated("6-rss", "repeat = 6\nmirrored = 1"), "limb.mirrored");
  expect_refused(repeated("hexapod", "parallelogram_width_mm = 60"), "expected an arm or a rail to carry");
}

constexpr const char* kDelta = R"(name = "rotary_delta"
[plate]
freedoms = ["x", "y", "z"]
[[limb]]
kind = "arm"
repeat = 3
base_joint_mm = [200, 0, 0]
plate_joint_mm = [45, 0, 0]
arm_mm = 180
axis = [0, -1, 0]
arm_at_zero = [1, 0, 0]
rod_mm = 400
parallelogram_width_mm = 80
[workspace]
radius_mm = 80
height_mm = 100
top_z_mm = -300
)";
constexpr const char* kShort = R"(name = "rotary_delta"
[geometry]
base_radius_mm = 200
plate_radius_mm = 45
arm_mm = 180
rod_mm = 400
parallelogram_width_mm = 80
limb_azimuth_deg = [0, 120, 240]
actuator = "revolute"
[workspace]
radius_mm = 80
height_mm = 100
top_z_mm = -300
)";

/// Limb by limb it is the Delta of the short form: all errors move it alike.
TEST(LimbTables, ADeltaLimbByLimbIsTheDelta) {
  const Robot robot = read_robot({"limbs.toml", kDelta}), wanted = read_robot({"short.toml", kShort});
  EXPECT_TRUE(robot.is_level());
  ASSERT_EQ(robot.parameters().size(), wanted.parameters().size());
  test::Random random;
  const SourceErrors errors = random.errors(wanted, 0.5, 2e-3);
  const Machine one = build(robot, errors), other = build(wanted, errors);
  for (int k = 0; k < 100; ++k) {
    const Pose pose = random.pose(wanted);
    const Joints joints = inverse(one, pose).joints;
    EXPECT_LT((joints - inverse(other, pose).joints).norm(), 1e-10);
    EXPECT_LT((forward(one, joints).plate.position - forward(other, joints).plate.position).norm(), 1e-8);
  }
}

TEST(LimbTables, JointsOfTwoUnitsAreRefused) {
  std::string text = kDelta;
  text.replace(text.find("repeat = 3"), 10, "repeat = 2");
  const std::string rail =
      "[[limb]]\nkind = \"rail\"\nbase_joint_mm = [0, 300, 0]\nplate_joint_mm = [0, 45, 0]\nrod_mm = 400\n"
      "parallelogram_width_mm = 80\ndirection = [0, 0, 1]\n";
  expect_refused(text.insert(text.find("[workspace]"), rail), "joint coordinates of one unit");
}

/// Three parallelograms, or six rods: fewer hold no plate without guides.
TEST(LimbTables, ParallelogramsWithTooFewRodsAreRefused) {
  std::string text = kDelta;
  text.replace(text.find("repeat = 3"), 10, "repeat = 2");
  const std::string arm =
      "[[limb]]\nkind = \"arm\"\nbase_joint_mm = [0, 200, 0]\nplate_joint_mm = [0, 45, 0]\nrod_mm = 400\narm_mm = 180\n"
      "axis = [1, 0, 0]\narm_at_zero = [0, 1, 0]\n";
  expect_refused(text.insert(text.find("[workspace]"), arm), "expected 6 rods or more");
}

TEST(ErrorTables, AreReadByTheNumberOfTheirLimb) {
  const Robot robot = read_robot({"limbs.toml", kDelta});
  const auto read = [&](const std::string& text) { return read_source_errors({"e.toml", text}, robot.joint_space()); };
  const SourceErrors errors = read("[[error]]\nlimb = 3\narm_length_mm = 0.5\n[[error]]\nlimb = 1\ne_mm = [1, 2, 3]\n");
  EXPECT_EQ(errors(2, "arm_length"), 0.5);
  EXPECT_EQ(errors(0, "e_y"), 2.0);
  EXPECT_EQ(errors(1, "arm_length"), 0.0);
  const std::string in_file = std::string(kDelta) + "[[error]]\nlimb = 2\nrod_mean_mm = 0.25\n";
  EXPECT_EQ(read(in_file)(1, "rod_mean"), 0.25);
  EXPECT_EQ(read_robot({"limbs.toml", in_file}).limbs()[1].length, robot.limbs()[1].length);
  const auto refused = [&](const std::string& text, const char* why) {
    EXPECT_THAT([&] { (void)read(text); }, ThrowsMessage<InputFileError>(HasSubstr(why)));
  };
  refused("[[error]]\nlimb = 4\n", "e.toml:2: expected a limb from 1 to 3");
  refused("[[error]]\nlimb = 1\n[[error]]\nlimb = 1\n", "e.toml:4: expected each limb once, got limb 1 again");
  refused("[[error]]\narm_length_mm = 1\n", "limb");
  refused("[[error]]\nlimb = 1\nplate_mm = [1, 2, 3]\n", "plate_mm");
}

}  // namespace
}  // namespace paracal::io::robot_file_test
