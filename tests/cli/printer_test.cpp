// What the owner of a printer types.

#include <fmt/format.h>
#include <sys/stat.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "broken_input.hpp"
#include "json_checks.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/machine_codes.hpp"
#include "paracal/printer/delta_geometry.hpp"
#include "paracal/units.hpp"
#include "printer/klipper_sets.hpp"
#include "printer/rotary_printer.hpp"

namespace paracal::test::printer_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

class PrinterCommand : public testing::Test {
 protected:
  std::string config(const std::string& id) const {
    for (const KlipperSet& set : klipper_sets()) {
      if (set.id == id) return set.config;
    }
    return {};
  }

  /// K18 whose owner has put in other rods since: what is saved is 0.5 mm off, and the readings tell.
  static std::string outdated() {
    for (const KlipperSet& set : klipper_sets()) {
      if (set.id != "K18") continue;
      std::string text = set.config;
      const std::string saved = "#*# delta_radius = 161.820563";
      return text.replace(text.find(saved), saved.size(), "#*# delta_radius = 160.3");
    }
    return {};
  }

  TemporaryFolder folder;
};

TEST_F(PrinterCommand, SaysWhatToDoAndWhatToSave) {
  folder.write("printer.cfg", outdated());
  const ProgramResult result = folder.run("calibrate --printer printer.cfg");
  EXPECT_EQ(result.exit_code, kDone);
  EXPECT_THAT(result.out, StartsWith("Change endstops"));
  for (const char* said : {"first layer ", "size of prints ", "\n\n#*# [printer]\n#*# delta_radius = ",
                           "#*# [stepper_c]\n#*# angle = 90.000000000\n", "What this rests on: --details\n"}) {
    EXPECT_THAT(result.out, HasSubstr(said));
  }
  EXPECT_THAT(result.out, Not(HasSubstr("- Rung ")));
  const ProgramResult details = folder.run("calibrate --printer printer.cfg --details");
  for (const char* said : {"- Rung height: first layer ", "- Noise of a height ", "rotates about z"}) {
    EXPECT_THAT(details.out, HasSubstr(said));
  }
  EXPECT_THAT(folder.run("calibrate --printer printer.cfg --write marlin").out, HasSubstr("\nM665 L"));
}

/// The values saved on K18 are its firmware's fit, and nothing is better by more than chance.
TEST_F(PrinterCommand, KeepsWhatIsGood) {
  folder.write("printer.cfg", config("K18"));
  const ProgramResult result = folder.run("calibrate --printer printer.cfg --apply");
  EXPECT_EQ(result.exit_code, kVerdictIsNo);
  EXPECT_THAT(result.out, StartsWith("Keep your values: "));
  EXPECT_THAT(result.out, HasSubstr("No configuration is written, because no new values are advised."));
  EXPECT_THAT(result.out, Not(HasSubstr("#*#")));
  EXPECT_EQ(folder.names(), std::set<std::string>{"printer.cfg"});
}

/// A radius typed 3 mm too large, with a levelled rim: the usual first calibration.
std::string first_calibration() {
  const std::array<double, 3> angles{to_radians(210.0), to_radians(330.0), to_radians(90.0)};
  const DeltaGeometry actual{
      .radius = 137.8, .tower_angle = angles, .rod = {280, 280, 280}, .endstop = {300, 300, 300}};
  DeltaGeometry saved = actual;
  saved.radius = 140.8;
  const Eigen::Vector3d rim(0.0, 80.0, 0.0);
  for (int round = 0; round < 6; ++round) {
    const double z = nozzle(saved, *drops_to(actual, rim))->z();
    for (double& endstop : saved.endstop) endstop -= z;
  }
  std::string text = fmt::format("[printer]\nkinematics: delta\ndelta_radius: {}\n", saved.radius);
  for (const char* tower : {"a", "b", "c"}) {
    text += fmt::format("[stepper_{}]\nstep_distance: 0.0125\narm_length: 280\nposition_endstop: {:.6f}\n", tower,
                        saved.endstop[0]);
  }
  text += "[delta_calibrate]\nradius: 80\n";
  for (int k = 0; k < 13; ++k) {
    const double radius = k == 0 ? 0.0 : k % 2 == 1 ? 80.0 : 40.0, angle = to_radians(30.0 * k);
    const JointDrops drops = *drops_to(actual, {radius * std::cos(angle), radius * std::sin(angle), 0.0});
    text += fmt::format("height{0}: 0\nheight{0}_pos: {1:.3f},{2:.3f},{3:.3f}\n", k, drops[0] / 0.0125,
                        drops[1] / 0.0125, drops[2] / 0.0125);
  }
  return text;
}

