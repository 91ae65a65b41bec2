// Corrected targets for closed controllers: programs and tables that pass through the program.

#include <fmt/format.h>

#include <cmath>

#include "broken_input.hpp"
#include "calibrated_machine.hpp"
#include "support/places.hpp"

namespace paracal::test::export_filter_test {
namespace {

using nlohmann::json;
using testing::ElementsAre, testing::HasSubstr, testing::IsEmpty, testing::SizeIs, testing::StartsWith;

const std::string kProgram =
    "%\n(part)\nG21 G90\nG0 X0 Y0 Z-888 C0 ; home\r\nN20 G1 X400 Z-900. C120 F5000\nG1 Y-20.5\nM30\n%";
const std::string kTable = "pose,x_mm,y_mm,z_mm,phi_deg,speed\nhome,0,0,-888,0,fast\nright,400,0,-900,120,slow\n";
const std::string kGcode = "export --calibration calibration.json --target gcode --input part.ngc";
const std::string kCsv = "export --calibration calibration.json --target csv --input targets.csv";

class ExportFilter : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("calibration.json", kCalibration);
    folder.write("part.ngc", kProgram);
    folder.write("targets.csv", kTable);
  }

  /// Rows of numbers of a table's pose columns.
  static std::vector<std::array<double, 4>> poses_in(const std::string& table) {
    std::vector<std::array<double, 4>> poses;
    for (const char* at = table.c_str(); (at = std::strchr(at, '\n')) != nullptr && *++at != '\0';) {
      const char* number = std::strchr(at, ',') + 1;
      for (double& value : poses.emplace_back()) {
        char* end = nullptr;
        value = std::strtod(number, &end);
        number = end + 1;
      }
    }
    return poses;
  }

  const TemporaryFolder folder;
};

TEST_F(ExportFilter, TablesHoldTheTargetsOfCompensate) {
  const ProgramResult result = folder.run(kCsv);
  EXPECT_EQ(result.exit_code, kDone);
  EXPECT_EQ(result.err, "targets.csv: 3 lines, 2 targets corrected\n");
  EXPECT_THAT(result.out, StartsWith("pose,x_mm,y_mm,z_mm,phi_deg,speed\nhome,"));
  EXPECT_THAT(result.out, HasSubstr(",slow\n"));
  folder.write("poses.csv", "pose,x_mm,y_mm,z_mm,phi_deg\nhome,0,0,-888,0\nright,400,0,-900,120\n");
  const json expected =
      json_of(folder.run("compensate --calibration calibration.json --poses poses.csv --json")).at("targets");
  const auto poses = poses_in(result.out);
  ASSERT_THAT(poses, SizeIs(2));
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(poses[k][0], expected[k].at("x_mm").get<double>(), 0.5001e-4);
    EXPECT_NEAR(poses[k][1], expected[k].at("y_mm").get<double>(), 0.5001e-4);
    EXPECT_NEAR(poses[k][2], expected[k].at("z_mm").get<double>(), 0.5001e-4);
    EXPECT_NEAR(poses[k][3], expected[k].at("phi_deg").get<double>(), 0.5001e-5);
  }
}

TEST_F(ExportFilter, ProgramsKeepAllButTheTargets) {
  const ProgramResult result = folder.run(kGcode);
  EXPECT_EQ(result.exit_code, kDone);
  EXPECT_THAT(result.err, testing::MatchesRegex("part.ngc: 8 lines, 3 targets corrected\n"
                                                "  [0-9]+ lines added for arcs, divided lines and feeds\n"));
  EXPECT_EQ(folder.run(kGcode + " --chord-mm 5").err, "part.ngc: 8 lines, 3 targets corrected\n");
  EXPECT_THAT(result.out, StartsWith("%\n(part)\nG21 G90\nG0 X"));
  EXPECT_THAT(result.out, HasSubstr(" ; home\r\nN20 G1 X"));
  EXPECT_THAT(result.out, HasSubstr(" F5000\nG1 X"));
  EXPECT_THAT(result.out, HasSubstr("\nG1 Y-19."));
  EXPECT_TRUE(result.out.ends_with("\nM30\n%"));
}

TEST_F(ExportFilter, StandardInputAndAFileDoTheSame) {
  const std::string expected = folder.run(kGcode).out;
  for (const char* input : {"", " --input -"}) {
    std::vector<std::string> arguments =
        of_huang2016(std::string("export --calibration calibration.json --target gcode") + input);
    const ProgramResult result = run_program(
        arguments, {.folder = folder.path(), .launcher = {"/bin/sh", "-c", "exec \"$0\" \"$@\" < part.ngc"}});
    EXPECT_EQ(result.exit_code, kDone) << result.err;
    EXPECT_EQ(result.out, expected);
    EXPECT_THAT(result.err, StartsWith("standard input: "));
  }
  EXPECT_EQ(folder.run(kGcode + " --out corrected.ngc").exit_code, kDone);
  EXPECT_EQ(folder.read("corrected.ngc"), expected);
}

