// Which robot a command is of: --robot, a calibration or a line of a table says it, all that do agree, and nothing else
// does.

#include <filesystem>
#include <string_view>

#include "json_checks.hpp"
#include "support/places.hpp"

namespace paracal::test::robot_statement_test {
namespace {

using nlohmann::json;
using testing::AllOf, testing::HasSubstr, testing::IsEmpty, testing::StartsWith;

const std::string kData = source_folder() / "data/huang2016";

/// A measured Delta, whose files say so.
class StatedRobot : public testing::Test {
 protected:
  void SetUp() override {
    done("poses --robot rotary_delta --stage fine --out poses.csv");
    done("simulate --poses poses.csv --seed 3 --noise-mm 0.02 --frame random --truth truth.toml --out points.csv");
    done("calibrate --measurements points.csv --out calibration.json");
  }

  /// As it stands: no robot is added.
  ProgramResult run(const std::string& command) const {
    return run_program(words(command), {.folder = folder.path(), .environment = {"SOURCE_DATE_EPOCH=0"}});
  }
  std::string done(const std::string& command) const {
    const ProgramResult result = run(command);
    EXPECT_EQ(result.exit_code, kDone) << command << ": " << result.err;
    return result.out;
  }
  void expect_refused(const std::string& command, int exit_code, const std::string& message) const {
    const ProgramResult result = run(command);
    EXPECT_EQ(result.exit_code, exit_code) << command;
    EXPECT_THAT(result.err, HasSubstr(message)) << command;
    EXPECT_THAT(result.out, IsEmpty()) << command;
  }
  /// The same table without its comments.
  void silence(const std::string& name) const {
    std::string text = folder.read(name);
    while (text.starts_with('#')) text.erase(0, text.find('\n') + 1);
    folder.write(name, text);
  }

