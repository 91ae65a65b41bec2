// A plate on struts from a template to corrected joints, as its owner goes; and what is not done for it.

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "json_checks.hpp"
#include "run_program.hpp"
#include "support/places.hpp"

namespace paracal::test::hexapod_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Hexapod : public testing::Test {
 protected:
  ProgramResult run(const std::string& command) const { return folder.run(words(command)); }
  json json_from(const std::string& command) const {
    const ProgramResult result = run(command + " --json");
    EXPECT_EQ(result.exit_code, kDone) << command << '\n' << result.err;
    return json::parse(result.out);
  }

  void SetUp() override {
    folder.make({"robot --template hexapod --out h.toml",
                 "poses --robot h.toml --measure pose --optimal 24 --candidates 300 --out p.csv",
                 "simulate --robot h.toml --poses p.csv --measure pose --seed 3 --noise-mm 0.02 --rotation-noise-deg "
                 "0.01 --frame random --out m.csv --truth t.toml",
                 "calibrate --robot h.toml --measurements m.csv --out c.json"});
  }

  TemporaryFolder folder;
};

/// Where a plate is tilted far, the nominal robot takes no pose with the joints of a machine that is off by 6 mm:
/// joints are what was asked.
TEST(SixFreedoms, JointsAreCorrectedWhereNoTargetHasThem) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& command) { return folder.run(words(command)); };
  ASSERT_EQ(run("robot --template hexapod --out r.toml").exit_code, kDone);
  std::string robot = folder.read("r.toml");
  robot.replace(robot.find("\nradius_mm = "), std::string("\nradius_mm = 80").size(), "\nradius_mm = 120");
  robot.replace(robot.find("\ntilt_deg = "), std::string("\ntilt_deg = 15").size(), "\ntilt_deg = 30");
  folder.write("r.toml", robot);
  folder.write("e.toml", "[[limb]]\nzero_mm = -6\n[[limb]]\n[[limb]]\n[[limb]]\n[[limb]]\n[[limb]]\n");
  folder.write("p.csv", "pose,x_mm,y_mm,z_mm,tilt_x_deg,tilt_y_deg,tilt_z_deg\na,-99.71,-66.7677,450,-30,30,-30\n");
  const std::string how = " --robot r.toml --errors e.toml --poses p.csv";
  const ProgramResult corrected = run("compensate" + how), exact = run("inverse" + how);
  ASSERT_EQ(corrected.exit_code, kDone) << corrected.err;
  EXPECT_THAT(corrected.out, HasSubstr(exact.out.substr(exact.out.find("\na,"))));
  const ProgramResult targets = run("compensate --targets" + how);
  EXPECT_EQ(targets.exit_code, kMathematicsSaysNo);
  EXPECT_THAT(targets.err, HasSubstr("no pose of the nominal robot"));
  const json found = json::parse(run("compensate --json" + how).out);
  EXPECT_TRUE(found.at("targets")[0].is_null());
}

TEST_F(Hexapod, CorrectedJointsBringTheMachineToThePose) {
  ASSERT_EQ(run("compensate --robot h.toml --errors t.toml --poses p.csv --out j.csv").exit_code, kDone);
  const json wanted = json_from("inverse --robot h.toml --poses p.csv --errors t.toml");
  EXPECT_TRUE(is_matrix(wanted.at("joints_mm"), 24, 6));
  ASSERT_EQ(run("forward --robot h.toml --errors t.toml --joints j.csv --out reached.csv").exit_code, kDone);
  const json again =
      json_from("inverse --robot h.toml --poses reached.csv --errors t.toml");  // tilts in rad, as printed
  for (std::size_t k = 0; k < 24; ++k) {
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(again.at("joints_mm")[k][i].get<double>(), wanted.at("joints_mm")[k][i].get<double>(), 1e-9);
    }
  }
}

TEST_F(Hexapod, SaysTargetsWithTiltAndHowSureTheyAre) {
  const json found = json_from("compensate --robot h.toml --calibration c.json --poses p.csv");
  ASSERT_EQ(found.at("targets").size(), 24u);
  EXPECT_TRUE(has_keys(found.at("targets")[0], "x_mm y_mm z_mm phi_deg tilt_x_deg tilt_y_deg tilt_z_deg"));
  EXPECT_TRUE(has_keys(found.at("uncertainty")[0], "U_mm U_tilt_deg"));
  for (const json& U : found.at("uncertainty")[0].at("U_tilt_deg")) EXPECT_GT(U.get<double>(), 0.0);
  const ProgramResult targets = run("compensate --robot h.toml --calibration c.json --poses p.csv --targets");
  EXPECT_THAT(targets.out,
              HasSubstr("pose,x_mm,y_mm,z_mm,phi_deg,tilt_x_deg,tilt_y_deg,tilt_z_deg,U_x_mm,U_y_mm,U_z_mm,"
                        "U_tilt_x_deg,U_tilt_y_deg,U_tilt_z_deg\n"));
  EXPECT_THAT(targets.out, HasSubstr(" mm, tilt "));
}