/// A program that would be corrected in parts is refused whole, with the line; nothing is written, on demand all is.
TEST_F(ExportFilter, WorkOffsetsAreReadFromLinuxcncsFile) {
  folder.write("part.ngc", "G54 G0 X0 Y0 Z-888 C0\nG55 G1 X5 Y0 Z-888\n");
  EXPECT_EQ(folder.run(kGcode).exit_code, kBadInputFile);
  std::string parameters;
  for (const int base : {5221, 5241}) {
    for (int k = 0; k < 9; ++k) parameters += fmt::format("{} 0\n", base + k);
  }
  folder.write("linuxcnc.var", parameters);
  EXPECT_EQ(folder.run(kGcode + " --work-offsets linuxcnc.var").exit_code, kDone);
  folder.write("linuxcnc.var", parameters + "5220 x\n");
  const ProgramResult bad = folder.run(kGcode + " --work-offsets linuxcnc.var");
  EXPECT_EQ(bad.exit_code, kBadInputFile);
  EXPECT_THAT(bad.err, StartsWith("paracal: linuxcnc.var:19: expected the number and the value of a parameter"));
  EXPECT_EQ(folder.run(kGcode + " --work-offsets none.var").exit_code, kBadInputFile);
  EXPECT_EQ(folder.run(kCsv + " --work-offsets linuxcnc.var").exit_code, kWrongUsage);
}

TEST_F(ExportFilter, DialectsAreNamed) {
  folder.write("part.ngc", "M83\nG90\nG1 X-100 Y0 Z-900 C0\nG1 X100 E5\n");  // divided
  EXPECT_EQ(folder.run(kGcode).exit_code, kBadInputFile);
  EXPECT_EQ(folder.run(kGcode + " --dialect klipper").exit_code, kDone);
  EXPECT_EQ(folder.run(kGcode + " --dialect rrf").exit_code, kDone);
  EXPECT_EQ(folder.run(kGcode + " --dialect marlin").exit_code, kBadInputFile);
  folder.write("part.ngc", "G1 X-100. Y0 Z-900. C0\nG1 X100\n");
  EXPECT_EQ(folder.run(kGcode + " --dialect linuxcnc").exit_code, kDone);
  EXPECT_EQ(folder.run(kGcode + " --dialect fanuc-like").exit_code, kBadInputFile);
  EXPECT_EQ(folder.run(kGcode + " --dialect heidenhain").exit_code, kWrongUsage);
  EXPECT_EQ(folder.run(kCsv + " --dialect linuxcnc").exit_code, kWrongUsage);
}

TEST_F(ExportFilter, AHalfCorrectedProgramIsRefused) {
  folder.write("part.ngc", "G0 X0 Y0 Z-888 C0\nG2 X5 Y5\nG1 X9\nG38.2 Z-900\nG1 X0 Y0 Z-880 C0\n");
  folder.write("corrected.ngc", "of yesterday");
  for (const std::string& out :
       {std::string(), std::string(" --out corrected.ngc"), std::string(" --json --out corrected.ngc")}) {
    const ProgramResult result = folder.run(kGcode + out);
    EXPECT_EQ(result.exit_code, kBadInputFile);
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_THAT(result.err,
                StartsWith("paracal: part.ngc:2: expected targets that can all be corrected, got an arc without a "
                           "centre in its plane (1 "
                           "times) between corrected targets; line 4: homing, probing and threads (1 times); "));
    EXPECT_THAT(result.err, HasSubstr("--partial corrects 3 targets"));
    EXPECT_EQ(folder.read("corrected.ngc"), "of yesterday");
  }
  const ProgramResult partial = folder.run(kGcode + " --partial --out corrected.ngc");
  EXPECT_EQ(partial.exit_code, kVerdictIsNo);
  EXPECT_THAT(partial.err, HasSubstr("\n  partly corrected: 2 working lines, the first in line 2, are unchanged; "));
  EXPECT_THAT(folder.read("corrected.ngc"), HasSubstr("\nG2 X5 Y5\n"));
  folder.write("targets.csv", "pose,x_mm,y_mm,z_mm,phi_deg\na,0,0,-888,0\nb,0,0,far,0\nc,9,0,-888,0\n");
  const ProgramResult table = folder.run(kCsv);
  EXPECT_EQ(table.exit_code, kBadInputFile);
  EXPECT_THAT(table.err, StartsWith("paracal: targets.csv:3: "));
  EXPECT_EQ(run_program(of_huang2016("export --calibration calibration.json --target json --partial"),
                        {.folder = folder.path()})
                .exit_code,
            kWrongUsage);
}

/// Nor is one handed out of which nothing was corrected.
TEST_F(ExportFilter, AProgramWithoutACorrectedTargetIsRefused) {
  folder.write("part.ngc", "G0 X0 Z-888 C0\nG1 X5\nM2\n");
  const ProgramResult result = folder.run(kGcode);
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(
      result.err,
      testing::AllOf(StartsWith("paracal: part.ngc:1: expected targets that can all be corrected, got Y is unknown: "),
                     HasSubstr("give --start=X,Y,Z"), HasSubstr("(2 times); nothing was written")));
  folder.write("part.ngc", "M3 S100\nG4 P1\nM2\n");
  EXPECT_EQ(folder.run(kGcode).exit_code, kDone);
}

