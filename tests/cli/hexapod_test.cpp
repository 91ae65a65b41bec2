// A plate on struts from a template to corrected joints, as its owner goes; and what is not done for it.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "json_checks.hpp"
#include "run_program.hpp"

namespace paracal::test {
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
    for (const char* command :
         {"robot --template hexapod --out h.toml",
          "poses --robot h.toml --measure pose --optimal 24 --candidates 300 --out p.csv",
          "simulate --robot h.toml --poses p.csv --measure pose --seed 3 --noise-mm 0.02 --rotation-noise-deg 0.01 "
          "--frame random --out m.csv --truth t.toml",
          "calibrate --robot h.toml --measurements m.csv --out c.json"}) {
      const ProgramResult result = run(command);
      ASSERT_EQ(result.exit_code, kDone) << command << '\n' << result.err;
    }
  }

  TemporaryFolder folder;
};

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
  EXPECT_THAT(targets.out, HasSubstr("pose,x_mm,y_mm,z_mm,phi_deg,tilt_x_deg,tilt_y_deg,tilt_z_deg\n"));
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
  for (const char* command :
       {"sensitivity", "tolerance analyze", "tolerance allocate", "yield --machines 3", "error-model --pose 0,0,500,0",
        "poses --stage fine", "export --target c99 --calibration c.json", "report --calibration c.json --out r.html",
        "calibrate --measurements m.csv --report r.html",
        "compensate --calibration c.json --poses p.csv --way linear"}) {
    const ProgramResult result = run(std::string(command) + " --robot h.toml");
    EXPECT_EQ(result.exit_code, kWrongUsage) << command << result.err;
    EXPECT_THAT(result.err, testing::AnyOf(HasSubstr("struts"), HasSubstr("stays level"))) << command;
  }
  EXPECT_EQ(folder.names().count("r.html"), 0u);
}

TEST_F(Hexapod, ARobotOfArmsDoesNotTilt) {
  folder.write("tilted.csv", "x_mm,y_mm,z_mm,tilt_x_deg\n0,0,-900,2\n");
  for (const char* command : {"inverse --poses tilted.csv", "compensate --errors e.toml --poses tilted.csv"}) {
    folder.write("e.toml", "[[limb]]\n[[limb]]\n[[limb]]\n[[limb]]\n");
    const ProgramResult result = run(std::string(command) + " --robot huang2016");
    EXPECT_EQ(result.exit_code, kMathematicsSaysNo) << result.err;
    EXPECT_THAT(result.err, HasSubstr("such a plate stays level"));
  }
}

TEST_F(Hexapod, AnotherHexapodsCalibrationIsRefused) {
  std::string other = folder.read("h.toml");
  other.replace(other.find("281.908"), 7, "282.908");
  folder.write("other.toml", other);
  const ProgramResult result = run("validate --robot other.toml --calibration c.json --measurements m.csv");
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(result.err, HasSubstr("base_joint_mm"));
}

}  // namespace
}  // namespace paracal::test