/// Names, units and keys are the struts' own, everywhere.
TEST_F(Hexapod, NothingSpeaksOfArms) {
  std::string said = folder.read("c.json") + folder.read("t.toml") + folder.read("h.toml");
  said += run("calibrate --robot h.toml --measurements m.csv").out;
  said += run("identifiability --robot h.toml --poses p.csv --measure pose").out;
  said += run("robot --robot h.toml").out + run("robot --robot h.toml --json").out;
  for (const char* of_arms :
       {"theta_offset", "arm_length", "alpha", "beta", "rod_", "\"e_", " e_", "parallelogram", "elbow"}) {
    EXPECT_EQ(said.find(of_arms), std::string::npos) << of_arms << ": " << said.substr(said.find(of_arms), 80);
  }
  EXPECT_THAT(said, HasSubstr("\"mm/m\""));
}

TEST_F(Hexapod, JointsAloneAreCommandsEnough) {
  const json with_joints = json_from("inverse --robot h.toml --poses p.csv");
  std::istringstream rows(folder.read("m.csv"));
  std::string text = "pose,q1_mm,q2_mm,q3_mm,q4_mm,q5_mm,q6_mm,x_mm,y_mm,z_mm,qw,qx,qy,qz\n", row;
  for (std::size_t k = 0; std::getline(rows, row);) {
    if (row.starts_with('#') || row.starts_with("pose")) continue;
    std::size_t at = 0;
    for (int comma = 0; comma < 8; ++comma) at = row.find(',', at) + 1;
    text += row.substr(0, row.find(','));
    for (const json& joint : with_joints.at("joints_mm")[k]) text += "," + joint.dump();
    text += "," + row.substr(at) + "\n";
    ++k;
  }
  folder.write("joints.csv", text);
  const json by_joints = json_from("calibrate --robot h.toml --measurements joints.csv");
  const json by_poses = json::parse(folder.read("c.json"));
  for (std::size_t k = 0; k < 48; ++k) {
    EXPECT_NEAR(by_joints.at("parameters")[k].at("value").get<double>(),
                by_poses.at("parameters")[k].at("value").get<double>(), 1e-4);
  }
}

TEST_F(Hexapod, WhatIsNotDoneForItSaysSo) {
  for (const char* command : {"tolerance allocate", "yield --machines 3 --rotation relative",
                              "error-model --pose 0,0,500,20", "sensitivity --pose 0,0,500,20", "poses --stage fine",
                              "compensate --calibration c.json --poses p.csv --way linear"}) {
    const ProgramResult result = run(std::string(command) + " --robot h.toml");
    EXPECT_EQ(result.exit_code, kWrongUsage) << command << result.err;
    EXPECT_THAT(result.err, testing::AnyOf(HasSubstr("stay level"), HasSubstr("keep level"), HasSubstr("tilt_x"),
                                           HasSubstr("orientation of this plate is measured")))
        << command;
  }
}

/// How far a machine with one error stands from a commanded pose, by the printed matrices and by the program's own
/// kinematics.
TEST_F(Hexapod, ErrorModelIsWhereAnErrorTakesThePlate) {
  const json model = json_from("error-model --robot h.toml --pose 30,-20,510,8,-6,9");
  EXPECT_TRUE(is_matrix(model.at("G_position"), 3, 48));
  EXPECT_TRUE(is_matrix(model.at("G_turn"), 3, 48));
  const json& gain = model.at("parameters").at("position")[4];
  EXPECT_EQ(gain.at("name"), "gain");
  EXPECT_EQ(gain.at("unit"), "mm/m");
  folder.write("one.csv", "x_mm,y_mm,z_mm,tilt_x_deg,tilt_y_deg,tilt_z_deg\n30,-20,510,8,-6,9\n");
  ASSERT_EQ(run("inverse --robot h.toml --poses one.csv --out j.csv").exit_code, kDone);
  const std::string others = "[[limb]]\n[[limb]]\n[[limb]]\n[[limb]]\n[[limb]]\n";
  folder.write("e.toml", "[[limb]]\nbase_mm = [0.0, 0.0, 0.001]\n" + others);
  const json stands = json_from("forward --robot h.toml --joints j.csv --errors e.toml").at("poses")[0];
  const json& G = model.at("G_position");
  EXPECT_NEAR(stands.at("x_mm").get<double>() - 30.0, 1e-3 * G[0][3].get<double>(), 1e-7);
  EXPECT_NEAR(stands.at("y_mm").get<double>() + 20.0, 1e-3 * G[1][3].get<double>(), 1e-7);
  EXPECT_NEAR(stands.at("z_mm").get<double>() - 510.0, 1e-3 * G[2][3].get<double>(), 1e-7);
  const ProgramResult text = run("error-model --robot h.toml --pose 30,-20,510");
  EXPECT_THAT(text.out, HasSubstr("limb 6 plate_z"));
}

