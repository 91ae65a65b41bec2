// Every plate between guides that is a file alone, from its template to corrected joints, as its owner goes: points of
// a tracker or a camera, and what else a plate in a plane shows.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "json_checks.hpp"
#include "paracal/kinematics/drive.hpp"
#include "paracal/units.hpp"
#include "run_program.hpp"
#include "support/robots.hpp"

namespace paracal::test::guided_plates_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class GuidedWalk : public EveryRobot {
 protected:
  ProgramResult run(const std::string& command) const { return folder.run(words(command)); }
  void done(const std::string& command) const {
    const ProgramResult result = run(command);
    ASSERT_EQ(result.exit_code, kDone) << command << '\n' << result.err;
  }
  json json_from(const std::string& command) const { return json_of(run(command + " --json")); }

  void SetUp() override {
    EveryRobot::SetUp();
    folder.make({fmt::format("robot --template {} --out r.toml", GetParam()),
                 "poses --robot r.toml --optimal 30 --candidates 300 --out p.csv",
                 "simulate --robot r.toml --poses p.csv --seed 3 --noise-mm 0.01 --frame random --out m.csv --truth "
                 "t.toml"});
  }
  void calibrate() const { done("calibrate --robot r.toml --measurements m.csv --out c.json"); }

  TemporaryFolder folder;
};
PARACAL_ON_GUIDED_PLATES(GuidedWalk);

TEST_P(GuidedWalk, CorrectedJointsBringTheMachineToThePose) {
  const std::string key = fmt::format("joints_{}", file_unit(joint_unit(robot.actuator())));
  const json wanted = json_from("compensate --robot r.toml --errors t.toml --poses p.csv");
  EXPECT_TRUE(is_matrix(wanted.at(key), 30, robot.limb_count()));
  done("compensate --robot r.toml --errors t.toml --poses p.csv --out j.csv");
  done("forward --robot r.toml --errors t.toml --joints j.csv --out reached.csv");
  const json again = json_from("inverse --robot r.toml --poses reached.csv --errors t.toml");
  for (std::size_t k = 0; k < 30; ++k) {
    for (std::size_t i = 0; i < robot.limb_count(); ++i) {
      EXPECT_NEAR(again.at(key)[k][i].get<double>(), wanted.at(key)[k][i].get<double>(), 1e-9);
    }
  }
}

TEST_P(GuidedWalk, TheCalibrationIsSoundAndIsValidated) {
  calibrate();
  const json found = json::parse(folder.read("c.json"));
  EXPECT_EQ(found.at("verdict"), "accepted");
  EXPECT_EQ(found.at("stages").back().at("name"), "fine");
  EXPECT_EQ(found.at("parameters").size(), robot.limb_count() * sources_of(robot.actuator()).size());
  EXPECT_EQ(found.at("use").at("rotation_deg").is_null(), !robot.commands_tilt());
  done("poses --robot r.toml --optimal 20 --candidates 300 --seed 9 --out q.csv");
  done("simulate --robot r.toml --poses q.csv --errors t.toml --seed 4 --noise-mm 0.01 --frame random --out check.csv");
  done("validate --robot r.toml --calibration c.json --measurements check.csv --sigma-mm 0.01 --limit-mm 0.2");
  // A controller reads the targets, with their U, back.
  done("compensate --calibration c.json --poses p.csv --targets --out targets.csv");
  EXPECT_EQ(json_from("inverse --robot r.toml --poses targets.csv").at("names").size(), 30u);
  done("report --calibration c.json --measurements m.csv --out page.html");
}

/// Errors that take a plate out of its plane show nowhere, and are called what they are.
TEST_P(GuidedWalk, WhatGuidesTakeUpIsNotIdentifiable) {
  const json seen = json_from("identifiability --robot r.toml --poses p.csv");
  EXPECT_EQ(seen.at("rank").get<std::size_t>() + seen.at("null_space").size(), seen.at("parameters").size());
  std::string text;
  for (const json& one : seen.at("null_space")) text += one.at("text").get<std::string>() + '\n';
  for (std::size_t limb = 1; limb <= robot.limb_count(); ++limb) {
    EXPECT_THAT(text, HasSubstr(fmt::format("plate_z of limb {} (it changes none of these readings)", limb)));
  }
  EXPECT_THAT(text, HasSubstr("the whole robot shifts along x"));
  // Two belts alone begin on one line, and neither end of it shows in which direction of y it stands.
  const bool singly = robot.actuator() == Actuator::strut && robot.limb_count() == 2;
  EXPECT_THAT(text, HasSubstr(singly ? "base_y of limb 1 (it changes none" : "the whole robot shifts along y"));
  EXPECT_THAT(text, HasSubstr(singly ? "base_y of limb 2 (it changes none" : "the base rotates about z"));
}

