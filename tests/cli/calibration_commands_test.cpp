// A calibration as its user goes through it: plan poses, see what they will tell, measure (here: simulate), calibrate,
// validate; every file that one command writes and another reads.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>

#include "json_checks.hpp"
#include "support/places.hpp"

namespace paracal::test::calibration_commands_test {
namespace {

using nlohmann::json;
using testing::AllOf, testing::Contains, testing::HasSubstr, testing::IsEmpty, testing::Not, testing::SizeIs,
    testing::StartsWith;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t start = 0, end = 0; start < text.size(); start = end + 1) {
    end = std::min(text.find('\n', start), text.size());
    lines.push_back(text.substr(start, end - start));
  }
  return lines;
}

/// The lines of a table, without its comments.
std::vector<std::string> table_of(const std::string& text) {
  std::vector<std::string> lines = lines_of(text);
  std::erase_if(lines, [](const std::string& line) { return line.starts_with('#'); });
  return lines;
}

std::string text_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

/// Fields of a line of a table without quotation marks.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields{""};
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::string line_of(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) line += (line.empty() ? "" : ",") + field;
  return line;
}

/// Every text under a key: texts_of(object["null_space"], "text").
std::vector<std::string> texts_of(const json& list, const char* key) {
  std::vector<std::string> texts;
  for (const json& one : list) texts.push_back(one.at(key));
  return texts;
}

/// The paper's fine poses, for every test that needs some.
class CalibrationCommands : public testing::Test {
 protected:
  void SetUp() override { folder.make({"poses --stage fine --out poses.csv"}); }

  ProgramResult run(const std::string& command) const { return folder.run(command); }
  json json_from(const std::string& command, int exit_code = kDone) const {
    return json_of(run(command + " --json"), exit_code);
  }
  std::string written(const std::string& command) const {
    const ProgramResult result = run(command);
    EXPECT_EQ(result.exit_code, kDone) << command << ": " << result.err;
    return result.out;
  }

  const TemporaryFolder folder;
};

// ---- poses

struct PaperStage {
  std::string name;
  int n;
  std::size_t poses;
};

void PrintTo(const PaperStage& stage, std::ostream* stream) { *stream << stage.name; }

class PaperPoses : public testing::TestWithParam<PaperStage> {};

INSTANTIATE_TEST_SUITE_P(Stages, PaperPoses, testing::Values(PaperStage{"rough", 6, 7}, PaperStage{"fine", 9, 19}),
                         [](const auto& one) { return one.param.name; });

TEST_P(PaperPoses, Keys) {
  const json plan = json_of(run_program(of_huang2016("poses --json --stage " + GetParam().name)));
  ASSERT_TRUE(has_keys(plan, "n curve poses"));
  EXPECT_EQ(plan["n"], GetParam().n);
  EXPECT_THAT(plan["poses"], SizeIs(GetParam().poses));
  for (const json& point : plan["curve"]) EXPECT_TRUE(has_keys(point, "n O1 O2 O3 O4 O5 change"));
  for (const json& pose : plan["poses"]) EXPECT_TRUE(has_keys(pose, "pose x_cmd_mm y_cmd_mm z_cmd_mm phi_cmd_deg"));
}

TEST_P(PaperPoses, TheCurveSettlesAtN) {
  const json plan = json_of(run_program(of_huang2016("poses --json --stage " + GetParam().name)));
  for (const json& point : plan.at("curve")) {
    if (point.at("n") > plan.at("n")) break;
    EXPECT_EQ(point.at("change") <= 0.01, point.at("n") == plan.at("n")) << point;
  }
}

TEST_P(PaperPoses, TheTextIsATableOfPoses) {
  const TemporaryFolder folder;
  folder.write("poses.csv", folder.run("poses --stage " + GetParam().name).out);
  const json joints = json_of(folder.run("inverse --poses poses.csv --json"));
  EXPECT_TRUE(is_matrix(joints.at("joints_deg"), GetParam().poses, 4));
  const json plan = json_of(folder.run("poses --json --stage " + GetParam().name));
  EXPECT_EQ(joints.at("names"), json(texts_of(plan.at("poses"), "pose")));
}

TEST(PosesCommand, AThresholdThatNothingMeetsIsNotDone) {
  const json plan = json_of(run_program(of_huang2016("poses --threshold 1e-12 --json")), kVerdictIsNo);
  EXPECT_EQ(plan.at("n"), 0);
  EXPECT_THAT(plan.at("poses"), IsEmpty());
}

TEST(PosesCommand, StartTurnsTheCircle) {
  const json plan = json_of(run_program(of_huang2016("poses --stage rough --start-deg 0 --json")));
  EXPECT_NEAR(plan.at("poses")[1].at("x_cmd_mm"), 500.0, 1e-6);
  EXPECT_NEAR(plan.at("poses")[1].at("y_cmd_mm"), 0.0, 1e-6);
}

const std::string kOptimal = "poses --optimal 12 --candidates 300";

TEST(OptimalPoses, HomeIsFirstAndNamesAreUnique) {
  const json plan = json_of(run_program(of_huang2016(kOptimal + " --json")));
  ASSERT_TRUE(has_keys(plan, "n curve poses criterion value workspace_std O1 O2 O3 O4 O5"));
  const std::vector<std::string> names = texts_of(plan["poses"], "pose");
  ASSERT_THAT(names, SizeIs(12));
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 12u);
  EXPECT_EQ(plan["poses"][0]["x_cmd_mm"], 0.0);
  EXPECT_EQ(plan["poses"][0]["z_cmd_mm"], -888.0);
}

TEST(OptimalPoses, TheSeedDecides) {
  const std::string once = run_program(of_huang2016(kOptimal + " --seed 4")).out;
  EXPECT_EQ(run_program(of_huang2016(kOptimal + " --seed 4")).out, once);
  EXPECT_NE(run_program(of_huang2016(kOptimal + " --seed 5")).out, once);
}

TEST(OptimalPoses, EveryCriterionGivesATableOfPoses) {
  for (const char* criterion : {"D", "A", "O3", "pose"}) {
    const TemporaryFolder folder;
    folder.write("poses.csv", folder.run(kOptimal + " --criterion " + criterion).out);
    const json joints = json_of(folder.run("inverse --poses poses.csv --json"));
    EXPECT_TRUE(is_matrix(joints.at("joints_deg"), 12, 4)) << criterion;
  }
}

/// Of two plans of the same candidates the one that was chosen for it promises more.
TEST(OptimalPoses, AreBetterThanOthers) {
  const json best = json_of(run_program(of_huang2016(kOptimal + " --criterion pose --json")));
  const json other = json_of(run_program(of_huang2016(kOptimal + " --criterion D --json")));
  EXPECT_LT(best.at("workspace_std").at("rms_aligned_mm"), other.at("workspace_std").at("rms_aligned_mm"));
}

/// The reflector turns with phi, so the tracker sees it where it faces +x or nearly so.
TEST(OptimalPoses, ATrackerSeesOnlySome) {
  const std::string tracker = " --tracker 4000,0,-900 --facing 1,0,0 --acceptance-deg 40";
  const json plan = json_of(run_program(of_huang2016(kOptimal + tracker + " --json")));
  ASSERT_THAT(plan.at("poses"), SizeIs(12));
  for (const json& pose : plan.at("poses")) {
    EXPECT_LT(std::abs(pose.at("phi_cmd_deg").get<double>()), 40.0 + 8.0) << pose;
  }
}

TEST(OptimalPoses, ATrackerThatSeesNothingIsRefused) {
  const ProgramResult result =
      run_program(of_huang2016(kOptimal + " --tracker 4000,0,-900 --facing 0,0,1 --acceptance-deg 5"));
  EXPECT_EQ(result.exit_code, kMathematicsSaysNo);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, HasSubstr("expected 12 visible poses within reach, got "));
}