/// What only a radius levels is advised from heights alone: exit code 0, and what is applied is kept by the next
/// calibration.
TEST_F(PrinterCommand, AFirstCalibrationIsAChange) {
  folder.write("printer.cfg", first_calibration());
  const json found = json_of(folder.run("calibrate --printer printer.cfg --json"))["printer"];
  EXPECT_EQ(found["advice"], "accept_new");
  EXPECT_NE(found["rung"], "height");
  EXPECT_EQ(found["common_shift"]["is_stated"], false);
  const ProgramResult applied = folder.run("calibrate --printer printer.cfg --apply");
  EXPECT_EQ(applied.exit_code, kDone);
  EXPECT_THAT(applied.out, StartsWith("Change endstops"));
  EXPECT_THAT(folder.read("printer.cfg"), testing::ContainsRegex("delta_radius: 137\\.[78]"));
  EXPECT_EQ(folder.run("calibrate --printer printer.cfg").exit_code, kVerdictIsNo);
}

TEST_F(PrinterCommand, HeightsOfOnePlaceAreRefusedWithTheFile) {
  std::string text = first_calibration();
  text = text.substr(0, text.find("height0: 0"));
  folder.write("printer.cfg", text);
  folder.write("heights.csv", "x_mm,y_mm,z_mm,height_mm\n0,0,0,0\n0,1,10,10\n0,0,20,20\n");
  const ProgramResult result = folder.run("calibrate --printer printer.cfg --readings heights.csv");
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(result.err,
              HasSubstr("printer.cfg: expected heights across the bed, got all 3 within 5 mm of (0, 0) mm"));
}

TEST_F(PrinterCommand, WritesTheWholeConfiguration) {
  folder.write("printer.cfg", outdated());
  const ProgramResult result = folder.run("calibrate --printer printer.cfg --config new.cfg");
  EXPECT_EQ(result.exit_code, kDone);
  EXPECT_EQ(folder.read("printer.cfg"), outdated());
  EXPECT_THAT(folder.read("new.cfg"), HasSubstr("serial: /dev/ttyUSB0  # not ours"));
  // Said of it again: nothing to change.
  const ProgramResult again = folder.run("calibrate --printer new.cfg");
  EXPECT_EQ(again.exit_code, kVerdictIsNo);
  EXPECT_THAT(again.out, StartsWith("Keep your values: "));
  EXPECT_EQ(folder.run("calibrate --printer printer.cfg --config printer.cfg").exit_code, kWrongUsage);
  folder.write("config.g", "M665 R105.6 L215.0 H235\n");
  const ProgramResult refused =
      folder.run("calibrate --printer config.g --firmware marlin --readings printer.cfg --apply");
  EXPECT_EQ(refused.exit_code, kWrongUsage);
  EXPECT_THAT(refused.err, HasSubstr("--apply: expected Klipper's printer.cfg, got --firmware marlin"));
}

TEST_F(PrinterCommand, AppliesWithABackupAndADiff) {
  folder.write("printer.cfg", outdated());
  const ProgramResult result = folder.run("calibrate --printer printer.cfg --apply");
  EXPECT_EQ(result.exit_code, kDone);
  EXPECT_THAT(result.out, HasSubstr(": -#*# delta_radius = 160.3\n"));
  EXPECT_THAT(result.out, HasSubstr(": +#*# delta_radius = 16"));
  const std::set<std::string> names = folder.names();
  ASSERT_EQ(names.size(), 2u);
  const std::string kept = *std::ranges::find_if(names, [](const std::string& one) { return one != "printer.cfg"; });
  EXPECT_THAT(kept, testing::MatchesRegex("printer-[0-9]{8}_[0-9]{6}.cfg"));
  EXPECT_EQ(folder.read(kept), outdated());
  EXPECT_THAT(folder.run("calibrate --printer printer.cfg").out, StartsWith("Keep your values: "));
}