/// --check says what would come of a program and writes none.
TEST_F(ExportFilter, ACheckWritesNoProgram) {
  folder.write("part.ngc", "G0 X0 Y0 Z-888\nG1 X100 F900\nG1 X600\nG2 X5 Y5\nG1 X100\n");
  const ProgramResult result = folder.run(kGcode + " --check");
  EXPECT_EQ(result.exit_code, kVerdictIsNo);
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, StartsWith("part.ngc: 5 lines, 4 targets corrected\n"));
  for (const char* said : {"assumed: C stays at 0 deg, because the program never states it",
                           "1 targets outside the workspace, first in line 3",
                           "unchanged: an arc without a centre in its plane (1 times, first in line 4)",
                           "without --partial this file is refused"}) {
    EXPECT_THAT(result.out, HasSubstr(said));
  }
  const json checked = json_of(folder.run(kGcode + " --check --json"), kVerdictIsNo);
  EXPECT_EQ(checked["refused"], true);
  EXPECT_EQ(checked["outside_workspace"], json::parse(R"({"count": 1, "first_line": 3})"));
  ASSERT_THAT(checked["farthest"], SizeIs(4));
  const json& farthest = checked["farthest"][0];
  ASSERT_TRUE(has_keys(farthest, "line wanted target distance_mm"));
  double squared = 0.0;
  for (const char* axis : {"x_mm", "y_mm", "z_mm"}) {
    squared += std::pow(farthest["target"][axis].get<double>() - farthest["wanted"][axis].get<double>(), 2);
  }
  EXPECT_NEAR(farthest["distance_mm"].get<double>(), std::sqrt(squared), 1e-12);
  char row[100];
  std::snprintf(row, sizeof row, "\n%8d ", farthest["line"].get<int>());
  EXPECT_THAT(result.out, HasSubstr(row));
  folder.write("part.ngc", kProgram);
  EXPECT_EQ(folder.run(kGcode + " --check").exit_code, kDone);
}

/// What no filter may rewrite is refused in parts, too.
TEST_F(ExportFilter, WhatNoFilterMayRewriteIsRefused) {
  folder.write("part.ngc", "G0 X0 Y0 Z-888 C0\nG81 X5 Y0 Z-890 R-889 F100\nG80\n");
  for (const char* option : {"", " --partial", " --check", " --in-place"}) {
    const ProgramResult result = folder.run(kGcode + option);
    EXPECT_EQ(result.exit_code, kBadInputFile) << option;
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_EQ(
        result.err,
        "paracal: part.ngc:2: expected motions, arcs, planes, units, offsets, tools and feeds, got a canned cycle "
        "(drilling); expand it in the post-processor, or use the LinuxCNC component (--target linuxcnc)\n");
  }
  EXPECT_THAT(folder.read("part.ngc"), HasSubstr("G81"));
}

TEST_F(ExportFilter, ToolsHaveTheirLengths) {
  folder.write("part.ngc", "T1 M6\nG43\nG0 X0 Y0 Z-938 C0\nT2 M6\nG43\nG0 X0 Y0 Z-918 C0\n");
  EXPECT_EQ(folder.run(kGcode).exit_code, kVerdictIsNo);  // a rapid
  folder.write("tool.tbl", "T1 P1 Z50 ;long\nT2 P2 Z30\n");
  const ProgramResult result = folder.run(kGcode + " --tools tool.tbl");
  EXPECT_EQ(result.exit_code, kDone) << result.err;
  EXPECT_THAT(result.err, HasSubstr("assumed: --origin is that of a tool of length 0; --tools adds the length"));
  const auto lines = result.out;
  double first = 0.0, second = 0.0;  // the same place of the plate
  ASSERT_EQ(std::sscanf(std::strchr(lines.c_str(), 'Z') + 1, "%lf", &first), 1);
  ASSERT_EQ(std::sscanf(std::strrchr(lines.c_str(), 'Z') + 1, "%lf", &second), 1);
  EXPECT_NEAR(first + 50, second + 30, 1e-4);
  folder.write("tool.tbl", "T1 P1 Z50\nT1 P2 Z30\n");
  EXPECT_THAT(folder.run(kGcode + " --tools tool.tbl").err, StartsWith("paracal: tool.tbl:2: expected each tool once"));
}

/// What the robot file says of drives: blocks that ask for more are counted, with the first line.
TEST_F(ExportFilter, JointSpeedsAreHeldAgainstTheirLimits) {
  folder.write("robot.toml",
               folder.run("robot").out + "\n[joints]\nmax_speed_deg_per_s = 30\nmax_acceleration_deg_per_s2 = 9000\n");
  folder.write("part.ngc", "G0 X0 Y0 Z-888 C0\nG1 X100 F3000\nG1 X0 F30000\nG1 Z-880 F100\n");
  const std::string command = kGcode + " --robot robot.toml";
  const ProgramResult result = folder.run(command);
  EXPECT_THAT(result.err, HasSubstr("warning: 1 blocks exceed a limit of [joints], first in line 3"));
  const json checked = json_of(folder.run(command + " --check --json"));
  EXPECT_EQ(checked["joints_over_limit"], json::parse(R"({"count": 1, "first_line": 3})"));
}