/// Planned, seen beforehand, measured and calibrated from with a probe and a scale: no coordinate at all.
TEST_F(CalibrationCommands, NeedsNoTracker) {
  EXPECT_EQ(folder.run("poses --optimal 25 --candidates 400 --measure height --out poses.csv").exit_code, kDone);
  const json heights = json_of(folder.run("identifiability --poses poses.csv --measure height --json"));
  EXPECT_EQ(heights["rows"], 25);
  const json distances = json_of(folder.run("identifiability --poses poses.csv --measure home-distance --json"));
  EXPECT_EQ(distances["rows"], 24);
  const std::string simulate = "simulate --poses poses.csv --noise-mm 0.01 --seed 4 --frame random";
  EXPECT_EQ(folder.run(simulate + " --measure height --repeats 2 --out heights.csv").exit_code, kDone);
  EXPECT_EQ(folder.run(simulate + " --measure distance --out distances.csv").exit_code, kDone);
  const json found = json_of(folder.run(
      "calibrate --measurements heights.csv distances.csv --poses poses.csv --height-sigma-mm 0.01 --sigma-mm 0.01 "
      "--stage fine --json"));
  EXPECT_EQ(found["planes"].size(), 1);
  EXPECT_LT(found["after"]["rms_distance_mm"].get<double>(), 0.1 * found["before"]["rms_distance_mm"].get<double>());
  const json read = json_of(folder.run(simulate + " --measure height --json"));
  EXPECT_EQ(read["heights"].size(), 25);
  EXPECT_TRUE(read["heights"][0]["height_mm"].is_number());
  EXPECT_EQ(json_of(folder.run(simulate + " --measure home-distance --json"))["distances"].size(), 24);
}

/// Of readings without noise, too, which is the default of simulate.
TEST_F(CalibrationCommands, ReadWhatTheyWrite) {
  folder.make({"poses --robot linear_delta --stage fine --out rails.csv",
               "simulate --robot linear_delta --poses rails.csv --seed 1 --out read.csv",
               "calibrate --robot linear_delta --measurements read.csv --out rails.json"});
  const ProgramResult compensated = folder.run(words("compensate --calibration rails.json --poses rails.csv"));
  EXPECT_EQ(compensated.exit_code, kDone) << compensated.err;
}

/// A seed is the same instrument for every compiler: these are of the first one that made them.
TEST_F(CalibrationCommands, ASeedSetsTheInstrumentUpInOnePlace) {
  folder.write("poses.csv", "# robot: huang2016\nx_mm,y_mm,z_mm,phi_deg\n0,0,-888,0\n");
  const json read = json_of(folder.run("simulate --poses poses.csv --seed 4 --frame random --json"));
  const json& home = read.at("points").at(0);
  EXPECT_NEAR(home.at("x_mm").get<double>(), 1555.4126033535, 1e-6);
  EXPECT_NEAR(home.at("y_mm").get<double>(), -4709.4323171767, 1e-6);
  EXPECT_NEAR(home.at("z_mm").get<double>(), -147.8535507512, 1e-6);
}

/// A ball bar and two dials the whole way: planned within their range, seen beforehand, read, mixed, calibrated from,
/// shown and validated.
TEST_F(CalibrationCommands, ABallBarAndDialsGoTheWholeWay) {
  const std::string bar = " --measure ball-bar --at 0,0,-1500 ", dial = " --measure dial --at 0,0,1 ";
  EXPECT_EQ(folder.run("poses --optimal 25 --candidates 600 --range-mm 400,600" + bar + "--out poses.csv").exit_code,
            kDone);
  EXPECT_EQ(json_of(folder.run("identifiability --poses poses.csv --json" + bar))["rows"], 25);
  EXPECT_EQ(json_of(folder.run("identifiability --poses poses.csv --json" + dial))["rows"], 25);
  const std::string simulate = "simulate --poses poses.csv --noise-mm 0.01 --seed 4 --frame random";
  EXPECT_EQ(folder.run(simulate + bar + "--repeats 2 --truth truth.toml --out bar.csv").exit_code, kDone);
  EXPECT_EQ(folder.run(simulate + dial + "--out dial_z.csv").exit_code, kDone);
  EXPECT_EQ(folder.run(simulate + " --measure dial --at 1,0,0 --out dial_x.csv").exit_code, kDone);
  const json shown = json_of(folder.run(simulate + bar + "--json"));
  ASSERT_EQ(shown["ball_bar_lengths"].size(), 25);
  for (const json& one : shown["ball_bar_lengths"]) {
    EXPECT_GT(one["ball_bar_mm"], 250);  // the bar stands up to some 100 mm from where it was planned
    EXPECT_LT(one["ball_bar_mm"], 750);
  }
  const std::string calibrate =
      "calibrate --measurements bar.csv dial_z.csv dial_x.csv --poses poses.csv --sigma-mm 0.01 --height-sigma-mm "
      "0.01 ";
  const json found = json_of(folder.run(calibrate + "--stage fine --report page.html --json"));
  EXPECT_EQ(found["ball_bars"].size(), 1);
  EXPECT_TRUE(found["ball_bars"][0]["z_mm"].is_number());
  EXPECT_EQ(found["dials"].size(), 2);
  EXPECT_TRUE(found["dials"][1]["direction_x"].is_number());
  EXPECT_THAT(found["planes"], IsEmpty());
  EXPECT_TRUE(found["after"]["rms_height_mm"].is_null());
  EXPECT_TRUE(found["after"]["rms_distance_mm"].is_null());
  for (const char* rms : {"rms_ball_bar_mm", "rms_dial_mm"}) {
    EXPECT_LT(found["after"][rms].get<double>(), 0.1 * found["before"][rms].get<double>());
  }
  EXPECT_EQ(found["residuals"].size(), 50 + 25 + 25);
  EXPECT_TRUE(found["residuals"][0].contains("ball_bar_mm"));
  const std::string text = folder.run(calibrate + "--stage fine --dial-angle-deg 0.5 --out machine.json").out;
  EXPECT_THAT(text, AllOf(HasSubstr("residuals of ball-bar lengths"), HasSubstr("residuals of dial readings"),
                          Not(HasSubstr("points along the stated direction"))));
  EXPECT_EQ(folder.run("poses --stage fine --out others.csv").exit_code, kDone);
  EXPECT_EQ(
      folder.run("simulate --poses others.csv --errors truth.toml --noise-mm 0.01 --seed 5 --out other_bar.csv" + bar)
          .exit_code,
      kDone);
  const ProgramResult seen =
      folder.run("validate --calibration machine.json --measurements other_bar.csv --poses others.csv --sigma-mm 0.01");
  EXPECT_EQ(seen.exit_code, kDone) << seen.out;
  EXPECT_THAT(seen.out, AllOf(HasSubstr("ball-bar length, root mean square, mm"),
                              HasSubstr("degrees of freedom, consistent (p-value ")));
}

/// Each instrument at poses of its own: a table of poses for each file that names some, or one for all.
TEST_F(CalibrationCommands, FilesTakePosesOfTheirOwn) {
  folder.write("high.csv",
               "pose,x_mm,y_mm,z_mm,phi_deg\nA,0,0,-800,0\nB,300,0,-800,0\nC,0,300,-800,0\nD,-200,50,-800,0\n");
  folder.write("low.csv",
               "pose,x_mm,y_mm,z_mm,phi_deg\nA,0,0,-900,0\nB,-300,0,-900,0\nC,0,-300,-900,0\nD,90,-80,-900,0\n");
  const std::string simulate = "simulate --seed 4 --noise-mm 0.01 --frame random --poses ";
  EXPECT_EQ(folder.run(simulate + "high.csv --measure ball-bar --out bar.csv").exit_code, kDone);
  EXPECT_EQ(folder.run(simulate + "low.csv --measure height --out heights.csv").exit_code, kDone);
  EXPECT_EQ(folder.run(simulate + "low.csv --out points.csv").exit_code, kDone);
  const std::string calibrate = "calibrate --measurements bar.csv points.csv heights.csv --json --stage fine --poses ";
  const json found = json_of(folder.run(calibrate + "high.csv low.csv"));
  EXPECT_EQ(found["residuals"].size(), 4 + 4 + 4);
  double before = 0.0;
  for (const json& one : found["residuals"]) {
    if (one.contains("ball_bar_mm") || one.contains("height_mm"))
      before = std::max(before, std::abs(one["before_mm"].get<double>()));
  }
  EXPECT_LT(before, 10.0);  // each table met its own poses
  const ProgramResult few = folder.run("calibrate --measurements bar.csv heights.csv bar.csv --poses high.csv low.csv");
  EXPECT_EQ(few.exit_code, kWrongUsage);
  EXPECT_THAT(
      few.err,
      HasSubstr("--poses: expected one table for all measurements that name poses, or one for each, got 2 and none"));
  const ProgramResult many = folder.run("calibrate --measurements bar.csv points.csv --poses high.csv low.csv");
  EXPECT_EQ(many.exit_code, kWrongUsage);
  EXPECT_THAT(many.err,
              HasSubstr("--poses: expected one table for each of 1 measurement tables that name poses, got 2"));
}