TEST_F(Hexapod, TolerancesAreDesigned) {
  const json found = json_from("sensitivity --robot h.toml --quantity position --pose 0,0,500,5,0,0 --map map.csv");
  EXPECT_TRUE(has_keys(found.at("global"), "base_x base_y base_z gain plate_x plate_y plate_z zero"));
  EXPECT_TRUE(has_keys(found.at("local"), "base_x base_y base_z gain plate_x plate_y plate_z zero"));
  EXPECT_EQ(found.at("contributors").size(), 8u);
  EXPECT_GT(found.at("worst").at("tilt_x_deg").get<double>() * found.at("worst").at("tilt_x_deg").get<double>(), 1.0);
  EXPECT_THAT(folder.read("map.csv"),
              HasSubstr("x_mm,y_mm,z_mm,tilt_x_deg,tilt_y_deg,tilt_z_deg,radius_mm,three_sigma_position_mm\n"));
  EXPECT_THAT(run("sensitivity --robot h.toml").out, HasSubstr("mrad per mm/m"));
  folder.write(
      "problem.toml",
      "[[requirement]]\nquantity = \"position\"\nlimit_mm = 2\n"
      "[[requirement]]\nquantity = \"tilt\"\nlimit_deg = 0.5\n"
      "[cost.zero_mm]\nB = 1\nlower = 0.01\nupper = 2\n[cost.base_mm]\nB = 1\nlower = 0.01\nupper = 2\n"
      "[cost.plate_mm]\nB = 1\nlower = 0.01\nupper = 2\n[cost.gain_mm_per_m]\nB = 1\nlower = 0.1\nupper = 9\n");
  const json chosen = json_from("tolerance allocate --robot h.toml --problem problem.toml --toml chosen.toml");
  EXPECT_EQ(chosen.at("status"), "optimal");
  EXPECT_FALSE(chosen.contains("tolerances"));
  EXPECT_NEAR(chosen.at("requirements")[0].at("worst_mm").get<double>(), 2.0, 1e-4);
  const json analyzed = json_from(
      "tolerance analyze --robot h.toml --problem problem.toml --tolerances chosen.toml --model exact --sigma-error "
      "0.05 --failure-error 0.5");
  EXPECT_NEAR(analyzed.at("requirements")[0].at("rss_3sigma").get<double>(), 2.0, 1e-4);
  const json& drawn = analyzed.at("monte_carlo_3sigma_interval");
  EXPECT_LT(drawn[0].get<double>(), 2.1);
  EXPECT_GT(drawn[1].get<double>(), 1.9);
  const ProgramResult compensated = run("sensitivity --robot h.toml --quantity position-compensated");
  EXPECT_EQ(compensated.exit_code, kBadInputFile);
  EXPECT_THAT(compensated.err, HasSubstr("expected a robot whose plate three or four parallelograms keep level"));
  folder.write("left.toml", "[[requirement]]\nquantity = \"position-compensated\"\nlimit_mm = 2\n");
  const ProgramResult refused = run("tolerance analyze --robot h.toml --problem left.toml");
  EXPECT_EQ(refused.exit_code, kBadInputFile);
  EXPECT_THAT(refused.err, HasSubstr("left.toml:2: "));
}

TEST_F(Hexapod, ARobotOfArmsDoesNotTilt) {
  folder.write("tilted.csv", "x_mm,y_mm,z_mm,tilt_x_deg\n0,0,-900,2\n");
  for (const char* command : {"inverse --poses tilted.csv", "compensate --errors e.toml --poses tilted.csv"}) {
    folder.write("e.toml", "[[limb]]\n[[limb]]\n[[limb]]\n[[limb]]\n");
    const ProgramResult result = run(std::string(command) + " --robot huang2016");
    EXPECT_EQ(result.exit_code, kMathematicsSaysNo) << result.err;
    EXPECT_THAT(result.err, HasSubstr("because this plate stays level"));
  }
}