/// As a slicer calls it: the file is replaced, keeps its mode, and what may stay uncorrected is no failure.
TEST_F(ExportFilter, AFileIsCorrectedInPlace) {
  const std::string print = "START_PRINT\nG21\nG90\nM83\nG1 Z-888 F5000\nG1 X10 Y0\nG1 X20 E3\nEND_PRINT\n";
  folder.write("part.ngc", print);
  const std::string klipper = "export --calibration calibration.json --target gcode --dialect klipper";
  const ProgramResult apart = folder.run(klipper + " --input part.ngc");
  EXPECT_EQ(apart.exit_code, kVerdictIsNo);
  std::filesystem::permissions(folder.path() / "part.ngc",
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  const ProgramResult result = folder.run(klipper + " --in-place --input part.ngc");
  EXPECT_EQ(result.exit_code, kDone) << result.err;
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_EQ(folder.read("part.ngc"), apart.out);
  EXPECT_EQ(std::filesystem::status(folder.path() / "part.ngc").permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  EXPECT_THAT(folder.names(), ElementsAre("calibration.json", "part.ngc", "targets.csv"));
  // A refused program stays as it is.
  folder.write("part.ngc", print + "G1 X5 Y5 Z-888\nSNAP\nG1 X9 Y9 Z-888\n");
  EXPECT_EQ(folder.run(klipper + " --in-place --input part.ngc").exit_code, kBadInputFile);
  EXPECT_EQ(folder.read("part.ngc"), print + "G1 X5 Y5 Z-888\nSNAP\nG1 X9 Y9 Z-888\n");
  EXPECT_EQ(json_of(folder.run(kCsv + " --in-place --json")).at("corrected"), 2);
}

TEST_F(ExportFilter, HarmlessWordsComeFromAFile) {
  folder.write("part.ngc", "G0 X0 Y0 Z-888 C0\nSNAP\nG187 P1\nG1 X9 F900\n");
  folder.write("words.txt", "# of our machine\nsnap\nG187\n");
  EXPECT_EQ(folder.run(kGcode).exit_code, kBadInputFile);
  EXPECT_EQ(folder.run(kGcode + " --harmless-words words.txt").exit_code, kDone);
  folder.write("words.txt", "G1\n");
  EXPECT_THAT(folder.run(kGcode + " --harmless-words words.txt").err,
              StartsWith("paracal: words.txt:1: expected one word per line that moves nothing (SNAP, G187), got G1"));
}

TEST_F(ExportFilter, MacrosCanBeSaidToBeHarmless) {
  folder.write("part.ngc", "G0 X0 Y0 Z-888\nSNAP\nG1 X9\nPAUSE\nG90 G21 G1 X1 Y0 Z-888\n");
  EXPECT_EQ(folder.run(kGcode + " --harmless SNAP").exit_code, kBadInputFile);
  EXPECT_EQ(folder.run(kGcode + " --harmless SNAP --harmless pause").exit_code, kDone);
}

/// As slicers write it: homing, an approach that states Z alone, settings, a retreat.
TEST_F(ExportFilter, ApproachAndRetreatDoNotMatter) {
  folder.write("part.ngc",
               "M201 X500 Y500\nSTART_PRINT\nG21\nG90\nG28\nG1 Z-880 F5000\nG1 X10 Y0 Z-888 C0\nM205 X8 Y8\n"
               "SET_VELOCITY_LIMIT ACCEL=500\nG1 X20 E3\nG1 X10 Y5 E4\nG28\nG1 Z-800\n");
  const ProgramResult result = folder.run(kGcode);
  EXPECT_EQ(result.exit_code, kVerdictIsNo);
  EXPECT_THAT(result.err, HasSubstr("13 lines, 3 targets corrected"));
  EXPECT_THAT(result.out, HasSubstr("\nG1 Z-880 F5000\n"));
  EXPECT_THAT(result.out, testing::EndsWith("\nG28\nG1 Z-800\n"));
}

/// A tool change behind the first target: all that is cut would stay as it was.
TEST_F(ExportFilter, WorkBehindTheLastCorrectedTargetIsRefused) {
  folder.write("part.ngc",
               "G54\nG0 X0 Y0 Z-880\nT1 M6\nG43 H1\nG0 X-60 Y-60 Z-890\nG1 Z-900 F300\nG1 X60 F1500\nG0 Z-880\n");
  const ProgramResult result = folder.run(kGcode);
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err,
              StartsWith("paracal: part.ngc:6: expected targets that can all be corrected, got another "
                         "tool than at the first corrected target (give --tools) (2 times) between corrected "
                         "targets; nothing was written; --partial corrects 1 targets and leaves the others"));
  const ProgramResult partial = folder.run(kGcode + " --partial");
  EXPECT_EQ(partial.exit_code, kVerdictIsNo);
  EXPECT_THAT(partial.err, HasSubstr("partly corrected: 2 working lines, the first in line 6, "));
  EXPECT_THAT(partial.out, HasSubstr("\nG1 X60 F1500\n"));
}

TEST_F(ExportFilter, WhatIsPassedThroughIsAVerdict) {
  folder.write("part.ngc", "G0 X0 Y0 Z-888 C0\nG53 G0 Z0\nG53 G0 X0 Y0\n");
  const ProgramResult result = folder.run(kGcode);
  EXPECT_EQ(result.exit_code, kVerdictIsNo);
  EXPECT_THAT(result.err, HasSubstr("unchanged: another origin than at the first corrected target "
                                    "(give --work-offsets) (2 times, first in line 2)"));
  EXPECT_THAT(result.err, testing::Not(HasSubstr("partly corrected")));
  const json summary = json_of(folder.run(kGcode + " --json --out corrected.ngc"), kVerdictIsNo);
  ASSERT_TRUE(
      has_keys(summary,
               "target input program robot calibration calibration_sha256 date lines corrected lines_added passed "
               "outside_workspace farthest joints_over_limit assumed refused origin_mm self_test"));
  EXPECT_EQ(summary["lines"], 3);
  EXPECT_EQ(summary["corrected"], 1);
  EXPECT_EQ(summary["lines_added"], 0);
  EXPECT_EQ(summary["refused"], false);
  ASSERT_THAT(summary["passed"], SizeIs(1));
  json passed = summary["passed"][0];
  EXPECT_THAT(passed["reason"].get<std::string>(), StartsWith("another origin than at the first"));
  passed.erase("reason");
  EXPECT_EQ(passed, json::parse(R"({"count": 2, "first_line": 2, "between": 0})"));
  EXPECT_EQ(folder.read("corrected.ngc"), result.out);
}

TEST_F(ExportFilter, TheSelfTestSaysWhatTheControllerMustCompute) {
  const json test = json_of(folder.run(kGcode + " --json --out corrected.ngc")).at("self_test");
  ASSERT_GT(test.size(), 1U);
  std::string targets = "x_mm,y_mm,z_mm,phi_deg\n";
  for (const json& one : test) {
    const json& t = one.at("target");
    targets += t["x_mm"].dump() + "," + t["y_mm"].dump() + "," + t["z_mm"].dump() + "," + t["phi_deg"].dump() + "\n";
  }
  folder.write("poses.csv", targets);
  const json nominal = json_of(folder.run("inverse --poses poses.csv --json")).at("joints_deg");
  for (std::size_t k = 0; k < test.size(); ++k) {
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(nominal[k][i].get<double>(), test[k].at("joints_deg")[i].get<double>(), 1e-9);
    }
  }
}