TEST_F(CalibrationCommands, RefusesWhatAReadingDoesNotHave) {
  folder.write("poses.csv", folder.run("poses").out);
  const auto refused = [&](const std::string& command, const std::string& option) {
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, kWrongUsage) << command;
    EXPECT_THAT(result.err, HasSubstr(option)) << command;
  };
  refused("simulate --poses poses.csv --measure height --read-rotation", "--read-rotation");
  refused("simulate --poses poses.csv --measure pose --read-rotation",
          "--read-rotation: expected --measure other than");
  refused("identifiability --poses poses.csv --measure pose --second", "--second: expected --measure coordinates");
  refused("simulate --poses poses.csv --measure height --tracker-um 15,6,10,0.3", "--tracker-um");
  refused("simulate --poses poses.csv --measure distance --repeats 2", "--repeats");
  refused("simulate --poses poses.csv --measure distance --second 0,0,-150", "--second");
  refused("identifiability --poses poses.csv --measure height --rotation relative", "--rotation");
  refused("identifiability --poses poses.csv --measure height --second", "--second");
  refused("poses --optimal 20 --measure distance", "--measure");
  refused("poses --optimal 20 --measure height --read-rotation", "--read-rotation");
  refused("poses --optimal 20 --measure home-distance --second", "--second");
  refused("simulate --poses poses.csv --measure dial", "--at");
  refused("simulate --poses poses.csv --measure dial --at 0,0,0", "--at");
  refused("identifiability --poses poses.csv --measure distance --at 0,0,1", "--at");
  refused("poses --optimal 20 --measure dial --at 0,0,1 --range-mm 5,-5", "--range-mm");
  refused("poses --optimal 20 --range-mm 0,5", "--range-mm");
  refused("poses --measure ball-bar --range-mm 0,5", "--optimal");
}

// ---- identifiability

/// The table of docs/paper-slips.md, 2.3.
struct RankCase {
  std::string measure, frame, rotation;
  int rank;
  bool turned = true;

  std::string name() const { return measure + "_" + frame + "_" + rotation + (turned ? "" : "_without_turns"); }
};

void PrintTo(const RankCase& one, std::ostream* stream) { *stream << one.name(); }

class PaperRank : public testing::TestWithParam<RankCase> {};

INSTANTIATE_TEST_SUITE_P(
    Table, PaperRank,
    testing::Values(RankCase{"distance", "unknown", "none", 27}, RankCase{"distance", "unknown", "relative", 27},
                    RankCase{"distance", "unknown", "absolute", 28}, RankCase{"distance", "robot", "none", 27},
                    RankCase{"distance", "robot", "absolute", 28}, RankCase{"distance", "unknown", "none", 25, false},
                    RankCase{"coordinates", "unknown", "none", 27}, RankCase{"coordinates", "unknown", "relative", 27},
                    RankCase{"coordinates", "unknown", "absolute", 28},
                    RankCase{"coordinates", "unknown", "none", 25, false}, RankCase{"coordinates", "robot", "none", 31},
                    RankCase{"coordinates", "robot", "relative", 31}, RankCase{"coordinates", "robot", "absolute", 32},
                    RankCase{"coordinates", "robot", "none", 31, false}),
    [](const auto& one) { return one.param.name(); });

TEST_P(PaperRank, IsThatOfTheTable) {
  const RankCase& one = GetParam();
  const TemporaryFolder folder;
  std::vector<std::string> lines = lines_of(folder.run("poses --stage fine").out);
  for (std::string& line : lines) {
    if (!one.turned && line.starts_with('P')) line = line.substr(0, line.rfind(',')) + ",0";
  }
  folder.write("poses.csv", text_of(lines));
  const json seen = json_of(folder.run("identifiability --poses poses.csv --json --measure " + one.measure +
                                       " --frame " + one.frame + " --rotation " + one.rotation));
  ASSERT_TRUE(has_keys(seen, "rank parameters null_space O1 O2 O3 O4 O5 workspace_std"));
  EXPECT_EQ(seen["rank"], one.rank);
  EXPECT_THAT(seen["parameters"], SizeIs(32));
  ASSERT_THAT(seen["null_space"], SizeIs(32 - one.rank));
  for (const json& direction : seen["null_space"]) EXPECT_THAT(direction.at("direction"), SizeIs(32));
}

class IdentifiabilityCommand : public CalibrationCommands {};

TEST_F(IdentifiabilityCommand, NamesWhatIsNotSeen) {
  const auto unseen = [&](const std::string& options) {
    return texts_of(json_from("identifiability --poses poses.csv " + options).at("null_space"), "text");
  };
  EXPECT_THAT(
      unseen("--measure distance"),
      testing::ElementsAre(HasSubstr("shifts along x"), HasSubstr("shifts along y"), HasSubstr("shifts along z"),
                           HasSubstr("the slide zero shifts"), HasSubstr("the base rotates about the slide axis")));
  EXPECT_THAT(unseen("--measure distance --rotation absolute"), Not(Contains(HasSubstr("slide zero"))));
  EXPECT_THAT(unseen("--frame robot"), testing::ElementsAre("the slide zero shifts"));
  EXPECT_THAT(unseen("--frame robot --rotation absolute"), IsEmpty());
}

TEST_F(IdentifiabilityCommand, TheTextSaysTheSame) {
  const std::string text = written("identifiability --poses poses.csv");
  EXPECT_THAT(text, StartsWith("57 readings determine 27 of 32 parameters\n"));
  EXPECT_THAT(text, HasSubstr("not determined by these measurements: the slide zero shifts\n"));
  EXPECT_THAT(text, testing::ContainsRegex("\n *theta_offset deg  +e_x mm .*\n  before .*\n  limb 1 .*\n  limb 2 "));
  EXPECT_THAT(text, HasSubstr("* mostly from the prior"));
}

TEST_F(IdentifiabilityCommand, PromisesLessThanThePriors) {
  const json seen = json_from("identifiability --poses poses.csv");
  for (const json& one : seen.at("parameters")) {
    ASSERT_TRUE(has_keys(one, "name limb unit prior_std std data_share"));
    EXPECT_LE(one["std"], one["prior_std"].get<double>() * (1.0 + 1e-9)) << one;
  }
}

TEST_F(IdentifiabilityCommand, ASecondReflectorShowsTilt) {
  const json seen = json_from("identifiability --poses poses.csv --second");
  EXPECT_THAT(seen.at("parameters"), SizeIs(56));
  EXPECT_GT(seen.at("rank"), 32);
}

TEST_F(IdentifiabilityCommand, BetterInstrumentsPromiseMore) {
  const auto promised = [&](const std::string& options) {
    return json_from("identifiability --poses poses.csv " + options)
        .at("workspace_std")
        .at("max_aligned_mm")
        .get<double>();
  };
  EXPECT_LT(promised("--sigma-mm 0.001"), promised("--sigma-mm 0.1"));
  EXPECT_LT(promised("--frame robot"), promised("--frame unknown"));
}

