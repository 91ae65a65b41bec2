// What the owner of a printer types.

#include "broken_input.hpp"
#include "json_checks.hpp"
#include "printer/klipper_sets.hpp"
#include "printer/rotary_printer.hpp"

namespace paracal::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class PrinterCommand : public testing::Test {
 protected:
  std::string config(const std::string& id) const {
    for (const KlipperSet& set : klipper_sets()) {
      if (set.id == id) return set.config;
    }
    return {};
  }

  TemporaryFolder folder;
};

TEST_F(PrinterCommand, SaysWhatToDoAndWhatToSave) {
  folder.write("printer.cfg", config("K18"));
  const ProgramResult result = folder.run("calibrate --printer printer.cfg");
  EXPECT_EQ(result.exit_code, kDone);
  for (const char* said : {"accept the new values", "turned about z", "absolute",
                           "#*# [printer]\n#*# delta_radius = ", "#*# [stepper_c]\n#*# angle = 90.000000\n"}) {
    EXPECT_THAT(result.out, HasSubstr(said));
  }
  EXPECT_THAT(folder.run("calibrate --printer printer.cfg --write marlin").out, HasSubstr("\nM665 L"));
}

TEST_F(PrinterCommand, JsonHasTheCalibrationAndThePrinter) {
  folder.write("printer.cfg", config("K18"));
  const json object = json_of(folder.run("calibrate --printer printer.cfg --json"));
  ASSERT_TRUE(has_keys(object, "accepted parameters planes distance_bias_mm printer"));
  const json& printer = object["printer"];
  ASSERT_TRUE(has_keys(
      printer, "advice findings lines saved firmware new accuracy_saved accuracy_new left_out left_out_firmware"));
  EXPECT_EQ(printer["advice"], "accept_new");
  EXPECT_EQ(printer["firmware"]["parameters"], 9);
  EXPECT_LT(printer["accuracy_new"]["shape_rms_mm"], printer["accuracy_saved"]["shape_rms_mm"]);
}

TEST_F(PrinterCommand, WarnsWhereNothingIsGained) {
  folder.write("printer.cfg", config("K37"));
  const ProgramResult result = folder.run("calibrate --printer printer.cfg");
  EXPECT_THAT(result.out, HasSubstr("the saved values do not belong to these readings"));
  EXPECT_EQ(result.exit_code, result.out.find("warning") == std::string::npos ? kDone : kVerdictIsNo);
}

TEST_F(PrinterCommand, OtherFirmwaresGiveARobot) {
  folder.write("config.g", "M665 R105.6 L215.0 B85 H235\nM666 X0.2 Y-0.1 Z0\n");
  ASSERT_EQ(folder.run("robot --printer config.g --firmware reprapfirmware --out robot.toml").exit_code, kDone);
  EXPECT_THAT(folder.read("robot.toml"), HasSubstr("actuator = \"linear\""));
  EXPECT_EQ(folder.run("sensitivity --robot robot.toml").exit_code, kDone);
}

TEST_F(PrinterCommand, RotaryDeltasAreToldInTheWordsOfTheirFirmware) {
  folder.write("printer.cfg", rotary_printer().config);
  const ProgramResult result = folder.run("calibrate --printer printer.cfg");
  for (const char* said : {"#*# shoulder_radius = ", "#*# shoulder_height = ", "#*# upper_arm_length = "}) {
    EXPECT_THAT(result.out, HasSubstr(said));
  }
  const json object = json_of(folder.run("calibrate --printer printer.cfg --json --write reprapfirmware"));
  EXPECT_THAT(object["printer"]["lines"].get<std::string>(), HasSubstr("\nM669 K10 U"));
  EXPECT_TRUE(has_keys(object["printer"]["new"],
                       "shoulder_radius_mm shoulder_height_mm upper_arm_length_mm "
                       "lower_arm_length_mm tower_angle_deg position_endstop_mm"));
  const ProgramResult refused = folder.run("calibrate --printer printer.cfg --write marlin --report page.html");
  EXPECT_EQ(refused.exit_code, kWrongUsage);
  EXPECT_THAT(refused.err, HasSubstr("--write marlin: expected a linear delta, since Marlin knows no rotary ones"));
  EXPECT_EQ(folder.names(), std::set<std::string>{"printer.cfg"});
  folder.write("config.g", "M669 K10 U170 L320 R34 H412.5 A-30:60\n");
  ASSERT_EQ(folder.run("robot --printer config.g --firmware reprapfirmware --out robot.toml").exit_code, kDone);
  EXPECT_EQ(folder.run("sensitivity --robot robot.toml").exit_code, kDone);
}

TEST_F(PrinterCommand, DrawsAPage) {
  folder.write("printer.cfg", config("K18"));
  ASSERT_EQ(folder.run("calibrate --printer printer.cfg --report page.html").exit_code, kDone);
  EXPECT_THAT(folder.read("page.html"), HasSubstr("accept the new values"));
}

TEST_F(PrinterCommand, IsRefusedWithoutReadings) {
  std::string text = config("K18");
  text.resize(text.find("#*# [delta_calibrate]"));
  folder.write("printer.cfg", text);
  const ProgramResult result = folder.run("calibrate --printer printer.cfg");
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(result.err, HasSubstr("printer.cfg: expected heights of the bed"));
  EXPECT_EQ(folder.run("calibrate --printer printer.cfg --measurements points.csv").exit_code, kWrongUsage);
  EXPECT_EQ(folder.run("calibrate").exit_code, kWrongUsage);
}

}  // namespace
}  // namespace paracal::test