TEST_F(ExportFilter, TheHeaderStandsInComments) {
  const std::string coarse = kGcode + " --chord-mm 5";
  const std::string plain = folder.run(coarse).out, with_header = folder.run(coarse + " --header").out;
  EXPECT_THAT(with_header, StartsWith("%\n; targets corrected by paracal"));
  for (const char* said :
       {"; robot huang2016\n", "; calibration calibration.json\n", "; SHA-256 ", "; date ", " mm "}) {
    EXPECT_THAT(with_header, HasSubstr(said));
  }
  EXPECT_TRUE(with_header.ends_with(plain.substr(2)));
  // And nothing in it is a target.
  folder.write("part.ngc", with_header);
  EXPECT_THAT(folder.run(coarse).err, HasSubstr(" 3 targets corrected\n"));
  EXPECT_THAT(folder.run(kCsv + " --header").out, StartsWith("# targets corrected by paracal"));
}

TEST_F(ExportFilter, OriginAndStart) {
  folder.write("part.ngc", "G1 X400 Y0 Z0\n");
  const ProgramResult moved = folder.run(kGcode + " --origin 0,0,-900 --start 0,0,0,120 --chord-mm 5");
  EXPECT_EQ(moved.exit_code, kDone) << moved.err;
  const auto table = poses_in(folder.run(kCsv).out);
  double z = 0.0;
  ASSERT_EQ(std::sscanf(std::strchr(moved.out.c_str(), 'Z') + 1, "%lf", &z), 1);
  EXPECT_NEAR(z, table[1][2] + 900.0, 1e-4);
}

TEST_F(ExportFilter, ARigidPlateKeepsC) {
  const std::string robot = folder.run("robot --robot rotary_delta --json").out;
  folder.write("calibration.json", R"({"accepted": true, "parameters": [
    {"name": "e_z", "limb": 3, "value": 0.4, "unit": "mm"}], "robot": )" +
                                       robot + "}");
  folder.write("part.ngc", "G0 X0 Y0 Z-900 C30\n");
  const ProgramResult result = folder.run(kGcode + " --robot rotary_delta");
  EXPECT_EQ(result.exit_code, kDone) << result.err;
  EXPECT_THAT(result.out, HasSubstr(" C30\n"));
}

// ---- robots whose plate tilts, stays in a plane or has limbs to spare

struct AnyRobot {
  const char* name;  ///< of a template, or of a sample
  const char* parameters;
  const char* letters;                     ///< of the axes that it moves
  std::vector<std::vector<double>> poses;  ///< mm and deg
  bool has_spare_limbs = false;
};