TEST_P(GuidedWalk, ErrorModelIsWhereAnErrorTakesThePlate) {
  Pose pose{robot.workspace().centre()};
  pose.position.x() += 11.0;
  const Eigen::Vector3d& at = pose.position;
  const json model = json_from(fmt::format("error-model --robot r.toml --pose {},{},{}", at.x(), at.y(), at.z()));
  const std::size_t own = sources_of(robot.actuator()).size();
  for (std::size_t k = 0; k < robot.limb_count() * own; ++k) {
    const Source source = sources_of(robot.actuator())[k % own];
    constexpr double kSmall = 1e-4;
    const auto taken = [&](double size) {
      SourceErrors errors;
      errors(k / own, source) = from_file_unit(unit(source, robot.actuator()), size);
      return *drive(build(robot, errors), robot.nominal(), pose);
    };
    const Eigen::Vector3d motion = (taken(kSmall).position - taken(-kSmall).position) / (2.0 * kSmall);
    const Eigen::Vector3d turn = (taken(kSmall).tilt - taken(-kSmall).tilt) / (2.0 * kSmall);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<Eigen::Index>(axis);
      EXPECT_NEAR(model.at("G_position")[axis][k].get<double>(), motion(row), 1e-6) << name(source);
      EXPECT_NEAR(model.at("G_turn")[axis][k].get<double>(), turn(row), 1e-8) << name(source);
    }
  }
}

TEST_P(GuidedWalk, TolerancesAreStudied) {
  const std::string length(robot.actuator() == Actuator::strut ? "zero" : "rod_length");
  const json found = json_from("sensitivity --robot r.toml --quantity position");
  EXPECT_GT(found.at("largest").at(length).get<double>(), 0.0);
  EXPECT_EQ(found.at("largest").at("plate_z").get<double>(), 0.0);
  folder.write("p.toml", fmt::format("[[requirement]]\nquantity = \"position\"\nlimit_mm = 9\n\n[cost.{}_mm]\nB = "
                                     "1.0\nlower = 0.01\nupper = 1.0\n",
                                     length));
  const json analyzed =
      json_from("tolerance analyze --robot r.toml --problem p.toml --sigma-error 0.1 --failure-error 0.5");
  EXPECT_TRUE(analyzed.at("converged"));
  const json allocated = json_from("tolerance allocate --robot r.toml --problem p.toml");
  EXPECT_EQ(allocated.at("status"), "optimal");
  done("sensitivity --robot r.toml --quantity position --report page.html");
  for (const char* of_tilts : {"sensitivity --robot r.toml", "tolerance analyze --robot r.toml"}) {
    const ProgramResult refused = run(of_tilts);
    EXPECT_EQ(refused.exit_code, kBadInputFile) << of_tilts;
    EXPECT_THAT(refused.err, HasSubstr("the guides prevent tilt: expected position or distance")) << of_tilts;
  }
}

TEST_P(GuidedWalk, BatchesAreMade) {
  const auto make = [](int machines, const std::string& options) {
    return fmt::format("yield --robot r.toml --machines {} --noise-mm 0.01 --rotation-noise-deg 0.01 --seed 5 {}",
                       machines, options);
  };
  const int machines = every_machine() ? 12 : 4;
  const json made = json_from(make(machines, "--max-position-aligned-mm 0.3"));
  EXPECT_EQ(made.at("fates").at("accepted"), machines);
  EXPECT_EQ(made.at("passed"), machines);
  EXPECT_EQ(made.at("quantities").at("rotation_deg").is_null(), !robot.commands_tilt());
  EXPECT_THAT(run(make(1, "")).out, testing::Not(HasSubstr("tilt, rad")));
  EXPECT_EQ(run(make(1, "--max-tilt-rad 1")).exit_code, kWrongUsage);
  const json& distance = made.at("quantities").at("distance_mm");
  EXPECT_LT(distance.at("after").at("p95").get<double>(), 0.5 * distance.at("before").at("p95").get<double>());
}