/// Distances know no frame.
TEST_F(IdentifiabilityCommand, TheFrameDoesNotMatterToDistances) {
  const std::string command = "identifiability --poses poses.csv --measure distance --json --frame ";
  EXPECT_EQ(written(command + "robot"), written(command + "unknown"));
}

// ---- simulate

class SimulateCommand : public CalibrationCommands {
 protected:
  std::string simulated(const std::string& options) const {
    return text_of(table_of(written("simulate --poses poses.csv " + options)));
  }
  std::vector<std::string> header(const std::string& options) const {
    return fields_of(lines_of(simulated(options)).front());
  }
};

TEST_F(SimulateCommand, TheSeedDecides) {
  EXPECT_EQ(simulated("--noise-mm 0.02 --seed 3"), simulated("--noise-mm 0.02 --seed 3"));
  EXPECT_NE(simulated("--noise-mm 0.02 --seed 3"), simulated("--noise-mm 0.02 --seed 4"));
}

TEST_F(SimulateCommand, EveryMachineIsAnother) {
  EXPECT_NE(simulated("--machine 0"), simulated("--machine 1"));
  simulated("--machine 0 --truth zero.toml");
  simulated("--machine 1 --truth one.toml");
  EXPECT_NE(folder.read("zero.toml"), folder.read("one.toml"));
}

TEST_F(SimulateCommand, TheTruthIsTheMachine) {
  const std::string points = simulated("--machine 2 --truth truth.toml");
  EXPECT_EQ(simulated("--errors truth.toml"), points);
  ASSERT_EQ(run("inverse --poses poses.csv --out joints.csv").exit_code, kDone);
  const json reached = json_from("forward --joints joints.csv --errors truth.toml").at("poses");
  const std::vector<std::string> lines = lines_of(points);
  ASSERT_EQ(reached.size() + 1, lines.size());
  for (std::size_t k = 0; k < reached.size(); ++k) {
    EXPECT_NEAR(std::stod(fields_of(lines[k + 1])[5]), reached[k].at("x_mm"), 1e-9);
    EXPECT_NEAR(std::stod(fields_of(lines[k + 1])[7]), reached[k].at("z_mm"), 1e-9);
  }
}

TEST_F(SimulateCommand, WritesTheContractsColumns) {
  const std::string needed = "pose x_cmd_mm y_cmd_mm z_cmd_mm phi_cmd_deg x_mm y_mm z_mm";
  EXPECT_EQ(header(""), words(needed));
  EXPECT_EQ(header("--repeats 2"), words(needed + " repeat"));
  EXPECT_EQ(header("--read-rotation"), words(needed + " phi_deg"));
  EXPECT_EQ(header("--second 60,0,-40"), words(needed + " x2_mm y2_mm z2_mm"));
  EXPECT_EQ(header("--repeats 2 --read-rotation --second 60,0,-40"),
            words(needed + " repeat phi_deg x2_mm y2_mm z2_mm"));
}

TEST_F(SimulateCommand, RepeatsEveryPose) {
  const std::vector<std::string> lines = lines_of(simulated("--repeats 3 --repeatability-mm 0.01"));
  ASSERT_THAT(lines, SizeIs(1 + 3 * 19));
  EXPECT_EQ(fields_of(lines[1])[8], "1");
  EXPECT_EQ(fields_of(lines[3])[8], "3");
  EXPECT_EQ(fields_of(lines[3])[0], "P0");
  EXPECT_NE(lines[1], lines[2]);
}

TEST_F(SimulateCommand, TheSecondReflectorKeepsItsDistance) {
  for (const std::string& line : lines_of(simulated("--second 60,0,-80 --frame random"))) {
    const std::vector<std::string> f = fields_of(line);
    if (f[0] == "pose") continue;
    const auto between = [&](std::size_t k) { return std::stod(f[8 + k]) - std::stod(f[5 + k]); };
    EXPECT_NEAR(std::hypot(between(0), between(1), between(2)), 100.0, 1e-6) << line;
  }
}

TEST_F(SimulateCommand, ATrackerIsNoisierFarAway) {
  const auto noise = [&](const std::string& options) {
    const std::vector<std::string> exact = lines_of(simulated("")), read = lines_of(simulated(options));
    double sum = 0.0;
    for (std::size_t k = 1; k < exact.size(); ++k) {
      for (std::size_t i = 5; i < 8; ++i) {
        sum += std::pow(std::stod(fields_of(read[k])[i]) - std::stod(fields_of(exact[k])[i]), 2);
      }
    }
    return std::sqrt(sum / static_cast<double>(3 * (exact.size() - 1)));
  };
  EXPECT_NEAR(noise("--tracker-um 20,0,20,0"), 0.020, 0.006);
  EXPECT_GT(noise("--tracker-um 20,100,20,100"), 2.0 * noise("--tracker-um 20,0,20,0"));
}

TEST_F(SimulateCommand, JsonHoldsThePoints) {
  const json points = json_from("simulate --poses poses.csv --read-rotation --second 60,0,-40").at("points");
  ASSERT_THAT(points, SizeIs(19));
  for (const json& point : points) EXPECT_TRUE(has_keys(point, "pose x_mm y_mm z_mm phi_deg x2_mm y2_mm z2_mm"));
}

// ---- calibrate

/// A machine drawn from the tolerances, measured by a tracker that stands anywhere.
class MeasuredMachine : public CalibrationCommands {
 protected:
  void SetUp() override {
    CalibrationCommands::SetUp();
    folder.make(
        {"simulate --poses poses.csv --seed 7 --noise-mm 0.02 --frame random --truth truth.toml --out points.csv"});
  }

  /// points.csv as lines, to be changed and written again.
  std::vector<std::string> points() const { return table_of(folder.read("points.csv")); }
  json calibrated(const std::string& options, int exit_code = kDone) const {
    return json_from("calibrate --measurements points.csv " + options, exit_code);
  }
};

class CalibratePoints : public MeasuredMachine {};

TEST_F(CalibratePoints, Keys) {
  const json calibration = calibrated("");
  ASSERT_TRUE(has_keys(calibration, "accepted stages parameters rank null_space residual_rms_mm before after"));
  ASSERT_TRUE(has_keys(calibration, "robot covariance noise_mm inputs program date"));
  EXPECT_EQ(calibration["accepted"], true);
  EXPECT_EQ(calibration["rank"], 27);
  EXPECT_THAT(calibration["null_space"], SizeIs(5));
  EXPECT_THAT(calibration["stages"], SizeIs(2));
  EXPECT_LT(calibration["residual_rms_mm"], 0.05);
  EXPECT_NEAR(calibration["noise_mm"], 0.02, 0.01);
  EXPECT_LT(calibration["after"].at("max_volumetric_aligned_mm"), 0.1);
  EXPECT_GT(calibration["before"].at("max_volumetric_aligned_mm"), 1.0);
}

TEST_F(CalibratePoints, ParameterKeys) {
  const json calibration = calibrated("");
  std::map<std::string, std::size_t> with_status;
  for (const json& one : calibration.at("parameters")) {
    ASSERT_TRUE(has_keys(one, "name limb value unit std status"));
    ++with_status[one["status"]];
    EXPECT_EQ(one["status"] == "fixed", one["std"].is_null()) << one;
  }
  EXPECT_THAT(calibration["parameters"], SizeIs(56));
  EXPECT_GT(with_status["identified"], 20u);
  EXPECT_GT(with_status["prior"], 0u);
  EXPECT_EQ(with_status["identified"] + with_status["prior"] + with_status["fixed"], 56u);
  const std::size_t sought = 56 - with_status["fixed"];
  EXPECT_TRUE(is_matrix(calibration["covariance"], sought, sought));
}

