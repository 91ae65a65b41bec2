// What scripts rely on: exit codes, JSON keys, files that one command writes and another reads.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <sstream>

#include "json_checks.hpp"
#include "support/places.hpp"

namespace paracal::test::contract_test {
namespace {

using nlohmann::json;
using testing::ElementsAre, testing::HasSubstr, testing::IsEmpty, testing::Not, testing::SizeIs, testing::StartsWith;

const std::string kData = source_folder() / "data/huang2016";
const std::string kPublishedPoses = kData + "/poses.csv";
const std::string kPublishedDistances = kData + "/distances.csv";

std::vector<std::string> published_calibration(const std::vector<std::string>& options = {}) {
  std::vector<std::string> command{"calibrate", "--measurements", kPublishedDistances, "--poses", kPublishedPoses};
  command.insert(command.end(), options.begin(), options.end());
  return command;
}

struct KnownRobot {
  std::string name;
  std::size_t limbs;
  bool turns;
  std::string joint_unit = "deg";
  double top = -810.0, radius = 440.0;  ///< mm: where poses are asked for
};

void PrintTo(const KnownRobot& robot, std::ostream* stream) { *stream << robot.name; }

struct CommandedPose {
  std::string name;
  double x, y, z, phi;
};

/// Poses in every direction, at every depth; turned where the robot can.
std::vector<CommandedPose> poses_of(const KnownRobot& robot) {
  std::vector<CommandedPose> poses;
  for (int k = 0; k < 12; ++k) {
    const double azimuth = 0.5 * k, radius = robot.radius / 11.0 * k;
    poses.push_back({"pose " + std::to_string(k), radius * std::cos(azimuth), radius * std::sin(azimuth),
                     robot.top - 15.0 * k, robot.turns ? -165.0 + 30.0 * k : 0.0});
  }
  return poses;
}

std::string pose_table(const std::vector<CommandedPose>& poses) {
  std::string text = "pose,x_mm,y_mm,z_mm,phi_deg\n";
  for (const CommandedPose& pose : poses) {
    text += pose.name;
    for (const double number : {pose.x, pose.y, pose.z, pose.phi}) text += "," + json(number).dump();
    text += "\n";
  }
  return text;
}

void expect_reached(const std::vector<CommandedPose>& commanded, const json& reached, double mm, double deg) {
  ASSERT_EQ(reached.size(), commanded.size());
  for (std::size_t k = 0; k < commanded.size(); ++k) {
    SCOPED_TRACE(commanded[k].name);
    EXPECT_NEAR(reached[k].at("x_mm"), commanded[k].x, mm);
    EXPECT_NEAR(reached[k].at("y_mm"), commanded[k].y, mm);
    EXPECT_NEAR(reached[k].at("z_mm"), commanded[k].z, mm);
    EXPECT_NEAR(reached[k].at("phi_deg"), commanded[k].phi, deg);
    EXPECT_LT(reached[k].at("residual_mm"), mm);
  }
}

class EveryKnownRobot : public testing::TestWithParam<KnownRobot> {
 protected:
  void SetUp() override { folder.write("poses.csv", pose_table(poses)); }

  /// Runs a command for this robot in the test's folder.
  ProgramResult run(const std::string& command) const { return folder.run(command + " --robot " + robot.name); }