  const TemporaryFolder folder;
};

TEST_F(StatedRobot, GoesFromFileToFile) {
  EXPECT_THAT(folder.read("poses.csv"), StartsWith("# robot: rotary_delta\n"));
  EXPECT_THAT(folder.read("points.csv"), StartsWith("# robot: rotary_delta\n"));
  EXPECT_EQ(json::parse(folder.read("calibration.json")).at("robot").at("name"), "rotary_delta");
  EXPECT_THAT(done("poses --robot rotary_delta --optimal 8 --candidates 50"), StartsWith("# robot: rotary_delta\n"));
}

TEST_F(StatedRobot, IsThatOfTheCalibration) {
  silence("poses.csv");
  silence("points.csv");
  for (const char* command :
       {"inverse --poses poses.csv --errors calibration.json", "compensate --poses poses.csv --errors calibration.json",
        "compensate --poses poses.csv --calibration calibration.json",
        "simulate --poses poses.csv --errors calibration.json", "export --calibration calibration.json --target c99",
        "export --calibration calibration.json --target csv --input poses.csv",
        "validate --calibration calibration.json --measurements points.csv"}) {
    EXPECT_EQ(done(command), done(std::string(command) + " --robot rotary_delta")) << command;
  }
  EXPECT_EQ(json_of(run("report --calibration calibration.json --json")).at("robot").at("name"), "rotary_delta");
}

TEST_F(StatedRobot, IsThatOfTheTable) {
  done("inverse --poses poses.csv --out joints.csv");
  folder.write("joints.csv", "# robot: rotary_delta\n" + folder.read("joints.csv"));
  for (const char* command : {"inverse --poses poses.csv", "forward --joints joints.csv",
                              "identifiability --poses poses.csv", "yield --poses poses.csv --machines 1"}) {
    EXPECT_EQ(done(command), done(std::string(command) + " --robot rotary_delta")) << command;
  }
}

TEST_F(StatedRobot, NobodyStatesAnything) {
  silence("poses.csv");
  silence("points.csv");
  for (const char* command : {"robot", "poses", "poses --optimal 5", "inverse --poses poses.csv",
                              "inverse --poses poses.csv --errors truth.toml", "identifiability --poses poses.csv",
                              "simulate --poses poses.csv", "error-model --pose 0,0,-900",
                              "calibrate --measurements points.csv", "sensitivity", "tolerance allocate",
                              "tolerance analyze", "yield --machines 1", "yield --machines 1 --poses poses.csv"}) {
    expect_refused(command, kWrongUsage,
                   "--robot: expected a robot, got none: give a catalogue name (huang2016, rotary_delta, "
                   "linear_delta), a file (.toml), or a line \"# robot: NAME\" in the measurements");
  }
}

TEST_F(StatedRobot, SomeCommandsNeedNone) {
  EXPECT_THAT(done("robot --list"), HasSubstr("huang2016"));
  done("reproduce huang2016");
  expect_refused("reproduce huang2016 --robot rotary_delta", kWrongUsage, "--robot");
  expect_refused("calibrate --printer printer.cfg --robot huang2016", kWrongUsage,
                 "expected --robot or --printer, got both");
  done("calibrate --measurements " + kData + "/distances.csv --poses " + kData + "/poses.csv");
}

TEST_F(StatedRobot, FilesAndOptionAgree) {
  const std::string names = "name \"huang2016\", got \"rotary_delta\"";
  expect_refused("calibrate --measurements points.csv --robot huang2016", kBadInputFile,
                 "points.csv:1: expected the robot of --robot with " + names);
  expect_refused("inverse --poses poses.csv --robot huang2016", kBadInputFile, "poses.csv:1: ");
  expect_refused("yield --machines 1 --poses poses.csv --robot huang2016", kBadInputFile, "poses.csv:1: ");
  silence("poses.csv");
  for (const char* command : {"validate --measurements points.csv --calibration", "inverse --poses poses.csv --errors",
                              "compensate --poses poses.csv --calibration", "export --target c99 --calibration"}) {
    const ProgramResult result = run(std::string(command) + " calibration.json --robot huang2016");
    EXPECT_EQ(result.exit_code, kBadInputFile) << command;
    EXPECT_THAT(result.err, AllOf(testing::ContainsRegex("(points.csv|calibration.json):[0-9]+: "), HasSubstr(names)));
  }
}

TEST_F(StatedRobot, FilesAgreeWithEachOther) {
  folder.write("poses.csv", "# robot: huang2016\npose,x_mm,y_mm,z_mm,phi_deg\nhome,0,0,-900,0\n");
  const std::string got =
      "poses.csv:1: expected the robot of calibration.json with name \"rotary_delta\", got \"huang2016\"";
  expect_refused("compensate --poses poses.csv --calibration calibration.json", kBadInputFile, got);
  expect_refused("inverse --poses poses.csv --errors calibration.json", kBadInputFile, got);
  expect_refused("calibrate --measurements points.csv --poses poses.csv", kBadInputFile,
                 "poses.csv:1: expected the robot of points.csv");
  expect_refused("export --target csv --input poses.csv --calibration calibration.json", kBadInputFile,
                 "poses.csv:1: ");
}

/// A file's robot is the one of its dimensions, not of its name.
TEST_F(StatedRobot, MayBeAFileBesideTheTable) {
  std::string robot = done("robot --robot rotary_delta");
  robot.replace(robot.find("rod_mm = 950"), 12, "rod_mm = 951");
  std::filesystem::create_directory(folder.path() / "sub");
  folder.write("sub/mine.toml", robot);
  silence("poses.csv");
  folder.write("sub/poses.csv", "# robot: mine.toml\n" + folder.read("poses.csv"));
  EXPECT_EQ(done("inverse --poses sub/poses.csv"), done("inverse --poses poses.csv --robot sub/mine.toml"));
  EXPECT_NE(done("inverse --poses sub/poses.csv"), done("inverse --poses poses.csv --robot rotary_delta"));
  expect_refused("inverse --poses sub/poses.csv --errors calibration.json", kBadInputFile,
                 "geometry.rod_mm 950.0, got 951.0");
  const json made = json_of(run("yield --machines 1 --poses sub/poses.csv --json"));
  EXPECT_EQ(made.at("inputs")[0].at("file"), "mine.toml");
}

/// The line holds the path from the table's folder to the file, so that both can move together.
TEST_F(StatedRobot, OfAFileIsNamedByItsPath) {
  std::filesystem::create_directories(folder.path() / "sub/deeper");
  folder.write("sub/mine.toml", done("robot --template delta"));
  EXPECT_THAT(done("poses --robot sub/mine.toml"), StartsWith("# robot: sub/mine.toml\n"));
  const auto first_line = [&](const std::string& table) {
    const std::string text = folder.read(table);
    return text.substr(0, text.find('\n'));
  };
  done("poses --robot sub/mine.toml --out sub/plan.csv");
  EXPECT_EQ(first_line("sub/plan.csv"), "# robot: mine.toml");
  done("simulate --poses sub/plan.csv --out sub/deeper/points.csv");
  EXPECT_EQ(first_line("sub/deeper/points.csv"), "# robot: ../mine.toml");
  done("poses --robot sub/mine.toml --optimal 20 --candidates 200 --out optimal.csv");
  EXPECT_EQ(first_line("optimal.csv"), "# robot: sub/mine.toml");
  const json found = json_of(run("calibrate --measurements sub/deeper/points.csv --json"));
  EXPECT_EQ(found.at("robot").at("name"), "delta");

  rename(folder.path() / "sub", folder.path() / "moved");
  done("calibrate --measurements moved/deeper/points.csv");
  const std::string missing =
      "optimal.csv:1: expected the robot file sub/mine.toml, got none there; write the path from "
      "this table's folder to the file, or remove this line and add --robot FILE";
  expect_refused("simulate --poses optimal.csv", kBadInputFile, missing);
  expect_refused("simulate --poses optimal.csv --robot moved/mine.toml", kBadInputFile, missing);
}

/// A file is what its dimensions, workspace and tolerances are, even where its name is one of the catalogue.
TEST_F(StatedRobot, OfAFileWithACatalogueNameIsTheFile) {
  folder.write("mine.toml", done("robot --robot rotary_delta"));
  EXPECT_THAT(done("poses --robot mine.toml"), StartsWith("# robot: mine.toml\n"));
}

TEST_F(StatedRobot, IsNotNamedWhereReadersWouldTakeItOtherwise) {
  const std::string robot = done("robot --robot rotary_delta");
  for (const char* name : {"./mine", "mine;.toml", " mine.toml", "mine\n.toml"}) {
    folder.write(name, robot);
    const ProgramResult result = run_program({"poses", "--robot", name}, {.folder = folder.path()});
    ASSERT_EQ(result.exit_code, kDone) << result.err;
    const bool is_named = std::string_view(name) == "./mine" || std::string_view(name) == "mine;.toml";
    EXPECT_EQ(result.out.starts_with("# robot: "), is_named) << name;
    folder.write("again.csv", result.out);
    const ProgramResult again =
        run_program({"inverse", "--poses", "again.csv", "--robot", name}, {.folder = folder.path()});
    EXPECT_EQ(again.exit_code, kDone) << again.err;
  }
}

/// Of standard input, files are found from the current folder.
TEST_F(StatedRobot, OfAFileMayComeThroughAPipe) {
  folder.write("mine.toml", done("robot --template delta"));
  folder.write("plan.csv", done("poses --robot mine.toml"));
  const Surroundings pipe{.folder = folder.path(), .launcher = {"/bin/sh", "-c", "cat plan.csv | \"$0\" \"$@\""}};
  EXPECT_EQ(run_program({"inverse", "--poses", "/dev/stdin"}, pipe).out, done("inverse --poses plan.csv"));
}

/// What comes through a pipe can be read once.
TEST_F(StatedRobot, MayComeThroughAPipe) {
  const Surroundings pipe{.folder = folder.path(), .launcher = {"/bin/sh", "-c", "cat poses.csv | \"$0\" \"$@\""}};
  EXPECT_EQ(run_program({"inverse", "--poses", "/dev/stdin"}, pipe).out, done("inverse --poses poses.csv"));
}

}  // namespace
}  // namespace paracal::test::robot_statement_test