/// Machines that differ by a motion of the whole keep distances alike; nothing else may be left of the truth.
TEST_F(CalibratePoints, ItsErrorsAreThoseOfTheMachine) {
  ASSERT_EQ(run("calibrate --measurements points.csv --out calibration.json").exit_code, kDone);
  written("poses --stage rough --out other.csv");
  written("inverse --poses other.csv --out joints.csv");
  const auto distances = [&](const std::string& errors) {
    const json poses = json_from("forward --joints joints.csv" + errors).at("poses");
    std::vector<double> all;
    for (const json& pose : poses) {
      const auto d = [&](const char* key) { return pose.at(key).get<double>() - poses[0].at(key).get<double>(); };
      all.push_back(std::hypot(d("x_mm"), d("y_mm"), d("z_mm")));
    }
    return all;
  };
  const auto truth = distances(" --errors truth.toml");
  EXPECT_THAT(distances(" --errors calibration.json"), testing::Pointwise(testing::DoubleNear(0.1), truth));
  EXPECT_THAT(distances(""), Not(testing::Pointwise(testing::DoubleNear(0.5), truth)));
}

/// Both with uneven drives and repeatability, at the commanded pose and at the one that is reached.
TEST_F(CalibratePoints, TheCompensatorStatesTheUncertaintyThatValidationPredicts) {
  ASSERT_EQ(run("calibrate --measurements points.csv --out calibration.json").exit_code, kDone);
  const json stated = json_from("compensate --calibration calibration.json --poses poses.csv").at("uncertainty");
  const json predicted = json_from("validate --calibration calibration.json --measurements points.csv").at("poses");
  ASSERT_EQ(stated.size(), predicted.size());
  for (std::size_t k = 0; k < stated.size(); ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double expected = predicted[k].at("predicted_U_mm")[axis];
      EXPECT_NEAR(stated[k].at("U_mm")[axis].get<double>(), expected, 0.03 * expected) << k << ", " << axis;
    }
    const double expected = predicted[k].at("predicted_U_deg");
    EXPECT_NEAR(stated[k].at("U_deg").get<double>(), expected, 0.03 * expected) << k;
  }
}

TEST_F(CalibratePoints, ItsJointsLeadToThePoses) {
  ASSERT_EQ(run("calibrate --measurements points.csv --out calibration.json").exit_code, kDone);
  ASSERT_EQ(run("inverse --poses poses.csv --errors calibration.json --out joints.csv").exit_code, kDone);
  const json reached = json_from("forward --joints joints.csv --errors calibration.json").at("poses");
  EXPECT_NEAR(reached[0].at("z_mm"), -888.0, 1e-6);
  EXPECT_NEAR(reached[1].at("y_mm"), -500.0, 1e-6);
  EXPECT_NEAR(reached[1].at("phi_deg"), 180.0, 1e-6);
}

TEST_F(CalibratePoints, ThePapersMethodFindsWhatDistancesTell) {
  const json calibration = calibrated("--method paper --stage fine");
  EXPECT_EQ(calibration.at("accepted"), true);
  EXPECT_EQ(calibration.at("rank"), 25);  // of Eq. (15)'s 26 columns: docs/paper-slips.md, 2.3
  EXPECT_LT(calibration.at("residual_rms_mm"), 0.05);
}

TEST_F(CalibratePoints, TheRoughStageSeeksTheEncoderOffsets) {
  const json calibration = calibrated("--stage rough");
  EXPECT_THAT(calibration.at("stages"), SizeIs(1));
  for (const json& one : calibration.at("parameters")) {
    EXPECT_EQ(one.at("status") == "identified", one.at("name") == "theta_offset") << one;
    EXPECT_NE(one.at("status"), "fixed") << one;  // held at nominal is not known exactly
  }
}

TEST_F(CalibratePoints, FixHoldsAtZero) {
  const json calibration = calibrated("--fix e_x2,alpha0");
  for (const json& one : calibration.at("parameters")) {
    const bool fixed = one.at("name") == "alpha0" || (one.at("name") == "e_x" && one.at("limb") == 2);
    EXPECT_EQ(one.at("status") == "fixed", fixed) << one;
    EXPECT_EQ(one.at("value") == 0.0, fixed) << one;
  }
}

TEST_F(CalibratePoints, ADotTellsLimbsFromNames) {
  const json calibration = calibrated("--fix alpha0.3,e_x.1,beta03");
  for (const json& one : calibration.at("parameters")) {
    const bool fixed = one.at("name") == "beta03" || (one.at("name") == "alpha0" && one.at("limb") == 3) ||
                       (one.at("name") == "e_x" && one.at("limb") == 1);
    EXPECT_EQ(one.at("status") == "fixed", fixed) << one;
  }
}

TEST_F(CalibratePoints, FreeTakesAwayThePrior) {
  const json calibration = calibrated("--free theta_offset");
  for (const json& one : calibration.at("parameters")) {
    EXPECT_EQ(one.at("prior_std").is_null(), one.at("name") == "theta_offset") << one;
  }
}

TEST_F(CalibratePoints, TolerancesAreThePriors) {
  folder.write("tolerances.toml", "theta_offset_deg = 1.5\ne_mm = 3\nrod_mean_mm = 2.4\nothers = \"exact\"\n");
  const json calibration = calibrated("--tolerances tolerances.toml");
  for (const json& one : calibration.at("parameters")) {
    const std::string name = one.at("name");
    const bool has_tolerance = name == "theta_offset" || name.starts_with("e_") || name == "rod_mean";
    EXPECT_EQ(one.at("status") != "fixed", has_tolerance) << one;
    EXPECT_NEAR(one.value("prior_std", json(0.0)).is_null() ? 0.5 : one["prior_std"].get<double>(),
                name == "theta_offset" || !has_tolerance ? 0.5
                : name == "rod_mean"                     ? 0.8
                                                         : 1.0,
                1e-9);
  }
}

TEST_F(CalibratePoints, SeveralFilesAreOneFit) {
  written("poses --optimal 15 --candidates 300 --out more.csv");
  written(
      "simulate --errors truth.toml --poses more.csv --seed 8 --noise-mm 0.02 --frame random --out more_points.csv");
  const json both = json_from("calibrate --measurements points.csv more_points.csv");
  EXPECT_EQ(both.at("reasons"), json::array());
  EXPECT_THAT(both.at("frames"), SizeIs(2));
  EXPECT_THAT(both.at("inputs"), SizeIs(2));
  EXPECT_GT(both.at("degrees_of_freedom"), calibrated("").at("degrees_of_freedom").get<int>() + 20);
}

TEST_F(CalibratePoints, AFileGivenTwiceCountsOnce) {
  const json twice = json_from("calibrate --measurements points.csv points.csv");
  EXPECT_THAT(twice.at("notes").dump(), HasSubstr("count once"));
  EXPECT_EQ(twice.at("degrees_of_freedom"), calibrated("").at("degrees_of_freedom"));
}

/// The same points as distances of all pairs, and as an instrument in metres exports them.
TEST_F(CalibratePoints, TellTheSameAsDistancesAndExports) {
  std::string distances = "from,to,distance_mm\n";
  std::string exported = "// A tracker's export\n// collection  group  name  X  Y  Z (m)\n";
  const std::vector<std::string> lines = points();
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const std::vector<std::string> to = fields_of(lines[k]);
    const auto metres = [&](std::size_t i) { return json(std::stod(to[i]) / 1000.0).dump(); };
    exported += "A main " + to[0] + " " + metres(5) + " " + metres(6) + " " + metres(7) + "\n";
    for (std::size_t j = 1; j < k; ++j) {
      const std::vector<std::string> from = fields_of(lines[j]);
      const auto d = [&](std::size_t i) { return std::stod(to[i]) - std::stod(from[i]); };
      distances += from[0] + "," + to[0] + "," + json(std::hypot(d(5), d(6), d(7))).dump() + "\n";
    }
  }
  folder.write("distances.csv", distances);
  folder.write("export.txt", exported + "A main REF1 0.1 0.2 0.3\n");
  const double of_points = calibrated("").at("after").at("max_volumetric_aligned_mm");
  for (const std::string command :
       {"--measurements distances.csv --poses poses.csv",
        "--measurements distances.csv --poses poses.csv --frame robot",
        "--measurements export.txt --poses poses.csv --columns name=3,x=4,y=5,z=6 --unit m"}) {
    SCOPED_TRACE(command);
    const json calibration = json_from("calibrate " + command);
    EXPECT_EQ(calibration.at("rank"), 27);
    EXPECT_NEAR(calibration.at("after").at("max_volumetric_aligned_mm"), of_points, 1e-3);
  }
}