/// The name of the second file in a folder.
std::string other_than_printer(const TemporaryFolder& folder) {
  const std::set<std::string> names = folder.names();
  EXPECT_EQ(names.size(), 2u);
  return *std::ranges::find_if(names, [](const std::string& one) { return one != "printer.cfg"; });
}

/// What was there is kept byte for byte, whatever wrote it, and read by nobody else; what is new stands in the same
/// letters.
TEST_F(PrinterCommand, KeepsEveryByteOfWhatItChanges) {
  const std::string plain = outdated(), comment = "# Me\xC3\x9Fpunkt \xE2\x82\xAC\n" + plain;
  std::string crlf;
  for (const char c : plain) c == '\n' ? crlf += "\r\n" : crlf += c;
  const auto utf16 = [](const std::string& text, io::Encoding encoding) { return io::encoded(text, encoding); };
  const std::string wide_mark = utf16("", io::Encoding::utf16_little_endian);
  ASSERT_EQ(wide_mark, "\xFF\xFE");
  const std::vector<std::string> texts{comment,
                                       std::string(io::kByteOrderMark) + comment,
                                       utf16(comment, io::Encoding::utf16_little_endian),
                                       utf16(comment, io::Encoding::utf16_big_endian),
                                       "# Me\xDFpunkt\n" + plain,
                                       crlf,
                                       plain.substr(0, plain.find_last_not_of('\n') + 1)};
  for (std::size_t k = 0; k < texts.size(); ++k) {
    const TemporaryFolder own;
    own.write("printer.cfg", texts[k]);
    std::filesystem::permissions(own.path() / "printer.cfg", std::filesystem::perms(0600));
    ASSERT_EQ(own.run("calibrate --printer printer.cfg --apply").exit_code, kDone) << k;
    const std::string kept = other_than_printer(own);
    EXPECT_EQ(own.read(kept), texts[k]) << k;
    EXPECT_EQ(std::filesystem::status(own.path() / kept).permissions(), std::filesystem::perms(0600)) << k;
    const std::string changed = own.read("printer.cfg");
    const bool is_wide = k == 2 || k == 3;
    EXPECT_EQ(changed.substr(0, 2), texts[k].substr(0, 2)) << k;
    EXPECT_EQ(changed.size() % 2 == 0 || !is_wide, true) << k;
    EXPECT_NE(changed, texts[k]) << k;
    EXPECT_THAT(own.run("calibrate --printer printer.cfg").out, StartsWith("Keep your values: ")) << k;
  }
}

/// Somebody else edits the configuration at any moment: that edit is in the file, or nothing was changed.
TEST_F(PrinterCommand, LosesNoEditMadeMeanwhile) {
  const int moments = every_machine() ? 200 : 8;
  const std::string edit = "# mine\n";
  const auto begin = std::chrono::steady_clock::now();
  folder.write("printer.cfg", outdated());
  ASSERT_EQ(folder.run("calibrate --printer printer.cfg --apply").exit_code, kDone);
  const auto lasts = std::chrono::steady_clock::now() - begin;
  int refused = 0;
  for (int k = 0; k < moments; ++k) {
    const TemporaryFolder own;
    const std::string path = own.write("printer.cfg", outdated());
    std::thread editor([&, when = lasts * (2 * k + 1) / (2 * moments)] {
      std::this_thread::sleep_for(when);
      if (k % 3 == 0) return void(std::ofstream(path, std::ios::app) << edit);
      const std::string text = read_text(path);
      const std::string where = k % 3 == 1 ? path : path + ".new";
      std::ofstream(where) << text << edit;
      if (where != path) std::filesystem::rename(where, path);
    });
    const ProgramResult result = own.run("calibrate --printer printer.cfg --apply");
    editor.join();
    const std::string text = own.read("printer.cfg");
    EXPECT_TRUE(text.ends_with(edit)) << k;
    if (result.exit_code != kWrongUsage) continue;
    ++refused;
    EXPECT_EQ(text, outdated() + edit) << k;
    EXPECT_EQ(own.names().size(), 1u) << k;
    EXPECT_THAT(result.err, HasSubstr("printer.cfg: expected the file as it was read, got a changed one")) << k;
  }
  EXPECT_GT(refused, 0);
}