class ExportFilterOfAnyRobot : public testing::TestWithParam<AnyRobot> {
 protected:
  ProgramResult run(const std::string& command) const { return folder.run(words(command)); }
  static const char* column_of(char letter) {
    constexpr std::array kColumns{"x_mm", "y_mm", "z_mm", "tilt_x_deg", "tilt_y_deg", "tilt_z_deg"};
    return kColumns.at(std::string_view("XYZABC").find(letter));
  }

  void SetUp() override {
    const std::filesystem::path sample = source_folder() / "samples" / fmt::format("{}.toml", GetParam().name);
    const bool is_sample = std::filesystem::exists(sample);
    folder.write("r.toml",
                 is_sample ? read_text(sample) : run(fmt::format("robot --template {}", GetParam().name)).out);
    folder.write("c.json", fmt::format(R"({{"accepted": true, "parameters": {}, "robot": {}}})", GetParam().parameters,
                                       run("robot --robot r.toml --json").out));
    std::string program, table = "pose";
    for (const char letter : letters) table += fmt::format(",{}", column_of(letter));
    for (const std::vector<double>& pose : GetParam().poses) {
      program += "G0";
      table += "\np" + std::to_string(&pose - GetParam().poses.data());
      for (std::size_t k = 0; k < letters.size(); ++k) {
        program += fmt::format(" {}{:.7f}", letters[k], pose.at(k));
        table += fmt::format(",{:.7f}", pose.at(k));
      }
      program += "\n";
    }
    folder.write("part.ngc", program);
    folder.write("poses.csv", table + "\n");
  }

  json compensated() const { return json_of(run("compensate --calibration c.json --poses poses.csv --json")); }
  static const json& joints_of(const json& result) {
    return result.at(result.contains("joints_mm") ? "joints_mm" : "joints_deg");
  }

  const std::string letters = GetParam().letters;
  const std::string gcode = "export --calibration c.json --target gcode --input part.ngc";
  const TemporaryFolder folder;
};

TEST_P(ExportFilterOfAnyRobot, ProgramsAndTablesHoldTheTargetsOfCompensate) {
  const json expected = compensated();
  const ProgramResult program = run(gcode + " --out out.ngc"),
                      table = run("export --calibration c.json --target csv --input poses.csv --out out.csv");
  ASSERT_EQ(program.exit_code, kDone) << program.err;
  ASSERT_EQ(table.exit_code, kDone) << table.err;
  const std::string told = folder.read("out.ngc");
  const char* at = told.c_str();
  for (const json& target : expected.at("targets")) {
    for (const char letter : letters) {
      const json held = target.contains(column_of(letter)) ? target.at(column_of(letter)) : json(0.0);
      at = std::strchr(at, letter);
      ASSERT_NE(at, nullptr);
      EXPECT_NEAR(std::strtod(at + 1, nullptr), held.get<double>(), 1e-7) << letter;
    }
  }
  if (GetParam().has_spare_limbs) return;  // no pose has these joints
  const json joints = json_of(run("inverse --robot r.toml --poses out.csv --json"));
  for (std::size_t k = 0; k < GetParam().poses.size(); ++k) {
    for (std::size_t i = 0; i < joints_of(joints)[k].size(); ++i) {
      EXPECT_NEAR(joints_of(joints)[k][i].get<double>(), joints_of(expected)[k][i].get<double>(), 1e-6);
    }
  }
}

TEST_P(ExportFilterOfAnyRobot, WhatIsSaidHasTheTiltsOfTheRobot) {
  const bool tilts = letters.find_first_of("ABC") != std::string::npos;
  const json checked = json_of(run(gcode + " --check --json"));
  for (const json& pose : {checked["farthest"][0]["wanted"], checked["farthest"][0]["target"],
                           checked["self_test"][0]["pose"], checked["self_test"].back()["target"]}) {
    EXPECT_EQ(pose.contains("tilt_z_deg"), tilts);
  }
  EXPECT_THAT(run(gcode + " --check").out, HasSubstr(tilts ? "sent C    moved\n" : "sent phi    moved\n"));
  const std::string with_header = run(gcode + " --header").out;
  EXPECT_THAT(with_header, HasSubstr(tilts ? " x y z tilt_x tilt_y tilt_z commanded" : " x y z phi commanded"));
  EXPECT_TRUE(with_header.ends_with(run(gcode).out));
}

INSTANTIATE_TEST_SUITE_P(Robots, ExportFilterOfAnyRobot,
                         testing::Values(AnyRobot{"hexapod",
                                                  R"([{"name": "plate_x", "limb": 1, "value": 0.4, "unit": "mm"},
                                 {"name": "zero", "limb": 2, "value": -0.5, "unit": "mm"}])",
                                                  "XYZABC",
                                                  {{0, 0, 500, 0, 0, 0}, {20, -30, 520, 4, -5, 6}}},
                                         AnyRobot{"five-bar",
                                                  R"([{"name": "zero", "limb": 1, "value": 0.2, "unit": "deg"},
                                 {"name": "rod_length", "limb": 2, "value": -0.3, "unit": "mm"}])",
                                                  "XY",
                                                  {{0, 0}, {20, -10}}},
                                         AnyRobot{"planar_belts",
                                                  R"([{"name": "zero", "limb": 1, "value": 0.2, "unit": "mm"},
                                 {"name": "rod_length", "limb": 2, "value": -0.3, "unit": "mm"}])",
                                                  "XYC",
                                                  {{0, 0, 0}, {10, -20, 5}},
                                                  true},
                                         AnyRobot{"mixed_limbs",
                                                  R"([{"name": "theta_offset", "limb": 1, "value": 0.1, "unit": "deg"},
                                 {"name": "rod_length", "limb": 4, "value": -0.3, "unit": "mm"}])",
                                                  "XYZB",
                                                  {{0, 0, -380, 0}, {30, 20, -400, 4}}}),
                         [](const auto& one) { return std::string(one.param.letters); });