TEST_F(CalibratePoints, AnExportsStrayNamesAreNoted) {
  std::string exported = "// name;x;y;z in mm\n\n# and another comment\n";
  for (const std::string& line : points()) {
    const std::vector<std::string> f = fields_of(line);
    if (f[0] != "pose" && f[0] != "P5") exported += f[0] + ";" + f[5] + ";" + f[6] + ";" + f[7] + "\n";
  }
  folder.write("export.txt", exported + "NEST;1;2;3\n");
  const json calibration =
      json_from("calibrate --measurements export.txt --poses poses.csv --columns name=1,x=2,y=3,z=4 --unit mm");
  EXPECT_EQ(calibration.at("accepted"), true);
  EXPECT_THAT(calibration.at("notes").get<std::vector<std::string>>(),
              AllOf(Contains(HasSubstr("NEST is not a pose")), Contains(HasSubstr("P5 was not measured"))));
}

TEST_F(CalibratePoints, ASwappedPairIsNamed) {
  std::vector<std::string> lines = points();
  std::vector<std::string> one = fields_of(lines[5]), other = fields_of(lines[9]);
  std::swap_ranges(one.begin() + 5, one.end(), other.begin() + 5);
  lines[5] = line_of(one);
  lines[9] = line_of(other);
  folder.write("points.csv", text_of(lines));
  const json calibration = calibrated("");
  EXPECT_EQ(calibration.at("accepted"), true);
  EXPECT_THAT(calibration.at("notes").get<std::vector<std::string>>(),
              AllOf(Contains(HasSubstr("P4 of points.csv: swapped with P8")),
                    Contains(HasSubstr("P8 of points.csv: swapped with P4"))));
  EXPECT_LT(calibration.at("residual_rms_mm"), 0.05);
}

TEST_F(CalibratePoints, AnOutlierIsNamedAndLeftOut) {
  std::vector<std::string> lines = points();
  std::vector<std::string> fields = fields_of(lines[7]);
  fields[6] = json(std::stod(fields[6]) + 1.0).dump();
  lines[7] = line_of(fields);
  folder.write("points.csv", text_of(lines));
  const json calibration = calibrated(""), kept = calibrated("--keep-outliers");
  EXPECT_THAT(calibration.at("notes").dump(), HasSubstr("outlier excluded: P6 of points.csv"));
  EXPECT_THAT(calibration.at("suspects")[0].at("reading").get<std::string>(), HasSubstr("P6"));
  EXPECT_EQ(calibration.at("suspects")[0].at("excluded"), true);
  EXPECT_THAT(kept.at("suspects")[0].at("reading").get<std::string>(), HasSubstr("P6"));
  EXPECT_EQ(kept.at("suspects")[0].at("excluded"), false);
  EXPECT_LT(calibration.at("residual_rms_mm"), kept.at("residual_rms_mm"));
}

TEST_F(CalibratePoints, ACleanMeasurementHasNoSuspectsLeftOut) {
  const json calibration = calibrated("");
  EXPECT_THAT(calibration.at("notes"), IsEmpty());
  for (const json& one : calibration.at("suspects")) EXPECT_EQ(one.at("excluded"), false) << one;
}

TEST_F(CalibratePoints, ABlankPointIsPassedOver) {
  std::vector<std::string> lines = points();
  std::vector<std::string> fields = fields_of(lines[7]);
  std::fill(fields.begin() + 5, fields.end(), "");
  lines[7] = line_of(fields);
  folder.write("points.csv", text_of(lines));
  const json calibration = calibrated("");
  EXPECT_EQ(calibration.at("accepted"), true);
  EXPECT_THAT(calibration.at("notes").dump(), HasSubstr("line 8: pose P6 has no point"));
}

TEST_F(CalibratePoints, RotationAndASecondReflectorTellMore) {
  written(
      "simulate --errors truth.toml --poses poses.csv --noise-mm 0.02 --read-rotation --rotation-noise-deg 0.05 "
      "--second 120,30,-100 --frame random --out more.csv");
  const json calibration = json_from("calibrate --measurements more.csv");
  EXPECT_EQ(calibration.at("accepted"), true);
  EXPECT_GT(calibration.at("rank"), 27);
  EXPECT_THAT(calibration.at("frames")[0].at("second_reflector_mm"), SizeIs(3));
  EXPECT_NEAR(calibration.at("frames")[0].at("second_reflector_mm")[0], 120.0, 1.0);
  EXPECT_LT(calibration.at("after").at("max_abs_rotation_deg"), 0.5);
}

TEST_F(CalibratePoints, InTheRobotsFrameMoreIsSeen) {
  written("simulate --errors truth.toml --poses poses.csv --noise-mm 0.02 --out robot.csv");
  EXPECT_EQ(json_from("calibrate --measurements robot.csv --frame robot").at("rank"), 31);
}

TEST_F(CalibratePoints, TheTextSaysWhatMatters) {
  const ProgramResult result = run("calibrate --measurements points.csv --out calibration.json");
  EXPECT_EQ(result.exit_code, kDone);
  EXPECT_THAT(result.out, StartsWith("calibration of huang2016: accepted\n"));
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("not determined by these measurements: "), HasSubstr("written to calibration.json")));
  const json file = json::parse(folder.read("calibration.json"));
  EXPECT_TRUE(file.at("accepted"));
  // A row a limb, in blocks that fit into a terminal, and the largest residuals.
  std::size_t rows = 0, residuals = 0;
  for (const std::string& line : lines_of(result.out)) {
    EXPECT_TRUE(!line.starts_with("  limb ") || line.size() <= 120) << line;
    rows += line.starts_with("  limb 1 ") ? 1 : 0;
    residuals += std::regex_match(line, std::regex("  P[0-9]+ +[0-9.]+( +-?[0-9.]+){3}")) ? 1 : 0;
  }
  EXPECT_EQ(rows, 2u) << result.out;
  EXPECT_EQ(residuals, 10u) << result.out;
  EXPECT_THAT(result.out, HasSubstr(fmt::format("  the 10 largest of {}; ", file.at("residuals").size())));
}

TEST_F(CalibratePoints, SourceDateEpochMakesTheSameBytes) {
  const Surroundings fixed_date{.folder = folder.path(), .environment = {"SOURCE_DATE_EPOCH=1000000000"}};
  const auto once = [&] { return run_program(of_huang2016("calibrate --measurements points.csv --json"), fixed_date); };
  const ProgramResult first = once();
  EXPECT_EQ(first.exit_code, kDone);
  EXPECT_THAT(first.out, HasSubstr("2001-09-09T01:46:40Z"));
  EXPECT_EQ(once().out, first.out);
}

TEST_F(CalibratePoints, AHeaderAfterAByteOrderMarkIsFound) {
  folder.write("points.csv", "\xEF\xBB\xBF# from a spreadsheet\r\n" + folder.read("points.csv"));
  EXPECT_EQ(calibrated("").at("rank"), 27);
}