/// Its errors would count from values that the firmware no longer has: programs would be corrected twice.
TEST_F(PrinterCommand, WritesNoCalibrationOfValuesThatItReplaces) {
  folder.write("printer.cfg", outdated());
  const ProgramResult result = folder.run("calibrate --printer printer.cfg --apply --out calibration.json");
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.err, HasSubstr("--apply: expected no --out with it"));
  EXPECT_EQ(folder.names(), std::set<std::string>{"printer.cfg"});
  EXPECT_EQ(folder.read("printer.cfg"), outdated());
}

/// Every endstop of a configuration so much higher than it is.
std::string with_endstops_higher(std::string text, double by) {
  const std::string key = "position_endstop = ";
  for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
    const std::size_t begin = at + key.size(), end = text.find('\n', begin);
    text.replace(begin, end - begin, fmt::format("{:.6f}", std::stod(text.substr(begin, end - begin)) + by));
  }
  return text;
}

/// The bed stands 32 mm higher than the file has it: stated, and followed by no line that is printed or written unless
/// the owner says so. Written down before: what is advised without that moves no endstop by more than 0.5 mm.
TEST_F(PrinterCommand, FollowsACommonShiftOnlyWhereItIsAccepted) {
  const std::string saved = with_endstops_higher(outdated(), 32.0);
  folder.write("printer.cfg", saved);
  const json apart = json_of(folder.run("calibrate --printer printer.cfg --json"))["printer"];
  EXPECT_EQ(apart["advice"], "accept_new");
  EXPECT_NEAR(apart["common_shift_mm"].get<double>(), 32.0, 0.5);
  EXPECT_EQ(apart["common_shift"]["is_stated"], true);
  EXPECT_EQ(apart["common_shift"]["is_accepted"], false);
  EXPECT_EQ(apart["common_shift"]["likely_causes"].size(), 5u);
  const json accepted = json_of(folder.run("calibrate --printer printer.cfg --accept-shift --json"))["printer"];
  EXPECT_EQ(accepted["common_shift"]["is_accepted"], true);
  for (std::size_t tower = 0; tower < 3; ++tower) {
    const auto endstop = [&](const json& geometry) { return geometry["position_endstop_mm"][tower].get<double>(); };
    EXPECT_NEAR(endstop(apart["new"]), endstop(apart["saved"]["geometry"]), 0.5);
    EXPECT_NEAR(endstop(accepted["new"]), endstop(apart["new"]) - 32.0, 0.5);
    EXPECT_NEAR(endstop(accepted["new"]), endstop(apart["common_shift"]), 0.5);
  }
  const ProgramResult result = folder.run("calibrate --printer printer.cfg --apply");
  EXPECT_THAT(result.out, HasSubstr("All heights are off by +32."));
  EXPECT_THAT(result.out, HasSubstr("add --accept-shift"));
  const std::string written = folder.read("printer.cfg");
  const auto last_endstop = [](const std::string& text) {
    return std::stod(text.substr(text.rfind("position_endstop = ") + 19));
  };
  EXPECT_NEAR(last_endstop(written), last_endstop(saved), 0.5);
  folder.write("again.cfg", saved);
  EXPECT_EQ(folder.run("calibrate --printer again.cfg --accept-shift --config new.cfg").exit_code, kDone);
  EXPECT_NEAR(last_endstop(folder.read("new.cfg")), last_endstop(outdated()), 0.5);
  const ProgramResult kept = folder.run("calibrate --printer again.cfg --accept-shift --out calibration.json");
  EXPECT_EQ(kept.exit_code, kWrongUsage);
  EXPECT_THAT(kept.err, HasSubstr("--accept-shift: expected no --out with it"));
}