/// A pose that guides do not let be says so, and poses of a plane need not say where the plane is.
TEST_P(GuidedWalk, PosesBesideTheGuidesAreRefused) {
  if (robot.freedoms().holds_z()) {
    folder.write("lifted.csv", "pose,x_mm,y_mm,z_mm\nA,1,2,3\n");
    const ProgramResult lifted = run("inverse --robot r.toml --poses lifted.csv");
    EXPECT_EQ(lifted.exit_code, kMathematicsSaysNo);
    EXPECT_THAT(lifted.err, HasSubstr("expected z and tilts as the guides fix them"));
    folder.write("flat.csv", "pose,x_mm,y_mm\nA,1,2\n");
    folder.write("stated.csv", "pose,x_mm,y_mm,z_mm\nA,1,2,0\n");
    EXPECT_EQ(run("inverse --robot r.toml --poses flat.csv").out, run("inverse --robot r.toml --poses stated.csv").out);
  }
  folder.write("tilted.csv", "pose,x_mm,y_mm,z_mm,tilt_x_deg\nA,1,2,0,3\n");
  EXPECT_EQ(run("inverse --robot r.toml --poses tilted.csv").exit_code, kMathematicsSaysNo);
}

/// A machine whose rim is singular with the errors that were found: the page of its calibration has no map, and says
/// so.
TEST(GuidedPlates, APageHasNoMapWhereTheMachineIsSingular) {
  const TemporaryFolder folder;
  folder.write("r.toml", R"(name = "dextar"
[plate]
freedoms = ["x", "y"]
[[limb]]
kind = "arm"
base_joint_mm = [-59, -110, 0]
plate_joint_mm = [0, 0, 0]
rod_mm = 90.0
arm_mm = 90.0
axis = [0, 0, 1]
arm_at_zero = [-0.766044, 0.642788, 0]
[[limb]]
kind = "arm"
base_joint_mm = [59, -110, 0]
plate_joint_mm = [0, 0, 0]
rod_mm = 90.0
arm_mm = 90.0
axis = [0, 0, 1]
arm_at_zero = [0.766044, 0.642788, 0]
[workspace]
radius_mm = 25
[tolerances]
zero_deg = 0.5
base_mm = 0.3
arm_length_mm = 0.2
alpha0_deg = 0.1
beta0_deg = 0.1
rod_length_mm = 0.2
plate_mm = 0.2
)");
  folder.write("p.csv", R"(pose,x_cmd_mm,y_cmd_mm,z_cmd_mm
P0,0,0,0
P1,1,6,0
P2,24,6,0
P3,15,-18,0
P4,-14,-18,0
P5,-24,6,0
P6,12,20,0
P7,-12,20,0
P8,20,0,0
P9,-20,-2,0
)");
  for (const char* command :
       {"simulate --robot r.toml --poses p.csv --seed 2 --noise-mm 0.02 --out m.csv",
        "calibrate --robot r.toml --measurements m.csv --out c.json --report calibrate.html",
        "report --calibration c.json --out report.html",
        "validate --calibration c.json --measurements m.csv --sigma-mm 0.02 --report validate.html"}) {
    const ProgramResult result = folder.run(words(command));
    EXPECT_LE(result.exit_code, kVerdictIsNo) << command << '\n' << result.err;
  }
  for (const auto& [page, result] :
       {std::pair{"calibrate", "calibration"}, {"report", "calibration"}, {"validate", "validation"}}) {
    const json data = data_in(folder.read(fmt::format("{}.html", page)));
    EXPECT_FALSE(data.at("figures").contains("error_map"));
    EXPECT_THAT(data.at("results").at(result).at("notes").dump(), HasSubstr("no map of errors")) << page;
  }
}

}  // namespace
}  // namespace paracal::test::guided_plates_test