/// Position and orientation of a body, planned, read, calibrated and validated: no command knows where it sits.
TEST_F(CalibrationCommands, MotionCaptureGoesAllTheWay) {
  const std::string mount = " --reflectors end-effector ", noise = "--sigma-mm 0.05 --sigma-deg 0.05 ";
  written("poses --optimal 16 --candidates 300 --measure pose" + mount + noise + "--seed 2 --out plan.csv");
  written("poses --optimal 12 --candidates 300 --measure pose" + mount + noise + "--seed 3 --out others.csv");
  const std::string instrument = mount + "--measure pose --noise-mm 0.05 --rotation-noise-deg 0.05 --frame random ";
  written("simulate --poses plan.csv --machine 3 --truth truth.toml --repeats 2" + instrument + "--out bodies.csv");
  written("simulate --poses others.csv --errors truth.toml --seed 5" + instrument + "--out check.csv");
  const std::vector<std::string> header = fields_of(table_of(folder.read("bodies.csv")).front());
  EXPECT_EQ(header, words("pose x_cmd_mm y_cmd_mm z_cmd_mm phi_cmd_deg x_mm y_mm z_mm repeat qw qx qy qz"));

  const ProgramResult said = run("calibrate --measurements bodies.csv" + mount + "--out calibration.json");
  ASSERT_EQ(said.exit_code, kDone) << said.out;
  EXPECT_THAT(said.out, HasSubstr("residuals of orientations, largest: "));
  const json calibration = json::parse(folder.read("calibration.json"));
  EXPECT_EQ(calibration.at("accepted"), true);
  EXPECT_NEAR(calibration.at("noise_mm"), 0.05, 0.02);
  EXPECT_NEAR(calibration.at("orientation_noise_deg"), 0.05, 0.02);
  EXPECT_THAT(calibration.at("frames")[0].at("body").at("translation_mm"), SizeIs(3));
  EXPECT_THAT(calibration.at("frames")[0].at("body").at("rotation"), SizeIs(3));
  const json& reading = calibration.at("residuals")[0];
  EXPECT_TRUE(has_keys(reading, "orientation_before_deg orientation_after_deg rotation_after_deg after_mm")) << reading;
  EXPECT_LT(calibration.at("after").at("max_orientation_deg"), 0.5);

  const ProgramResult held = run("validate --calibration calibration.json --measurements check.csv" + mount + noise);
  EXPECT_EQ(held.exit_code, kDone) << held.out;
  EXPECT_THAT(held.out, AllOf(HasSubstr("orientation of the body, deg"), HasSubstr("rotation relative to home, deg")));
  const json foreseen = json_from("identifiability --poses plan.csv --measure pose" + mount + noise);
  EXPECT_EQ(foreseen.at("rows"), 6 * 16);
  const json coordinates = json_from("identifiability --poses plan.csv --sigma-mm 0.05");
  EXPECT_LT(foreseen.at("workspace_std").at("max_rotation_deg"),
            coordinates.at("workspace_std").at("max_rotation_deg"));
  const json shown = json_from("simulate --poses plan.csv --measure pose").at("points");
  EXPECT_TRUE(has_keys(shown[0], "pose x_mm y_mm z_mm qw qx qy qz"));
}

// ---- validate

/// Poses that the calibration has not seen, measured three times from another place.
class ValidateCommand : public MeasuredMachine {
 protected:
  void SetUp() override {
    MeasuredMachine::SetUp();
    folder.make({"calibrate --measurements points.csv --out calibration.json",
                 "poses --optimal 20 --candidates 400 --seed 9 --out other.csv",
                 "simulate --errors truth.toml --poses other.csv --seed 11 --noise-mm 0.02 --repeats 3 "
                 "--repeatability-mm 0.01 --read-rotation --rotation-noise-deg 0.05 --frame random --out "
                 "other_points.csv"});
  }

  json validated(const std::string& options, int exit_code = kDone) const {
    return json_from("validate --calibration calibration.json --measurements other_points.csv " + options, exit_code);
  }
};

TEST_F(ValidateCommand, Keys) {
  const json validation = validated("");
  ASSERT_TRUE(has_keys(validation, "before after iso9283 accepted"));
  for (const char* part : {"before", "after"}) {
    for (const std::string& key :
         words("max_abs_distance_mm max_volumetric_mm max_volumetric_aligned_mm max_abs_rotation_deg")) {
      ASSERT_TRUE(validation[part].at(key).is_number()) << part << " " << key;
    }
  }
}

TEST_F(ValidateCommand, TheCalibrationHelps) {
  const json validation = validated("");
  for (const std::string& key :
       words("max_abs_distance_mm max_volumetric_mm max_volumetric_aligned_mm max_abs_rotation_deg")) {
    EXPECT_LT(validation["after"].at(key), 0.2 * validation["before"].at(key).get<double>()) << key;
  }
}

TEST_F(ValidateCommand, RepeatsShowIso9283) {
  const json iso = validated("").at("iso9283");
  ASSERT_TRUE(has_keys(iso, "max_AP_mm max_RP_mm max_AD_mm max_RD_mm poses"));
  ASSERT_THAT(iso["poses"], SizeIs(20));
  for (const json& pose : iso["poses"]) {
    EXPECT_EQ(pose.at("repeats"), 3);
    EXPECT_LT(pose.at("RP_mm"), 0.2) << pose;
    EXPECT_TRUE(has_keys(pose, "pose AP_mm AD_mm RD_mm AP_deg RP_deg"));
  }
}

/// A limit that the error keeps is still not kept for certain within the uncertainty of measuring.
TEST_F(ValidateCommand, ALimitIsProvenOrNot) {
  const double error = validated("").at("after").at("max_abs_distance_mm");
  const auto conformity = [&](double limit, int exit_code) {
    const json validation = validated("--limit-mm " + json(limit).dump(), exit_code);
    EXPECT_EQ(validation.at("accepted"), exit_code == kDone);
    EXPECT_THAT(validation.at("reasons"), SizeIs(exit_code));
    return validation.at("checks")[0].at("conformity").get<std::string>();
  };
  EXPECT_EQ(conformity(error + 0.2, kDone), "conforming");
  EXPECT_EQ(conformity(error + 0.001, kVerdictIsNo), "undecided");
  const double at_least = validated("--limit-mm 1").at("checks")[0].at("at_least");
  EXPECT_LT(at_least, error);
  EXPECT_EQ(conformity(error / 10, kVerdictIsNo), at_least > error / 10 ? "not conforming" : "undecided");
}

TEST_F(ValidateCommand, EveryLimitIsChecked) {
  const json kept = validated("--limit-mm 1 --limit-aligned-mm 1 --limit-deg 2");
  EXPECT_THAT(kept.at("checks"), SizeIs(3));
  const json broken = validated("--limit-mm 1 --limit-aligned-mm 0.001 --limit-deg 0.001", kVerdictIsNo);
  EXPECT_THAT(broken.at("reasons"), SizeIs(2));
}

TEST_F(ValidateCommand, ALimitOnRotationNeedsReadings) {
  written("simulate --errors truth.toml --poses other.csv --noise-mm 0.02 --frame random --out other_points.csv");
  const json validation = validated("--limit-deg 1", kVerdictIsNo);
  EXPECT_THAT(validation.at("reasons").dump(), HasSubstr("expected rotations for the limit on rotation, got none"));
  EXPECT_TRUE(validation.at("after").at("max_abs_rotation_deg").is_null());
}

TEST_F(ValidateCommand, TheMachineOfAnotherCalibrationIsTold) {
  written("simulate --poses other.csv --seed 21 --noise-mm 0.02 --frame random --out other_points.csv");
  EXPECT_THAT(validated("").at("reasons"), SizeIs(1));
}

TEST_F(ValidateCommand, ExportsAndSeveralFilesAreTakenToo) {
  std::string exported;
  for (const std::string& line : points()) {
    const std::vector<std::string> f = fields_of(line);
    if (f[0] != "pose") exported += f[0] + "\t" + f[5] + "\t" + f[6] + "\t" + f[7] + "\n";
  }
  folder.write("export.txt", exported);
  EXPECT_EQ(json_from("validate --calibration calibration.json --measurements export.txt --poses poses.csv --columns "
                      "name=1,x=2,y=3,z=4 --unit mm")
                .at("reasons"),
            json::array());
  EXPECT_THAT(
      json_from("validate --calibration calibration.json --measurements points.csv other_points.csv").at("poses"),
      SizeIs(19 + 20));
}