  const KnownRobot robot = GetParam();
  const std::string joints_key = "joints_" + robot.joint_unit;
  const std::vector<CommandedPose> poses = poses_of(robot);
  TemporaryFolder folder;
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryKnownRobot,
                         testing::Values(KnownRobot{"huang2016", 4, true}, KnownRobot{"rotary_delta", 3, false},
                                         KnownRobot{"linear_delta", 3, false, "mm", -310.0, 110.0}),
                         [](const auto& one) { return one.param.name; });

TEST_P(EveryKnownRobot, RobotKeys) {
  const json object = json_of(run("robot --json"));
  ASSERT_TRUE(has_keys(object, "name geometry workspace tolerances"));
  EXPECT_EQ(object["name"], robot.name);
  EXPECT_TRUE(
      has_keys(object["geometry"],
               "base_radius_mm plate_radius_mm arm_mm rod_mm parallelogram_width_mm limb_azimuth_deg actuator"));
  EXPECT_THAT(object["geometry"]["limb_azimuth_deg"], SizeIs(robot.limbs));
  EXPECT_TRUE(has_keys(object["workspace"], "radius_mm height_mm top_z_mm rotation_deg"));
  EXPECT_EQ(object.contains("plate"), robot.turns);
  if (robot.turns) {
    EXPECT_TRUE(has_keys(object["plate"], "slide_axis slide_sign pinion_radius_mm"));
  }
}

TEST_P(EveryKnownRobot, InverseKeys) {
  const json object = json_of(run("inverse --poses poses.csv --json"));
  ASSERT_TRUE(has_keys(object, joints_key));
  EXPECT_TRUE(is_matrix(object[joints_key], poses.size(), robot.limbs));
}

TEST_P(EveryKnownRobot, ForwardKeys) {
  ASSERT_EQ(run("inverse --poses poses.csv --out joints.csv").exit_code, kDone);
  const json object = json_of(run("forward --joints joints.csv --json"));
  ASSERT_TRUE(has_keys(object, "poses"));
  for (const json& pose : object["poses"]) {
    EXPECT_TRUE(has_keys(pose, "x_mm y_mm z_mm phi_deg tilt_x_rad tilt_y_rad tilt_z_rad residual_mm"));
  }
}

TEST_P(EveryKnownRobot, ErrorModelKeys) {
  const json object = json_of(run("error-model --pose 100,50,-900,0 --json"));
  ASSERT_TRUE(has_keys(object, "G_dd G_de G_ee parameters"));
  const std::size_t position = 8 * robot.limbs, tilt = 6 * robot.limbs, freedoms = robot.turns ? 4 : 3;
  EXPECT_TRUE(is_matrix(object["G_dd"], freedoms, position));
  EXPECT_TRUE(is_matrix(object["G_de"], freedoms, tilt));
  EXPECT_TRUE(is_matrix(object["G_ee"], 3, tilt));
}

TEST_P(EveryKnownRobot, ErrorModelNamesItsColumns) {
  const json parameters = json_of(run("error-model --pose 100,50,-900,0 --json")).at("parameters");
  const bool on_rails = robot.joint_unit == "mm";
  const json position =
      words(fmt::format("theta_offset e_x e_y e_z {} alpha0 beta0 rod_mean", on_rails ? "gain" : "arm_length"));
  const json tilt = words("rod_difference width_difference alpha03 beta03 alpha2 beta2");
  ASSERT_EQ(parameters.at("position").size(), position.size() * robot.limbs);
  ASSERT_EQ(parameters.at("tilt").size(), tilt.size() * robot.limbs);
  for (const json& column : parameters["position"]) EXPECT_THAT(position, testing::Contains(column.at("name")));
  for (const json& column : parameters["tilt"]) EXPECT_THAT(tilt, testing::Contains(column.at("name")));
  EXPECT_EQ(parameters["position"].front().at("limb"), 1);
  EXPECT_EQ(parameters["tilt"].back().at("limb"), robot.limbs);
}

TEST_P(EveryKnownRobot, ForwardOfInverseReturnsThePoses) {
  ASSERT_EQ(run("inverse --poses poses.csv --out joints.csv").exit_code, kDone);
  expect_reached(poses, json_of(run("forward --joints joints.csv --json")).at("poses"), 1e-9, 1e-9);
}

TEST_P(EveryKnownRobot, InverseAcceptsThePosesThatForwardWrites) {
  ASSERT_EQ(run("inverse --poses poses.csv --out joints.csv").exit_code, kDone);
  ASSERT_EQ(run("forward --joints joints.csv --out reached.csv").exit_code, kDone);
  const json before = json_of(run("inverse --poses poses.csv --json"));
  const json after = json_of(run("inverse --poses reached.csv --json"));
  ASSERT_TRUE(is_matrix(after[joints_key], poses.size(), robot.limbs));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (std::size_t i = 0; i < robot.limbs; ++i) {
      EXPECT_NEAR(after[joints_key][k][i], before[joints_key][k][i], 1e-9);
    }
  }
}

TEST_P(EveryKnownRobot, ARobotFileStandsForItsRobot) {
  ASSERT_EQ(run("robot --out robot.toml").exit_code, kDone);
  const ProgramResult again = folder.run("robot --robot robot.toml");
  EXPECT_EQ(again.exit_code, kDone);
  EXPECT_EQ(again.out, folder.read("robot.toml"));
  EXPECT_EQ(folder.run("robot --json --robot robot.toml").out, run("robot --json").out);
  EXPECT_EQ(folder.run("inverse --poses poses.csv --robot robot.toml").out, run("inverse --poses poses.csv").out);
}

TEST_P(EveryKnownRobot, CorrectedJointsLeadTheFaultyMachineToThePoses) {
  std::string errors;
  for (std::size_t limb = 0; limb < robot.limbs; ++limb) {
    errors += "[[limb]]\ntheta_offset_" + robot.joint_unit + " = 0." + std::to_string(limb + 1) +
              "\ne_mm = [0.5, -0.4, 0.3]\nrod_mean_mm = -0.2\n";
  }
  folder.write("errors.toml", errors);
  ASSERT_EQ(run("inverse --poses poses.csv --errors errors.toml --out joints.csv").exit_code, kDone);
  expect_reached(poses, json_of(run("forward --joints joints.csv --errors errors.toml --json")).at("poses"), 1e-6,
                 1e-6);
}

TEST(RobotCommand, ListsTheCatalogue) {
  const TemporaryFolder folder;
  EXPECT_EQ(folder.run("robot --list").out, "huang2016\nrotary_delta\nlinear_delta\n");
  EXPECT_EQ(json_of(folder.run("robot --list --json")).at("robots"),
            json(words("huang2016 rotary_delta linear_delta")));
}

TEST(CalibrateCommand, Keys) {
  const json object = json_of(run_program(published_calibration({"--json"})));
  ASSERT_TRUE(has_keys(object, "accepted stages parameters rank null_space residual_rms_mm before after"));
  ASSERT_TRUE(has_keys(object, "robot covariance program date inputs use notes assumed"));
  ASSERT_TRUE(has_keys(object["use"], "distance_mm aligned_mm rotation_deg"));
  ASSERT_TRUE(has_keys(object["use"]["distance_mm"], "U limit verdict"));
  EXPECT_EQ(object["accepted"], true);
  EXPECT_EQ(object["rank"], 4);
  EXPECT_THAT(object["null_space"], IsEmpty());
  EXPECT_THAT(object["stages"], SizeIs(1));
  EXPECT_TRUE(is_matrix(object["covariance"], 56, 56));
  EXPECT_LT(object["residual_rms_mm"], 0.2);
  EXPECT_GT(object["before"].at("max_abs_distance_mm"), object["after"].at("max_abs_distance_mm"));
}

TEST(CalibrateCommand, ParameterKeys) {
  const json object = json_of(run_program(published_calibration({"--json"})));
  std::size_t identified = 0;
  for (const json& parameter : object.at("parameters")) {
    ASSERT_TRUE(has_keys(parameter, "name limb value unit std U k dof status"));
    EXPECT_THAT(json(words("identified fixed prior")), testing::Contains(parameter["status"]));
    if (parameter["status"] != "identified") continue;
    ++identified;
    EXPECT_EQ(parameter["name"], "theta_offset");
    EXPECT_EQ(parameter["unit"], "deg");
    EXPECT_GT(parameter["std"], 0.0);
  }
  EXPECT_EQ(identified, 4u);
}

TEST(CalibrateCommand, NamesItsInputs) {
  const json inputs = json_of(run_program(published_calibration({"--json"}))).at("inputs");
  ASSERT_THAT(inputs, SizeIs(2));
  for (const json& input : inputs) EXPECT_THAT(input.at("sha256").get<std::string>(), SizeIs(64));
  EXPECT_EQ(inputs[0].at("file"), std::filesystem::path(kPublishedDistances).filename().string());
  EXPECT_EQ(inputs[1].at("file"), std::filesystem::path(kPublishedPoses).filename().string());
}

TEST(CalibrateCommand, ItsFileCompensatesTheMachine) {
  const TemporaryFolder folder;
  const std::vector<CommandedPose> poses = poses_of({"huang2016", 4, true});
  folder.write("poses.csv", pose_table(poses));
  ASSERT_EQ(folder.run(published_calibration({"--out", "calibration.json"})).exit_code, kDone);
  ASSERT_EQ(folder.run("inverse --poses poses.csv --errors calibration.json --out joints.csv").exit_code, kDone);
  const json reached = json_of(folder.run("forward --joints joints.csv --errors calibration.json --json"));
  expect_reached(poses, reached.at("poses"), 1e-6, 1e-6);
  EXPECT_NE(folder.read("joints.csv"), folder.run("inverse --poses poses.csv").out);
}

TEST(CalibrateCommand, ThePrintedJsonIsTheFile) {
  const TemporaryFolder folder;
  const Surroundings fixed_date{.folder = folder.path(), .environment = {"SOURCE_DATE_EPOCH=0"}};
  ASSERT_EQ(run_program(published_calibration({"--out", "calibration.json"}), fixed_date).exit_code, kDone);
  EXPECT_EQ(run_program(published_calibration({"--json"}), fixed_date).out, folder.read("calibration.json"));
}

TEST(CalibrateCommand, SourceDateEpochMakesTheSameBytes) {
  const TemporaryFolder folder;
  const Surroundings fixed_date{.folder = folder.path(), .environment = {"SOURCE_DATE_EPOCH=1000000000"}};
  for (const char* name : {"one.json", "two.json"}) {
    ASSERT_EQ(run_program(published_calibration({"--out", name}), fixed_date).exit_code, kDone);
  }
  EXPECT_EQ(folder.read("one.json"), folder.read("two.json"));
  EXPECT_EQ(json::parse(folder.read("one.json")).at("date"), "2001-09-09T01:46:40Z");
  EXPECT_TRUE(folder.run("--version")
                  .out.ends_with(json::parse(folder.read("one.json")).at("build").get<std::string>() + ")\n"));
}

TEST(CalibrateCommand, ABrokenSourceDateEpochIsNamed) {
  for (const char* date : {"SOURCE_DATE_EPOCH=yesterday", "SOURCE_DATE_EPOCH=99999999999999999999"}) {
    const ProgramResult result = run_program(published_calibration(), {.environment = {date}});
    EXPECT_NE(result.exit_code, kDone) << date;
    EXPECT_THAT(result.err, HasSubstr("SOURCE_DATE_EPOCH")) << date;
  }
}

/// Enough to repeat the fit: the options that weigh its readings are among it.
TEST(CalibrateCommand, KeepsTheOptionsOfTheFit) {
  const json object =
      json_of(run_program(published_calibration({"--json", "--sigma-mm", "0.0703", "--sigma-deg", "0.4109"})));
  std::vector<double> numbers;
  for (const json& value : object.flatten()) {
    if (value.is_number()) numbers.push_back(value);
  }
  EXPECT_THAT(numbers, testing::Contains(testing::DoubleNear(0.0703, 1e-12)));
  EXPECT_THAT(numbers, testing::Contains(testing::DoubleNear(0.4109, 1e-12)));
}

/// The published calibration with only the first distances.
ProgramResult calibrate_with(const TemporaryFolder& folder, std::size_t distances, const std::string& options) {
  const std::string text = read_text(kPublishedDistances);
  std::size_t end = text.find("from,");
  for (std::size_t line = 0; line <= distances; ++line) end = text.find('\n', end) + 1;
  folder.write("distances.csv", text.substr(0, end));
  return folder.run("calibrate --measurements distances.csv --poses " + kPublishedPoses + options);
}

TEST(CalibrateCommand, NothingToSpareIsNotAccepted) {
  const TemporaryFolder folder;
  const json object = json_of(calibrate_with(folder, 4, " --json"), kVerdictIsNo);
  EXPECT_EQ(object.at("accepted"), false);
  EXPECT_EQ(object.at("rank"), 4);
  EXPECT_THAT(object.at("reasons"), Not(IsEmpty()));
}

TEST(CalibrateCommand, TooFewDistancesNameWhatTheyDoNotSee) {
  const TemporaryFolder folder;
  const json object = json_of(calibrate_with(folder, 3, " --json"), kVerdictIsNo);
  EXPECT_EQ(object.at("accepted"), false);
  EXPECT_EQ(object.at("rank"), 3);
  ASSERT_THAT(object.at("null_space"), SizeIs(1));
  EXPECT_THAT(object["null_space"][0].at("text").get<std::string>(), HasSubstr("theta_offset of limb"));
  EXPECT_THAT(object["null_space"][0].at("direction"), SizeIs(4));
}

TEST(CalibrateCommand, AnUnacceptedResultIsPrintedAndKept) {
  const TemporaryFolder folder;
  const ProgramResult result = calibrate_with(folder, 3, " --out calibration.json");
  EXPECT_EQ(result.exit_code, kVerdictIsNo);
  EXPECT_THAT(result.out, HasSubstr("not identifiable"));
  EXPECT_EQ(json::parse(folder.read("calibration.json")).at("accepted"), false);
}

TEST(ReproduceCommand, Keys) {
  const json result = json_of(run_program({"reproduce", "huang2016", "--json"}));
  ASSERT_TRUE(has_keys(result, "paper rule rows counts"));
  EXPECT_THAT(result.at("rule"), Not(IsEmpty()));
  std::map<std::string, int> counts{
      {"reproduced", 0}, {"not contradicted", 0}, {"not reproduced", 0}, {"cannot be tested", 0}};
  for (const json& row : result.at("rows")) {
    ASSERT_TRUE(has_keys(row, "id table quantity unit paper ours tolerance ok verdict reason"));
    const auto verdict = row["verdict"].get<std::string>();
    ++counts.at(verdict);
    EXPECT_EQ(row["ok"], verdict == "reproduced") << row;
    EXPECT_THAT(row["reason"].get<std::string>(), Not(IsEmpty())) << row;
    if (!row["ok"]) continue;
    EXPECT_LE(std::abs(row["ours"].get<double>() - row["paper"].get<double>()), row["tolerance"]) << row;
  }
  for (const auto& [verdict, count] : counts) EXPECT_GT(count, 0) << verdict;
  EXPECT_EQ(result["counts"]["reproduced"], counts["reproduced"]);
  EXPECT_EQ(result["counts"]["not_contradicted"], counts["not contradicted"]);
  EXPECT_EQ(result["counts"]["not_reproduced"], counts["not reproduced"]);
  EXPECT_EQ(result["counts"]["cannot_be_tested"], counts["cannot be tested"]);
}

/// Numbers that do not come out are results: the program is done, says which and why, and counts what it has printed.
TEST(ReproduceCommand, CountsWhatItPrints) {
  const ProgramResult result = run_program({"reproduce", "huang2016"});
  EXPECT_EQ(result.exit_code, kDone);
  std::map<std::string, int> printed;
  std::string last;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line); last = line) {
    for (const char* verdict : {"reproduced", "not contradicted", "not reproduced", "cannot be tested"}) {
      if (line.starts_with("  ") && line.ends_with(std::string("  ") + verdict)) ++printed[verdict];
    }
  }
  const int all =
      printed["reproduced"] + printed["not contradicted"] + printed["not reproduced"] + printed["cannot be tested"];
  EXPECT_EQ(last, fmt::format("{} published numbers: {} reproduced, {} not contradicted, {} not reproduced, {} cannot "
                              "be tested",
                              all, printed["reproduced"], printed["not contradicted"], printed["not reproduced"],
                              printed["cannot be tested"]));
  EXPECT_THAT(result.out, HasSubstr("half a unit of the last printed digit"));
  EXPECT_THAT(result.out, HasSubstr("    cause: "));
}