class ExportFilterOfAHexapod : public ExportFilterOfAnyRobot {};
INSTANTIATE_TEST_SUITE_P(
    Robots, ExportFilterOfAHexapod,
    testing::Values(AnyRobot{
        "hexapod", R"([{"name": "zero", "limb": 2, "value": -0.5, "unit": "mm"}])", "XYZABC", {{0, 0, 450, 5, 0, 0}}}),
    [](const auto& one) { return std::string(one.param.letters); });

TEST_P(ExportFilterOfAHexapod, AToolLengthOnATiltedPlateIsRefused) {
  folder.write("part.ngc", "G43 H1\n" + folder.read("part.ngc"));
  folder.write("tool.tbl", "T1 P1 Z50\n");
  for (const char* option : {"", " --tools tool.tbl", " --partial"}) {
    const ProgramResult result = run(gcode + option);
    EXPECT_EQ(result.exit_code, kBadInputFile);
    EXPECT_EQ(result.err,
              "paracal: part.ngc:2: expected motions, arcs, planes, units, offsets, tools and feeds, got a tool length "
              "(G43) while the plate tilts; let the post-processor compute the path of the plate, without G43\n");
  }
  folder.write("tool.tbl", "T1 P1 Z0\n");
  EXPECT_EQ(run(gcode + " --tools tool.tbl").exit_code, kDone);
}

TEST_P(ExportFilterOfAHexapod, AStartHasTilts) {
  folder.write("part.ngc", "G1 X5\n");
  const ProgramResult stated = run(gcode + " --start 0,0,500,1,2,3");
  EXPECT_EQ(stated.exit_code, kDone) << stated.err;
  EXPECT_THAT(stated.out, HasSubstr(" B1.99"));
  EXPECT_EQ(run(gcode + " --start 0,0,500").exit_code, kDone);
  const ProgramResult wrong = run(gcode + " --start 0,0,500,1");
  EXPECT_EQ(wrong.exit_code, kWrongUsage);
  EXPECT_THAT(wrong.err, HasSubstr("--start: expected X,Y,Z or X,Y,Z,A,B,C for hexapod, got 4 numbers"));
  EXPECT_EQ(run(gcode + " --start 0,0,500,1,2").exit_code, kWrongUsage);
}

// ---- the compensator's parameters

TEST_F(ExportFilter, ParametersAsJson) {
  const std::string text = folder.run("export --calibration calibration.json --target json").out;
  const json exported = json::parse(text);
  EXPECT_EQ(json_of(folder.run("export --calibration calibration.json --target json --json")).size(), exported.size());
  ASSERT_TRUE(has_keys(exported,
                       "format target program robot calibration calibration_sha256 date tilts_plate identified nominal "
                       "position_errors_mm tilt_errors_rad self_test"));
  EXPECT_EQ(exported["tilts_plate"], true);
  EXPECT_THAT(exported["identified"], SizeIs(4));
  EXPECT_TRUE(is_matrix(exported["position_errors_mm"], 4, 8));
  EXPECT_TRUE(is_matrix(exported["tilt_errors_rad"], 4, 6));
  EXPECT_NEAR(exported["identified"][0].at("joint_offset_deg").get<double>(), 0.2, 1e-12);
  EXPECT_NEAR(exported["identified"][2].at("arm_mm").get<double>(), 375.15, 1e-12);
  EXPECT_EQ(exported["nominal"][2].at("arm_mm"), 375.0);
}

/// From the keys alone: the closed form of a limb gives the self-test's joints where no error tilts the plate.
TEST_F(ExportFilter, ParametersAreEnoughForTheJoints) {
  const std::string robot = folder.run("robot --json").out;
  folder.write("calibration.json", R"({"accepted": true, "parameters": [
    {"name": "e_z", "limb": 3, "value": 0.4, "unit": "mm"}, {"name": "theta_offset", "limb": 1, "value": 0.3, "unit": "deg"},
    {"name": "alpha0", "limb": 2, "value": 0.05, "unit": "deg"}], "robot": )" +
                                       robot + "}");
  const json exported = json::parse(folder.run("export --calibration calibration.json --target json").out);
  ASSERT_EQ(exported.at("tilts_plate"), false);
  for (const json& test : exported.at("self_test")) {
    const json& pose = test.at("pose");
    const std::array position{pose.at("x_mm").get<double>(), pose.at("y_mm").get<double>(),
                              pose.at("z_mm").get<double>()};
    for (std::size_t i = 0; i < 4; ++i) {
      const json& limb = exported.at("identified")[i];
      const double joint = test.at("joints_deg")[i].get<double>() + limb.at("joint_offset_deg").get<double>();
      const double c = std::cos(joint * M_PI / 180), s = std::sin(joint * M_PI / 180);
      double squared = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto number = [&](const char* key) { return limb.at(key)[k].get<double>(); };
        const double u = c * number("radial") + s * number("normal");
        const double rod = position[k] + number("plate_mm") +
                           pose.at("phi_deg").get<double>() * number("slide_mm_per_deg") - number("base_mm") -
                           limb.at("arm_mm").get<double>() * u;
        squared += rod * rod;
      }
      EXPECT_NEAR(std::sqrt(squared), limb.at("rod_mm")[0].get<double>(), 1e-9);
    }
  }
}