/// Where nothing of the shape is to be changed the saved values follow the shift all the same, and nothing else does.
TEST_F(PrinterCommand, AnAcceptedShiftMovesTheSavedValues) {
  folder.write("printer.cfg", with_endstops_higher(config("K18"), -3.0));
  const ProgramResult apart = folder.run("calibrate --printer printer.cfg --config none.cfg");
  EXPECT_EQ(apart.exit_code, kVerdictIsNo);
  EXPECT_THAT(apart.out, HasSubstr("All heights are off by -2.96 mm or more: "));
  EXPECT_THAT(apart.out, HasSubstr("Likely causes of this common shift: the trigger height of the probe"));
  EXPECT_EQ(folder.names(), std::set<std::string>{"printer.cfg"});
  const ProgramResult accepted = folder.run("calibrate --printer printer.cfg --accept-shift");
  EXPECT_EQ(accepted.exit_code, kDone);
  EXPECT_THAT(accepted.out, StartsWith("Accept the saved values with the common shift"));
  EXPECT_THAT(accepted.out, HasSubstr("#*# [stepper_c]"));
}

TEST_F(PrinterCommand, SaysWhichLineIsInForce) {
  std::string text = outdated();
  text.insert(text.find("max_velocity"), "delta_radius: 161.0\n");
  folder.write("printer.cfg", text);
  const ProgramResult result = folder.run("calibrate --printer printer.cfg --details");
  EXPECT_THAT(result.out, HasSubstr("printer.cfg:6: delta_radius 161.0 of [printer] is in force"));
}

TEST_F(PrinterCommand, DoubtsAFileThatCannotBe) {
  std::string text = config("K35");
  for (std::size_t at = text.find("step_distance: "); at != std::string::npos;
       at = text.find("step_distance: ", at + 1)) {
    const std::size_t begin = at + 15, end = text.find('\n', at);
    text.replace(begin, end - begin, std::to_string(0.5 * std::stod(text.substr(begin, end - begin))));
  }
  folder.write("printer.cfg", text);
  const ProgramResult result = folder.run("calibrate --printer printer.cfg");
  EXPECT_EQ(result.exit_code, kVerdictIsNo);
  EXPECT_THAT(result.out, HasSubstr("the readings fit the file if the steps of all towers are 2 times as large"));
  EXPECT_THAT(result.out, StartsWith("Check your file and your readings"));
  EXPECT_THAT(result.out, Not(HasSubstr("#*#")));
}

TEST_F(PrinterCommand, JsonHasTheCalibrationAndThePrinter) {
  folder.write("printer.cfg", outdated());
  const json object = json_of(folder.run("calibrate --printer printer.cfg --json"));
  ASSERT_TRUE(has_keys(object, "accepted parameters planes distance_bias_mm printer"));
  const json& printer = object["printer"];
  ASSERT_TRUE(has_keys(printer,
                       "advice rung findings details ladder lines saved firmware new bed print_radius_mm noise_mm "
                       "excluded uncheckable common_shift_mm common_shift"));
  EXPECT_EQ(printer["advice"], "accept_new");
  EXPECT_EQ(printer["firmware"]["parameters"], 9);
  ASSERT_EQ(printer["ladder"].size(), 5u);
  EXPECT_EQ(printer["ladder"][0]["rung"], "saved");
  for (const json& one : printer["ladder"]) {
    if (one["rung"] != printer["rung"]) continue;
    EXPECT_EQ(one["geometry"], printer["new"]);
    EXPECT_EQ(one["is_allowed"], true);
    EXPECT_GE(one["chance_better"], 0.95);
    EXPECT_LT(one["first_layer_mm"]["value"], printer["ladder"][0]["first_layer_mm"]["value"]);
  }
  EXPECT_EQ(printer["bed"].size(), 61u);
}