TEST(Program, AnswersHelpAndVersion) {
  const TemporaryFolder folder;
  // version, commit, compiler
  EXPECT_THAT(folder.run("--version").out, testing::MatchesRegex("paracal [0-9.]+ \\([^,]+, (GNU|Clang) .+\\)\n"));
  const std::string licences = folder.run("--licenses").out;
  for (const char* const name : {"Apache License", "Eigen\n", "Boost.Math\n", "Random123\n", "oneTBB\n", "NLopt\n",
                                 "{fmt}\n", "toml++\n", "libcsv\n", "nlohmann-json\n", "CLI11\n", "libmd\n", "three ",
                                 "d3-array ", "@observablehq/plot ", "delaunator "}) {
    EXPECT_THAT(licences, HasSubstr(name));
  }
  EXPECT_THAT(licences, Not(HasSubstr("Its licence was not there")));
  for (const char* command : {"--help", "robot --help", "inverse --help", "forward --help", "error-model --help",
                              "calibrate --help", "schema --help", "reproduce --help"}) {
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, kDone) << command;
    EXPECT_THAT(result.out, HasSubstr("Usage:")) << command;
    EXPECT_THAT(result.err, IsEmpty()) << command;
  }
}

TEST(Program, WorksFromAnyFolder) {
  const TemporaryFolder folder;
  const std::filesystem::path odd = folder.path() /
                                    "Messung 3, \xC3\xA4u\xC3\x9F"
                                    "ere Punkte";
  std::filesystem::create_directory(odd);
  const std::string here = run_program(published_calibration()).out;
  EXPECT_THAT(here, HasSubstr("accepted"));
  for (const std::filesystem::path& place : {odd, folder.path(), std::filesystem::path("/")}) {
    EXPECT_EQ(run_program(published_calibration(), {.folder = place}).out, here) << place;
  }
  EXPECT_EQ(run_program({"reproduce", "huang2016"}, {.folder = odd}).exit_code, kDone);
}