/// Orientations that were read are held to the limit on rotations, and U in use of the calibration too.
TEST_F(Hexapod, OrientationsAreHeldToALimit) {
  for (const char* command :
       {"poses --robot h.toml --measure pose --optimal 20 --candidates 300 --seed 9 --out q.csv",
        "simulate --robot h.toml --poses q.csv --measure pose --errors t.toml --seed 4 --noise-mm 0.02 "
        "--rotation-noise-deg 0.01 --frame random --out check.csv"}) {
    ASSERT_EQ(run(command).exit_code, kDone) << command;
  }
  const std::string validate =
      "validate --robot h.toml --calibration c.json --measurements check.csv --sigma-mm 0.02 --sigma-deg 0.01 "
      "--limit-deg ";
  EXPECT_EQ(run(validate + "0.5").exit_code, kDone);
  const json pose = json_from(validate + "0.5").at("poses")[3];
  EXPECT_EQ(pose.at("predicted_U_tilt_deg").size(), 3u);
  EXPECT_GT(pose.at("predicted_U_tilt_deg")[2].get<double>(), 1e-4);
  EXPECT_FALSE(pose.contains("predicted_U_deg"));  // of an end-effector that turns
  const ProgramResult tight = run(validate + "0.002");
  EXPECT_EQ(tight.exit_code, kVerdictIsNo);
  EXPECT_THAT(tight.out, HasSubstr("orientation error, rad"));
  const ProgramResult in_use = run("calibrate --robot h.toml --measurements m.csv --limit-deg 0.002");
  EXPECT_EQ(in_use.exit_code, kVerdictIsNo);
  EXPECT_THAT(in_use.out, HasSubstr("rotations"));
}

TEST_F(Hexapod, AnotherHexapodsCalibrationIsRefused) {
  std::string other = folder.read("h.toml");
  other.replace(other.find("281.908"), 7, "282.908");
  folder.write("other.toml", other);
  const ProgramResult result = run("validate --robot other.toml --calibration c.json --measurements m.csv");
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(result.err, HasSubstr("base_joint_mm"));
}

/// From a plan to corrected targets and a controller with seven joints.
TEST(SevenStruts, JointsAreReadings) {
  TemporaryFolder folder;
  folder.write("r.toml", read_text(source_folder() / "samples/seven_struts.toml"));
  folder.make({"poses --robot r.toml --measure pose --optimal 20 --candidates 200 --out p.csv",
               "simulate --robot r.toml --poses p.csv --measure pose --noise-mm 0.02 --rotation-noise-deg 0.01 "
               "--joint-noise 0.005 --seed 2 --out m.csv"});
  const auto run = [&](const std::string& command) { return folder.run(words(command)); };
  const ProgramResult found = run("calibrate --robot r.toml --measurements m.csv --joint-sigma 0.005 --out c.json");
  ASSERT_EQ(found.exit_code, kDone) << found.err;
  EXPECT_THAT(found.out, HasSubstr("joints of spare limbs disagree, rms:"));
  EXPECT_EQ(run("compensate --calibration c.json --poses p.csv --targets --out t.csv").exit_code, kDone);
  EXPECT_THAT(folder.read("t.csv"),
              HasSubstr("# note: the joints that the controller computes from these targets differ"));
  const ProgramResult filtered = run("export --calibration c.json --target csv --input p.csv --out f.csv");
  EXPECT_THAT(filtered.out + filtered.err, HasSubstr("assumed: the joints that the controller computes"));
  EXPECT_EQ(run("export --calibration c.json --target c99 --out x.h").exit_code, kDone);
  EXPECT_THAT(folder.read("x.h"), HasSubstr("a plate on 7 limbs"));
  folder.make({"poses --robot huang2016 --optimal 20 --candidates 200 --out h.csv",
               "simulate --robot huang2016 --poses h.csv --noise-mm 0.02 --out d.csv"});
  const ProgramResult none = run("calibrate --robot huang2016 --measurements d.csv --joint-sigma 0.01");
  EXPECT_EQ(none.exit_code, kWrongUsage);
  EXPECT_THAT(none.err, HasSubstr("--joint-sigma: expected a robot with more limbs"));
}

}  // namespace
}  // namespace paracal::test::hexapod_test