/// What the firmware has no number for, or has not been told, a filter of its programs puts right.
TEST_F(PrinterCommand, ItsCalibrationFiltersProgramsInTheFirmwaresCoordinates) {
  folder.write("printer.cfg", outdated());
  ASSERT_EQ(folder.run("calibrate --printer printer.cfg --out calibration.json").exit_code, kDone);
  folder.write("part.gcode", "G90\nG92 E0\nG1 X50.000 Y0.000 Z0.200 F1800\nG1 X-30.000 Y40.000 Z10.000 E0.5\n");
  const std::string filter = "export --calibration calibration.json --target gcode --input part.gcode";
  const ProgramResult result = folder.run(words(filter + " --out filtered.gcode --json"));
  ASSERT_EQ(result.exit_code, kDone) << result.err;
  EXPECT_LT(json::parse(result.out)["origin_mm"][2].get<double>(), -100.0);
  double x = 0.0, y = 0.0, z = 0.0;
  const std::string text = folder.read("filtered.gcode");
  ASSERT_EQ(std::sscanf(text.c_str(), "G90\nG92 E0\nG1 X%lf Y%lf Z%lf F1800\nG1 X", &x, &y, &z), 3) << text;
  const double moved = std::hypot(x - 50.0, y, z - 0.2);
  EXPECT_GT(moved, 0.1);  // a radius that is 1.5 mm off is felt at 50 mm
  EXPECT_LT(moved, 1.5);
  EXPECT_NE(folder.run(words(filter + " --origin 0,0,0")).out, text);
}

TEST_F(PrinterCommand, WarnsWhereNothingIsGained) {
  folder.write("printer.cfg", config("K37"));
  const ProgramResult result = folder.run("calibrate --printer printer.cfg");
  EXPECT_THAT(folder.run("calibrate --printer printer.cfg --details").out,
              HasSubstr("The saved values are not the firmware's fit of these readings: they leave "));
  EXPECT_EQ(result.exit_code, result.out.starts_with("Change") ? kDone : kVerdictIsNo);
}

TEST_F(PrinterCommand, OtherFirmwaresGiveARobot) {
  folder.write("config.g", "M665 R105.6 L215.0 B85 H235\nM666 X0.2 Y-0.1 Z0\n");
  ASSERT_EQ(folder.run("robot --printer config.g --firmware reprapfirmware --out robot.toml").exit_code, kDone);
  EXPECT_THAT(folder.read("robot.toml"), HasSubstr("actuator = \"linear\""));
  EXPECT_EQ(folder.run("sensitivity --robot robot.toml").exit_code, kDone);
}

TEST_F(PrinterCommand, OtherFirmwaresSettingsAreRecognised) {
  const std::string marlin =
      "echo:; Endstop adjustment:\necho:  M666 X0.00 Y-0.10 Z-0.30\necho:; Delta settings:\n"
      "echo:  M665 L215.00 R105.60 H235.00 S80.00 X0.00 Y0.00 Z0.00 A0.00 B0.00 C0.00\n";
  const auto refused = [&](const std::string& text, const std::string& message) {
    folder.write("settings.txt", text);
    for (const char* command : {"calibrate", "robot"}) {
      const ProgramResult result = folder.run(std::string(command) + " --printer settings.txt");
      EXPECT_EQ(result.exit_code, kBadInputFile);
      EXPECT_THAT(result.err, HasSubstr("settings.txt: expected " + message + "\n"));
    }
  };
  const std::string add = "Klipper's printer.cfg, got the settings of another firmware; add --firmware ";
  refused(marlin, add + "marlin");
  refused("M665 R105.6 L215.1:215:214.9 B85 H235\nM666 X0.2 Y-0.1 Z0\n", add + "reprapfirmware");
  refused("M669 K10 U170 L320 R34 H412.5 A-30:60\n", add + "reprapfirmware");
  refused("M665 R105.6 L215 H235\n", add + "marlin or --firmware reprapfirmware");
  refused("echo:  M92 X80.00 Y80.00 Z80.00\n", "kinematics in [printer], got none");
  refused("[include missing.cfg]\n[gcode_macro M665]\ngcode: M665 R105.6 L215 H235\n",
          "kinematics in [printer], got none; it may be in missing.cfg, which settings.txt:1 includes but is "
          "missing");
  folder.write("settings.txt", marlin);
  EXPECT_EQ(folder.run("robot --printer settings.txt --firmware marlin").exit_code, kDone);
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
  EXPECT_THAT(refused.err, HasSubstr("--write marlin: expected a linear delta, got a rotary one"));
  EXPECT_EQ(folder.names(), std::set<std::string>{"printer.cfg"});
  folder.write("config.g", "M669 K10 U170 L320 R34 H412.5 A-30:60\n");
  ASSERT_EQ(folder.run("robot --printer config.g --firmware reprapfirmware --out robot.toml").exit_code, kDone);
  EXPECT_EQ(folder.run("sensitivity --robot robot.toml").exit_code, kDone);
}