TEST(Program, FindsFilesRelativeToTheCurrentFolder) {
  const TemporaryFolder folder;
  const std::filesystem::path odd = folder.path() / "a b";
  std::filesystem::create_directory(odd);
  folder.write("poses $HOME;.csv", read_text(kPublishedPoses));
  const ProgramResult result =
      run_program({"inverse", "--poses", "../poses $HOME;.csv", "--out", "joints of it.csv"}, {.folder = odd});
  EXPECT_EQ(result.exit_code, kDone) << result.err;
  EXPECT_EQ(read_text(odd / "joints of it.csv"), run_program({"inverse", "--poses", kPublishedPoses}).out);
}

TEST(Program, OutReplacesAnEarlierResultAndPrintsNothing) {
  const TemporaryFolder folder;
  folder.write("robot.toml", "earlier");
  const ProgramResult result = folder.run("robot --out robot.toml");
  EXPECT_EQ(result.exit_code, kDone);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_EQ(folder.read("robot.toml"), folder.run("robot").out);
  EXPECT_THAT(folder.names(), ElementsAre("robot.toml"));
}

TEST(Program, OutIntoAMissingFolderIsRefused) {
  const TemporaryFolder folder;
  const ProgramResult result = folder.run("robot --out nowhere/robot.toml");
  EXPECT_NE(result.exit_code, kDone);
  EXPECT_THAT(result.err, HasSubstr("nowhere/robot.toml"));
}

