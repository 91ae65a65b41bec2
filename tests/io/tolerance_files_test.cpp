#include <gmock/gmock.h>

#include <cmath>

#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/units.hpp"

namespace paracal::io::tolerance_files_test {
namespace {

using testing::AllOf, testing::ElementsAre, testing::HasSubstr, testing::IsEmpty, testing::Not, testing::StartsWith;

const Robot kRobot = catalogue::huang2016();
const Limbs& kLimbs = kRobot.limbs();

Tolerances read(const std::string& text, const Robot& robot = kRobot) {
  return read_tolerances({"t.toml", text}, robot);
}

const std::string kAll =
    "theta_offset_deg = 1\ne_mm = 1\narm_length_mm = 1\nalpha0_deg = 1\nbeta0_deg = 1\nrod_mean_mm = 1\n"
    "rod_difference_mm = 1\nwidth_difference_mm = 1\nalpha03_deg = 1\nbeta03_deg = 1\nalpha2_deg = 1\n";  // not beta2

TEST(ToleranceFile, ACompleteTableNeedsNoOthers) {
  const Tolerances tolerances = read(kAll + "beta2_deg = 0.5\n");
  EXPECT_EQ(tolerances["beta2"], to_radians(0.5));
  EXPECT_THAT(tolerances.assumed, IsEmpty());
}

TEST(ToleranceFile, MissingKeysAreRefusedWithBothWaysOut) {
  EXPECT_THAT(
      [] { read("\n[tolerances]\n" + kAll); },
      testing::ThrowsMessage<InputFileError>(AllOf(StartsWith("t.toml:2: "), HasSubstr("tolerances.others = \"exact\""),
                                                   HasSubstr("tolerances.others = \"generous\""),
                                                   HasSubstr("no beta2_deg"), Not(HasSubstr("alpha2_deg")))));
  EXPECT_THAT([] { read("rod_mean_mm = 1\n"); },
              testing::ThrowsMessage<InputFileError>(HasSubstr("theta_offset_deg, e_mm, arm_length_mm")));
}

TEST(ToleranceFile, OthersAreExactWhereItSaysSo) {
  const Tolerances tolerances = read("e_mm = 0.1\nothers = \"exact\"\n");
  EXPECT_EQ(tolerances["e_z"], 0.1);
  EXPECT_EQ(tolerances["theta_offset"], 0.0);
  ASSERT_EQ(tolerances.assumed.size(), 1u);
  EXPECT_THAT(tolerances.assumed[0], AllOf(HasSubstr("zero"), HasSubstr("theta_offset, arm_length"), HasSubstr("beta2"),
                                           Not(HasSubstr(" e,"))));
}

TEST(ToleranceFile, OthersAreGenerousWhereItSaysSo) {
  const Tolerances tolerances = read("e_mm = 0.1\nothers = \"generous\"\n");
  EXPECT_EQ(tolerances["e_z"], 0.1);
  EXPECT_EQ(tolerances["theta_offset"], generous_tolerances(kLimbs)["theta_offset"]);
  ASSERT_EQ(tolerances.assumed.size(), 1u);
  EXPECT_THAT(tolerances.assumed[0], AllOf(HasSubstr("default tolerances"), HasSubstr("theta_offset 1.5 deg"),
                                           HasSubstr("rod_mean 2.4 mm"), Not(HasSubstr(" e "))));
}

/// The table may stand in a robot file; beside it a misspelt one would be passed over.
TEST(ToleranceFile, BesideItStandsNothingUnknown) {
  const std::string table = "[tolerances]\n" + kAll + "beta2_deg = 1\n";
  EXPECT_EQ(read(robot_toml(kRobot))["rod_mean"], (*kRobot.tolerances())["rod_mean"]);
  EXPECT_THAT([&] { read(table + "[tolerance.measured]\nbeta2_deg = [0.1]\n"); },
              testing::ThrowsMessage<InputFileError>(AllOf(StartsWith("t.toml:14: "), HasSubstr("got \"tolerance\""))));
}

TEST(ToleranceFile, OthersAreOneOfTwo) {
  EXPECT_THAT([] { read("e_mm = 0.1\nothers = \"tight\"\n"); },
              testing::ThrowsMessage<InputFileError>(AllOf(StartsWith("t.toml:2: "), HasSubstr("\"tight\""))));
  EXPECT_THROW(read("e_mm = 0.1\nothers = 0\n"), InputFileError);
}

TEST(ToleranceFile, MeasuredPartsAreListed) {
  const Tolerances tolerances = read(kAll + "[measured]\nbeta2_deg = [0.1, 0.2]\n");
  EXPECT_THAT(tolerances.assumed, IsEmpty());
  EXPECT_EQ(tolerances.measured["beta2"].size(), 2u);
}

/// A rail's drive has a gain; where its carriage's joints are is said by e.
TEST(ToleranceFile, RailsListGainsInsteadOfArms) {
  std::string text = kAll + "beta2_deg = 1\n";
  text.replace(text.find("theta_offset_deg"), 16, "theta_offset_mm");
  EXPECT_THAT([&] { read(text, catalogue::linear_delta()); },
              testing::ThrowsMessage<InputFileError>(AllOf(HasSubstr("gain_mm_per_m"), HasSubstr("others"))));
  const std::string with_gains = text.replace(text.find("arm_length_mm"), 13, "gain_mm_per_m");
  EXPECT_THAT(read(with_gains, catalogue::linear_delta()).assumed, IsEmpty());
  EXPECT_EQ(read(with_gains, catalogue::linear_delta())["gain"], 1.0);
  EXPECT_THAT([&] { read(with_gains + "arm_length_mm = 1\n", catalogue::linear_delta()); },
              testing::ThrowsMessage<InputFileError>(HasSubstr("arm_length_mm")));
}

/// Who writes a robot down does not thereby state its tolerances.
TEST(ToleranceFile, WhatNobodyStatesStaysUnstated) {
  const Robot robot = catalogue::huang2016();
  const Robot again = read_robot({"r.toml", robot_toml(robot)});
  EXPECT_THAT(robot.tolerances()->assumed,
              ElementsAre(AllOf(HasSubstr("default tolerances"), HasSubstr("theta_offset 1.5 deg, e 3 mm"),
                                HasSubstr("rod_mean 2.4 mm"), Not(HasSubstr("alpha2")))));
  EXPECT_EQ(again.tolerances()->assumed, robot.tolerances()->assumed);
  EXPECT_THROW(read(kAll + "beta2_deg = 1\ngenerous = [\"gamma_deg\"]\n"), InputFileError);
}

TEST(ToleranceFile, ExactOthersReadBack) {
  const Tolerances tolerances = read("rod_mean_mm = 0.1\nothers = \"exact\"\n");
  const std::string text = tolerances_toml(tolerances, catalogue::huang2016().limbs());
  EXPECT_THAT(text, Not(HasSubstr("beta2")));
  EXPECT_EQ(read(text).assumed, tolerances.assumed);
}

/// What a drawing says stands instead of a number; the rest of the table is as ever.
TEST(ToleranceFile, AValueMayBeWhatADrawingSays) {
  const Tolerances tolerances = read(
      "arm_length_mm = \"IT8\"\nrod_mean_mm = \"950 ± 0.04\"\nrod_difference_mm = \"IT5\"\ne_mm = \"position dia "
      "0.05\"\n"
      "alpha2_deg = \"parallelism 0.02/100\"\nbeta2_deg = 0.5\nothers = \"exact\"\n");
  EXPECT_DOUBLE_EQ(tolerances["arm_length"], 0.0445);
  EXPECT_EQ(tolerances["rod_mean"], 0.04);
  EXPECT_DOUBLE_EQ(tolerances["rod_difference"], 0.04);
  EXPECT_EQ(tolerances["e_x"], 0.025);
  EXPECT_EQ(tolerances["e_z"], 0.025);
  EXPECT_EQ(tolerances["alpha2"], std::asin(0.0002));
  EXPECT_EQ(tolerances["beta2"], to_radians(0.5));
  EXPECT_EQ(tolerances.origin["arm_length"], Origin::stated);
  EXPECT_EQ(tolerances.assumed.size(), 1u);  // the exact ones
}

TEST(ToleranceFile, WhatNoDrawingSaysIsRefusedWithItsLine) {
  const auto refused = [](const std::string& line, const std::string& complaint) {
    EXPECT_THAT([&] { read("others = \"exact\"\n" + line + "\n"); },
                testing::ThrowsMessage<InputFileError>(AllOf(StartsWith("t.toml:2: "), HasSubstr(complaint))))
        << line;
  };
  refused(
      "arm_length_mm = \"376 +- 0.04\"",
      "arm_length_mm: expected a number, \"IT8\" or \"375 +- H\" (bore distance of the arm), got \"376 +- 0.04\": the "
      "robot's size is 375 mm");
  refused("theta_offset_deg = \"IT8\"", "theta_offset_deg: expected a number, got \"IT8\": an encoder's zero");
  refused("alpha2_deg = \"perpendicularity 0.02/100\"", "this does not limit the rotation");
  refused("e_mm = \"IT8\"", "e_mm: expected a number or \"position dia T\" (base joint)");
  refused("e_mm = [0.1, 0.1, 0.1]", "expected a number for e_mm, got an array");
}

/// The nominal size is that of each limb as it is meant to be, wherever its table stands in the file.
TEST(ToleranceFile, SizesAreThoseOfTheRobotOfItsFile) {
  std::string text = robot_toml(catalogue::rotary_delta());
  text = text.substr(0, text.find("[tolerances]"));
  const std::string states = "[tolerances]\nrod_mean_mm = \"IT7\"\nothers = \"exact\"\n";
  EXPECT_DOUBLE_EQ((*read_robot({"r.toml", text + states}).tolerances())["rod_mean"], 0.045);
  const std::string limbs = "[[limb]]\n[[limb]]\nrod_mean_mm = 60\n[[limb]]\n";  // 1010 mm
  EXPECT_DOUBLE_EQ((*read_robot({"r.toml", text + states + limbs}).tolerances())["rod_mean"], 0.0525);
  EXPECT_DOUBLE_EQ(read(states, read_robot({"r.toml", text + limbs}))["rod_mean"], 0.0525);
}

TEST(ToleranceFile, CommentsOfADrawingChangeNothing) {
  for (const Robot& robot : {catalogue::huang2016(), catalogue::linear_delta(), read_robot(robot_template("6-pss"))}) {
    const std::string plain = tolerances_toml(*robot.tolerances(), robot.limbs());
    const std::string said = tolerances_toml(*robot.tolerances(), robot);
    EXPECT_NE(said, plain);
    EXPECT_THAT(said, HasSubstr("  # "));
    EXPECT_EQ(tolerances_toml(read(said, robot), robot.limbs()), plain);
  }
}

/// Statements are of the sizes of limbs, so these are checked first.
TEST(ToleranceFile, StatementsOfARobotWithoutLimbsAreNotRead) {
  std::string text = robot_toml(catalogue::rotary_delta());
  text.replace(text.find("[0, 120, 240]"), 13, "[]");
  text.replace(text.find("rod_mean_mm = 2.4"), 17, "rod_mean_mm = \"951 +- 1\"");
  EXPECT_THAT(
      [&] {
        read_robot({"r.toml", text});
      },
      testing::ThrowsMessage<InputFileError>(
          HasSubstr("geometry.limb_azimuth_deg: expected 3 limbs for a rigid plate, got 0")));
}

TEST(Tolerances, ThePaperStatesTable2Alone) {
  EXPECT_THAT(catalogue::rotary_delta().tolerances()->assumed[0], HasSubstr("alpha2"));
  EXPECT_THAT(catalogue::linear_delta().tolerances()->assumed[0],
              AllOf(HasSubstr("theta_offset 3 mm"), HasSubstr("gain 1 mm/m"), Not(HasSubstr("arm_length"))));
}

TEST(Tolerances, ARobotWithoutAnyGetsGenerousOnesAndSaysSo) {
  RobotDescription description = catalogue::rotary_delta().description();
  description.tolerances.reset();
  EXPECT_EQ(tolerances_of(Robot(description)).assumed, catalogue::rotary_delta().tolerances()->assumed);
}

TEST(Tolerances, WhatADesignerChoosesIsStated) {
  Tolerances tolerances = generous_tolerances(kLimbs);
  tolerances.measured["rod_mean"] = {0.1};
  tolerances.state("rod_mean", 0.2);
  list_assumed(tolerances, catalogue::huang2016().limbs());
  EXPECT_EQ(tolerances.largest("rod_mean"), 0.2);
  EXPECT_NEAR(tolerances.std("rod_mean"), 0.2 / 3.0, 1e-15);
  EXPECT_THAT(tolerances.assumed, ElementsAre(Not(HasSubstr("rod_mean"))));
}

}  // namespace
}  // namespace paracal::io::tolerance_files_test