/// The same readings by way of tables and M-codes; these hold four digits.
TEST_F(PrinterCommand, OtherFirmwaresHaveTheirReadingsInTables) {
  const RotaryPrinter printer = rotary_printer();
  const double highest = to_degrees(homed_joints(printer.saved)[0]);
  folder.write("config.g", fmt::format("{}M669 K10 A-60:{:.6f}\n",
                                       io::machine_codes(printer.saved, io::CodeDialect::reprapfirmware), highest));
  std::string heights = "x_mm,y_mm,z_mm,height_mm\n";
  for (const BedReading& one : printer.readings.heights) {
    const Eigen::Vector3d p = *nozzle(printer.saved, one.drops);
    heights += fmt::format("{},{},{},{}\n", p.x(), p.y(), p.z(), one.height);
  }
  std::string distances = "from_x_mm,from_y_mm,to_x_mm,to_y_mm,distance_mm\n";
  for (const PrintedDistance& one : printer.readings.distances) {
    const Eigen::Vector3d from = *nozzle(printer.saved, one.from), to = *nozzle(printer.saved, one.to);
    distances += fmt::format("{},{},{},{},{}\n", from.x(), from.y(), to.x(), to.y(), one.distance);
  }
  folder.write("heights.csv", heights);
  folder.write("distances.csv", distances);
  folder.write("printer.cfg", printer.config);
  const json object = json_of(
      folder.run("calibrate --printer config.g --firmware reprapfirmware --readings heights.csv,distances.csv --json"));
  const json expected = json_of(folder.run("calibrate --printer printer.cfg --json"));
  EXPECT_EQ(object["inputs"].size(), 3u);
  EXPECT_EQ(object["printer"]["advice"], expected["printer"]["advice"]);
  EXPECT_THAT(object["printer"]["lines"].get<std::string>(), HasSubstr("\nM669 K10 U"));
  for (const char* key : {"shoulder_radius_mm", "shoulder_height_mm", "position_endstop_mm", "lower_arm_length_mm"}) {
    const json found = json::array({object["printer"]["new"][key]}).flatten(),
               wanted = json::array({expected["printer"]["new"][key]}).flatten();
    ASSERT_EQ(found.size(), wanted.size());
    for (const auto& [path, value] : wanted.items()) {
      EXPECT_NEAR(found[path].get<double>(), value.get<double>(), 0.02) << key << path;
    }
  }
}

TEST_F(PrinterCommand, RefusesReadingsThatCannotBe) {
  folder.write("config.g", "M665 R105.6 L215.0 H235\n");
  const auto refused = [&](const std::string& text, const std::string& part) {
    folder.write("readings.csv", text);
    const ProgramResult result =
        folder.run("calibrate --printer config.g --firmware marlin --readings readings.csv --out result.json");
    EXPECT_EQ(result.exit_code, kBadInputFile);
    EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_FALSE(folder.names().contains("result.json"));
  };
  refused("x_mm,y_mm,z_mm\n0,0,0.1\n300,0,0.1\n",
          "readings.csv:3: expected a position that the printer reaches, got (300, 0, 0.1) mm");
  refused("x_mm,y_mm\n0,0\n", "z_mm");
  refused("x_mm,y_mm,z_mm,bed_mm\n0,0,0,1\n", "bed_mm");
  refused("from_x_mm,from_y_mm,to_x_mm,to_y_mm,distance_mm\n0,0,50,0,-50\n",
          "expected distance_mm of at least 1, got -50");
  refused("from_x_mm,from_y_mm,to_x_mm,to_y_mm,distance_mm\n0,0,50,0,0.001\n", "of at least 1, got 0.001");
  refused("from_x_mm,from_y_mm,to_x_mm,to_y_mm,distance_mm\n0,0,50,0,50\n",
          "config.g: expected heights of the bed beside the distances, got none: add a table with the columns x_mm");
  folder.write("again.csv", folder.read("readings.csv"));
  const ProgramResult twice =
      folder.run("calibrate --printer config.g --firmware marlin --readings readings.csv,again.csv");
  EXPECT_EQ(twice.exit_code, kBadInputFile);
  EXPECT_THAT(twice.err, HasSubstr("again.csv: expected other readings, got those of readings.csv again"));
  EXPECT_EQ(folder.run("calibrate --readings readings.csv").exit_code, kWrongUsage);
}