TEST(Program, OutOverAFolderIsRefused) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "robot.toml");
  const ProgramResult result = folder.run("robot --out robot.toml");
  EXPECT_NE(result.exit_code, kDone);
  EXPECT_THAT(result.err, HasSubstr("robot.toml"));
  EXPECT_THAT(folder.names(), ElementsAre("robot.toml"));
}

TEST(Program, OutThroughALinkWritesItsTarget) {
  const TemporaryFolder folder;
  folder.write("target.toml", "earlier");
  std::filesystem::create_symlink("target.toml", folder.path() / "link.toml");
  EXPECT_EQ(folder.run("robot --out link.toml").exit_code, kDone);
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link.toml"));
  EXPECT_TRUE(folder.read("target.toml") == folder.run("robot").out);
}

/// A pipe here stands for every file that is not a regular one: nobody wants /dev/null replaced by a robot.
TEST(Program, OutIntoAPipeDoesNotReplaceIt) {
  const TemporaryFolder folder;
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);  // so that writing into the pipe would not wait
  ASSERT_GE(reader, 0);
  folder.run("robot --out pipe");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  close(reader);
}

/// A result that was private stays private.
TEST(Program, OutKeepsThePermissionsOfAnEarlierResult) {
  using std::filesystem::perms;
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("robot.toml", "earlier");
  std::filesystem::permissions(file, perms::owner_read | perms::owner_write);
  EXPECT_EQ(folder.run("robot --out robot.toml").exit_code, kDone);
  EXPECT_EQ(std::filesystem::status(file).permissions(), perms::owner_read | perms::owner_write);
}

/// A full disk must not look like a result.
TEST(Program, AnOutputThatCannotBeWrittenIsNotDone) {
  for (const char* command : {"robot", "robot --json", "reproduce huang2016"}) {
    const ProgramResult result = run_program(of_huang2016(command), {.standard_output = "/dev/full"});
    EXPECT_NE(result.exit_code, kDone) << command;
    EXPECT_THAT(result.err, Not(IsEmpty())) << command;
  }
  EXPECT_NE(run_program(published_calibration(), {.standard_output = "/dev/full"}).exit_code, kDone);
  for (const char* command : {"--help", "calibrate --help", "--version", "--licenses"}) {
    const ProgramResult result = run_program(words(command), {.standard_output = "/dev/full"});
    EXPECT_EQ(result.exit_code, kWrongUsage) << command;
    EXPECT_EQ(result.err, "paracal: standard output: cannot be written\n") << command;
  }
}

}  // namespace
}  // namespace paracal::test::contract_test