// ---- broken input

BrokenInput broken(std::string name, const NamedText& file, std::string command, int exit_code,
                   std::vector<std::string> message) {
  return {std::move(name),
          with({{"calibration.json", kCalibration}, {"part.ngc", kProgram}, {"targets.csv", kTable}}, file),
          std::move(command), exit_code, std::move(message)};
}

const NamedText kNothing{};
const std::string kC99 = "export --calibration calibration.json --target c99";

const std::vector<BrokenInput> kBroken{
    broken("no_input", kNothing, replaced(kGcode, "part.ngc", "none.ngc"), kBadInputFile,
           {"none.ngc", "cannot be read"}),
    broken("folder", kNothing, replaced(kGcode, "part.ngc", "."), kBadInputFile, {"got a folder"}),
    broken("no_column", {"targets.csv", replaced(kTable, "z_mm", "height")}, kCsv, kBadInputFile,
           {"targets.csv:1: ", "z_mm"}),
    broken("no_rotation", {"targets.csv", replaced(kTable, "phi_deg", "turn")}, kCsv, kBadInputFile,
           {"targets.csv:1: ", "phi_deg"}),
    broken("empty", {"targets.csv", ""}, kCsv, kBadInputFile, {"targets.csv: ", "header"}),
    broken("calibration", {"calibration.json", "{}"}, kGcode, kBadInputFile, {"calibration.json"}),
    broken("chord_zero", kNothing, kGcode + " --chord-mm 0", kWrongUsage, {"--chord-mm", "above 0", "got 0"}),
    broken("chord_nan", kNothing, kGcode + " --chord-mm nan", kWrongUsage, {"--chord-mm"}),
    broken("chord_of_table", kNothing, kCsv + " --chord-mm 1", kWrongUsage, {"--chord-mm", "gcode"}),
    broken("harmless_of_table", kNothing, kCsv + " --harmless PAUSE", kWrongUsage, {"--harmless", "gcode"}),
    broken("in_place_of_nothing", kNothing, "export --calibration calibration.json --target gcode --in-place",
           kWrongUsage, {"--in-place", "--input FILE"}),
    broken("in_place_and_out", kNothing, kGcode + " --in-place --out x", kWrongUsage, {"--in-place", "--out"}),
    broken("tools_of_table", kNothing, kCsv + " --tools tool.tbl", kWrongUsage, {"--tools", "gcode"}),
    broken("no_tools", kNothing, kGcode + " --tools none.tbl", kBadInputFile, {"none.tbl", "cannot be read"}),
    broken("check_in_parts", kNothing, kGcode + " --check --partial", kWrongUsage, {"--check", "--partial"}),
    broken("check_of_c99", kNothing, kC99 + " --check", kWrongUsage, {"--check", "gcode"}),
    broken("origin_short", kNothing, kGcode + " --origin 1,2", kWrongUsage, {"--origin"}),
    broken("origin_nan", kNothing, kGcode + " --origin 1,2,nan", kWrongUsage, {"--origin", "nan"}),
    broken("origin_of_table", kNothing, kCsv + " --origin 1,2,3", kWrongUsage, {"--origin", "gcode"}),
    broken("input_of_c99", kNothing, kC99 + " --input part.ngc", kWrongUsage, {"--input", "gcode"}),
};

INSTANTIATE_TEST_SUITE_P(Filter, BrokenInputTest, testing::ValuesIn(kBroken), name_of);

TEST_F(ExportFilter, JsonNeedsAPlaceForTheText) {
  const ProgramResult result = folder.run(kGcode + " --json");
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, HasSubstr("--out"));
}

/// Nothing of a result that cannot be written whole.
TEST_F(ExportFilter, NothingIsLeftBesideTheResult) {
  EXPECT_EQ(folder.run(kGcode + " --out corrected.ngc").exit_code, kDone);
  EXPECT_THAT(folder.names(), ElementsAre("calibration.json", "corrected.ngc", "part.ngc", "targets.csv"));
  EXPECT_EQ(folder.run(replaced(kCsv, "targets.csv", "part.ngc") + " --out other.csv").exit_code, kBadInputFile);
  EXPECT_THAT(folder.names(), ElementsAre("calibration.json", "corrected.ngc", "part.ngc", "targets.csv"));
}

}  // namespace
}  // namespace paracal::test::export_filter_test