/// A calliper and a dial gauge: distances from home and heights that the true machine shows, read to 0.02 mm.
TEST_F(ValidateCommand, DistancesAndHeightsValidateToo) {
  written("inverse --poses other.csv --out joints.csv");
  const json places = json_from("forward --joints joints.csv --errors truth.toml").at("poses");
  const auto at = [&](std::size_t k, const char* axis) { return places.at(k).at(axis).get<double>(); };
  std::string distances = "from,to,distance_mm,sigma_mm\n", heights = "pose,height_mm,sigma_mm\n";
  const std::string home = places[0].at("name");
  for (std::size_t k = 0; k < places.size(); ++k) {
    const std::string name = places[k].at("name");
    const double off = k % 2 == 0 ? 0.02 : -0.02;
    heights += fmt::format("{},{},0.02\n", name, at(k, "z_mm") + 900.0 - 1e-3 * at(k, "x_mm") + off);
    if (k == 0) continue;
    const double length =
        std::hypot(at(k, "x_mm") - at(0, "x_mm"), at(k, "y_mm") - at(0, "y_mm"), at(k, "z_mm") - at(0, "z_mm"));
    distances += fmt::format("{},{},{},0.02\n", home, name, length + off);
  }
  folder.write("distances.csv", distances);
  folder.write("heights.csv", heights);
  const std::string command = "validate --calibration calibration.json --poses other.csv --measurements ";
  const json both = json_from(command + "distances.csv heights.csv");
  ASSERT_THAT(both.at("readings"), SizeIs(2 * places.size() - 1));
  EXPECT_THAT(both.at("poses"), IsEmpty());
  for (const json& one : both["readings"]) {
    EXPECT_LT(std::abs(one.at("after_mm").get<double>()), 2.0 * one.at("U_mm").get<double>()) << one;
    EXPECT_GT(one.at("U_mm"), 0.03);  // of what setting up the plane leaves
    EXPECT_EQ(one.at("sigma_mm"), 0.02);
  }
  EXPECT_EQ(both.at("agreement").at("contradicts"), false);
  EXPECT_EQ(both.at("agreement").at("dof"), 2 * places.size() - 1 - 3);  // the plane takes three
  EXPECT_TRUE(both.at("agreement").at("noise_dof").is_null());
  EXPECT_EQ(both.at("reasons"), json::array());
  const std::string text = written(command + "heights.csv");
  EXPECT_THAT(text, HasSubstr("height, root mean square, mm"));
  EXPECT_THAT(text, Not(HasSubstr("distance")));  // none was read
  EXPECT_THAT(text, HasSubstr("consistent (p-value "));
}

TEST_F(ValidateCommand, WhatACalibrationWasMadeFromConfirmsNothing) {
  const json own =
      json_from("validate --calibration calibration.json --measurements points.csv --limit-mm 50", kVerdictIsNo);
  EXPECT_THAT(own.at("reasons").dump(), HasSubstr("points.csv was used for the calibration"));
  folder.write("renamed.csv", folder.read("points.csv"));
  const json both =
      json_from("validate --calibration calibration.json --measurements other_points.csv renamed.csv --limit-mm 50",
                kVerdictIsNo);
  EXPECT_EQ(both.at("reasons"),
            json::array({"renamed.csv was used for the calibration, so it cannot confirm it: use other measurements"}));
}

TEST_F(ValidateCommand, AMachineThatWasKnockedContradictsItsCalibration) {
  std::string knocked = folder.read("truth.toml");
  const std::string key = "theta_offset_deg = ";
  const std::size_t from = knocked.find(key) + key.size(), end = knocked.find('\n', from);
  const double offset = std::stod(knocked.substr(from, end - from));
  folder.write("knocked.toml", knocked.replace(from, end - from, fmt::format("{}", offset + 0.1)));
  written("simulate --errors knocked.toml --poses other.csv --noise-mm 0.02 --repeats 3 --out other_points.csv");
  const json validation = validated("");
  EXPECT_EQ(validation.at("accepted"), nullptr);
  EXPECT_EQ(validation.at("agreement").at("contradicts"), true);
  EXPECT_THAT(validation.at("reasons").dump(), HasSubstr("differ from the predictions"));
  EXPECT_THAT(written("validate --calibration calibration.json --measurements other_points.csv --limit-mm 50"),
              HasSubstr("note: the readings differ from the predictions"));
}

TEST_F(ValidateCommand, WithoutALimitThereIsNoVerdict) {
  const std::string text = written("validate --calibration calibration.json --measurements other_points.csv");
  EXPECT_THAT(text, StartsWith("validation: no verdict, because no limit is set (--limit-mm)\n"));
  EXPECT_THAT(text, Not(HasSubstr("because the")));
  const json validation = validated("");
  EXPECT_EQ(validation.at("accepted"), nullptr);
  EXPECT_EQ(validation.at("checks"), json::array());
  // The same readings as the calibration's: against it, but no verdict; with a limit a reason.
  const std::string own = "validate --calibration calibration.json --measurements points.csv";
  EXPECT_THAT(written(own), HasSubstr("  against the calibration: points.csv was used for the calibration"));
  EXPECT_EQ(folder.run(own + " --limit-mm 50").exit_code, kVerdictIsNo);
}

TEST_F(ValidateCommand, TheTextSaysTheSame) {
  const std::string text =
      written("validate --calibration calibration.json --measurements other_points.csv --limit-mm 1");
  EXPECT_THAT(text, StartsWith("validation: accepted\n"));
  EXPECT_THAT(text, AllOf(HasSubstr("ISO 9283"), HasSubstr("limit 1: conforming")));
}

// ---- all of them

TEST(NewCommands, AnswerHelp) {
  for (const char* command :
       {"poses --help", "identifiability --help", "simulate --help", "calibrate --help", "validate --help"}) {
    const ProgramResult result = run_program(of_huang2016(command));
    EXPECT_EQ(result.exit_code, kDone) << command;
    EXPECT_THAT(result.out, HasSubstr("Usage:")) << command;
    EXPECT_THAT(result.err, IsEmpty()) << command;
  }
}

/// A rigid plate on three limbs goes the same way.
TEST(NewCommands, WorkForTheRotaryDelta) {
  const TemporaryFolder folder;
  for (const char* command :
       {"poses --stage fine --out poses.csv", "identifiability --poses poses.csv",
        "simulate --poses poses.csv --noise-mm 0.02 --frame random --truth truth.toml --out points.csv",
        "calibrate --measurements points.csv --out calibration.json", "poses --optimal 12 --candidates 300 --out o.csv",
        "simulate --errors truth.toml --poses o.csv --seed 2 --noise-mm 0.02 --frame random --out o_points.csv",
        "validate --calibration calibration.json --measurements o_points.csv"}) {
    const ProgramResult result = folder.run(std::string(command) + " --robot rotary_delta");
    EXPECT_EQ(result.exit_code, kDone) << command << "\n" << result.out << result.err;
  }
}

TEST(NewCommands, AnOutputThatCannotBeWrittenIsNotDone) {
  const TemporaryFolder folder;
  folder.write("poses.csv", folder.run("poses").out);
  for (const char* command : {"poses", "poses --optimal 5 --candidates 20", "identifiability --poses poses.csv",
                              "simulate --poses poses.csv", "simulate --poses poses.csv --json"}) {
    const ProgramResult result =
        run_program(of_huang2016(command), {.folder = folder.path(), .standard_output = "/dev/full"});
    EXPECT_EQ(result.exit_code, kWrongUsage) << command;
    EXPECT_THAT(result.err, Not(IsEmpty())) << command;
  }
}

/// One row per limb; e_x is half known from the measurements of the samples, e_y is not.
TEST(ParameterTables, MarkWhatTheMeasurementsDoNotDetermine) {
  const std::filesystem::path samples = source_folder() / "samples";
  const std::string planned = run_program({"identifiability", "--poses", samples / "plan.csv"}).out;
  EXPECT_THAT(planned, HasSubstr("\n  limb 1             0.049     0.50     0.71*    0.51  "));
  const std::string found = run_program({"calibrate", "--measurements", samples / "measured.csv"}).out;
  EXPECT_THAT(found,
              HasSubstr("\n  limb 1       0.15 +-0.11    0.5 +-1.2    0.4 +-1.7*   0.6 +-1.2    0.282 +-0.034 "));
  for (const std::string& text : {planned, found}) EXPECT_THAT(text, HasSubstr("  * mostly from the prior"));
}

}  // namespace
}  // namespace paracal::test::calibration_commands_test