/// The same rows pasted twice are the same readings; not to the last digit, they are others.
TEST_F(PrinterCommand, RowsThatArePastedTwiceCountOnce) {
  folder.write("config.g", "M665 R105.6 L215.0 B85 H235.7 X0.2 Y-0.1 Z0\nM666 X-0.3 Y0.2 Z0.1\n");
  std::string once = "x_mm,y_mm,z_mm,height_mm\n", twice = once;
  for (int k = 0; k < 13; ++k) {
    const double angle = 0.9 * k, radius = k == 0 ? 0.0 : k % 2 == 0 ? 80.0 : 45.0;
    const std::string row = fmt::format("{:.3f},{:.3f},0,{:.3f}\n", radius * std::cos(angle), radius * std::sin(angle),
                                        0.1 + 0.02 * std::sin(3.0 * k));
    once += row;
    twice += row + row;
  }
  folder.write("once.csv", once);
  folder.write("twice.csv", twice);
  const std::string calibrate = "calibrate --printer config.g --firmware reprapfirmware --readings ";
  const ProgramResult first = folder.run(calibrate + "once.csv --details"),
                      again = folder.run(calibrate + "twice.csv --details");
  const std::string note = "- twice.csv: 13 rows repeat other rows exactly and count once\n";
  ASSERT_THAT(again.out, HasSubstr(note));
  EXPECT_EQ(std::string(again.out).replace(again.out.find(note), note.size(), ""), first.out);
}

/// As configurations are: sections in files of their own.
TEST_F(PrinterCommand, ConfigurationsMayIncludeOthers) {
  std::string text = outdated();
  const std::size_t first = text.find("[stepper_a]"), saved = text.find("[delta_calibrate]");
  folder.write("steppers.cfg", text.substr(first, saved - first));
  text.replace(first, saved - first, "[include stepp*.cfg]\n[include nothing*.cfg]\n");
  folder.write("printer.cfg", text);
  const json object = json_of(folder.run("calibrate --printer printer.cfg --json"));
  EXPECT_EQ(object["printer"]["advice"], "accept_new");
  ASSERT_EQ(object["inputs"].size(), 2u);
  EXPECT_THAT(object["inputs"][1]["file"].get<std::string>(), HasSubstr("steppers.cfg"));
  const auto refused = [&](const std::string& name, const std::string& part) {
    folder.write("steppers.cfg", "\n[include " + name + "]\n");
    const ProgramResult result = folder.run("calibrate --printer printer.cfg");
    EXPECT_EQ(result.exit_code, kBadInputFile);
    EXPECT_THAT(result.err, HasSubstr(part));
  };
  refused("other.cfg", "it may be in other.cfg, which");
  refused("steppers.cfg", "steppers.cfg:2: expected no file that includes itself, got steppers.cfg");
  ASSERT_EQ(mkfifo((folder.path() / "pipe.cfg").c_str(), 0600), 0);
  refused("pipe.cfg", "steppers.cfg:2: expected a regular file, got pipe.cfg");
  refused("/*/*/*/*", "steppers.cfg:2: expected ");
  create_directory(folder.path() / "many");
  for (int k = 0; k < 1000; ++k) folder.write(fmt::format("many/{}.cfg", k), "\n");
  refused("many/*.cfg", "steppers.cfg:2: expected at most 1000 files, got more");
  folder.write("large.cfg", "\n");
  std::filesystem::resize_file(folder.path() / "large.cfg", (std::uintmax_t{64} << 20) + 1);
  refused("large.cfg", "steppers.cfg:2: expected at most 64 MiB in all included files, got more");
}

TEST_F(PrinterCommand, DrawsAPage) {
  folder.write("printer.cfg", outdated());
  ASSERT_EQ(folder.run("calibrate --printer printer.cfg --report page.html").exit_code, kDone);
  EXPECT_THAT(folder.read("page.html"), HasSubstr("Change endstops"));
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
}  // namespace paracal::test::printer_test
