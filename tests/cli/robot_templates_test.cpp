// Every robot that is a file alone, from its template to corrected joints, as its owner goes.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "json_checks.hpp"
#include "paracal/kinematics/drive.hpp"
#include "paracal/units.hpp"
#include "run_program.hpp"
#include "support/robots.hpp"

namespace paracal::test::robot_templates_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class TemplateWalk : public EveryRobot {
 protected:
  void done(const std::string& command) const {
    const ProgramResult result = folder.run(words(command));
    ASSERT_EQ(result.exit_code, kDone) << command << '\n' << result.err;
  }
  json json_from(const std::string& command) const { return json_of(folder.run(words(command + " --json"))); }

  void SetUp() override {
    EveryRobot::SetUp();
    folder.make({fmt::format("robot --template {} --out r.toml", GetParam()),
                 "poses --robot r.toml --measure pose --optimal 30 --candidates 300 --out p.csv",
                 "simulate --robot r.toml --poses p.csv --measure pose --seed 3 --noise-mm 0.02 --rotation-noise-deg "
                 "0.01 --frame random --out m.csv --truth t.toml",
                 "calibrate --robot r.toml --measurements m.csv --out c.json"});
  }

  TemporaryFolder folder;
};
PARACAL_ON_HEXAPODS(TemplateWalk);

TEST_P(TemplateWalk, CorrectedJointsBringTheMachineToThePose) {
  const std::string_view unit = file_unit(joint_unit(robot.actuator()));
  const json wanted = json_from("compensate --robot r.toml --errors t.toml --poses p.csv");
  const std::string key = fmt::format("joints_{}", unit);
  EXPECT_TRUE(is_matrix(wanted.at(key), 30, 6));
  done("compensate --robot r.toml --errors t.toml --poses p.csv --out j.csv");
  EXPECT_THAT(folder.read("j.csv"), HasSubstr(fmt::format("q1_{}", unit)));
  done("forward --robot r.toml --errors t.toml --joints j.csv --out reached.csv");
  const json again = json_from("inverse --robot r.toml --poses reached.csv --errors t.toml");
  for (std::size_t k = 0; k < 30; ++k) {
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(again.at(key)[k][i].get<double>(), wanted.at(key)[k][i].get<double>(), 1e-9);
    }
  }
}

TEST_P(TemplateWalk, TheCalibrationIsSoundAndSpeaksOfItsOwnErrors) {
  const json found = json::parse(folder.read("c.json"));
  EXPECT_EQ(found.at("verdict"), "accepted");
  std::size_t k = 0;
  for (std::size_t limb = 0; limb < 6; ++limb) {
    for (const Source source : sources_of(robot.actuator())) {
      const json& one = found.at("parameters").at(k++);
      EXPECT_EQ(one.at("name"), name(source));
      EXPECT_EQ(one.at("unit"), file_unit(unit(source, robot.actuator())));
    }
  }
  EXPECT_EQ(found.at("parameters").size(), k);
  const json seen = json_from("identifiability --robot r.toml --poses p.csv --measure pose");
  EXPECT_EQ(seen.at("rank"), k - 12);
  done("poses --robot r.toml --measure pose --optimal 20 --candidates 300 --seed 9 --out q.csv");
  done(
      "simulate --robot r.toml --poses q.csv --measure pose --errors t.toml --seed 4 --noise-mm 0.02 "
      "--rotation-noise-deg 0.01 --frame random --out check.csv");
  done(
      "validate --robot r.toml --calibration c.json --measurements check.csv --sigma-mm 0.02 --sigma-deg 0.01 "
      "--limit-mm 1 --limit-deg 0.5");
}

/// How far a machine with one error stands from a commanded pose, error by error: a column of the printed matrices,
/// per unit of files.
TEST_P(TemplateWalk, ErrorModelIsWhereAnErrorTakesThePlate) {
  Pose pose{robot.workspace().centre()};
  pose.position.x() += 11.0;
  pose.tilt = {to_radians(3.0), to_radians(-4.0), to_radians(5.0)};
  const Eigen::Vector3d& at = pose.position;
  const json model =
      json_from(fmt::format("error-model --robot r.toml --pose {},{},{},3,-4,5", at.x(), at.y(), at.z()));
  const std::size_t own = sources_of(robot.actuator()).size();
  for (std::size_t k = 0; k < 6 * own; ++k) {
    const json& column = model.at("parameters").at("position").at(k);
    const std::size_t limb = k / own;
    const Source source = sources_of(robot.actuator())[k % own];
    EXPECT_EQ(column.at("name"), name(source));
    EXPECT_EQ(column.at("limb"), limb + 1);
    constexpr double kSmall = 1e-4;
    const auto taken = [&](double size) {
      SourceErrors errors;
      errors(limb, source) = from_file_unit(unit(source, robot.actuator()), size);
      return *drive(build(robot, errors), robot.nominal(), pose);
    };
    const PlateState there = taken(kSmall), back = taken(-kSmall);
    const Eigen::Vector3d motion = (there.position - back.position) / (2.0 * kSmall);
    const Eigen::Vector3d turn =
        (turned_away(robot.nominal(), pose, there) - turned_away(robot.nominal(), pose, back)) / (2.0 * kSmall);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<Eigen::Index>(axis);
      EXPECT_NEAR(model.at("G_position")[axis][k].get<double>(), motion(row), 1e-6) << column;
      EXPECT_NEAR(model.at("G_turn")[axis][k].get<double>(), turn(row), 1e-8) << column;
    }
  }
}

TEST_P(TemplateWalk, TolerancesAreStudied) {
  const json found = json_from("sensitivity --robot r.toml --quantity position");
  std::size_t shown = 0;
  for (const Source source : sources_of(robot.actuator())) {
    EXPECT_GT(found.at("largest").at(std::string(name(source))).get<double>(), 0.0);
    ++shown;
  }
  EXPECT_EQ(found.at("contributors").size(), shown);
  EXPECT_THAT(folder.run(words("sensitivity --robot r.toml --quantity tilt")).out, HasSubstr("mrad per mm"));
  const json analyzed =
      json_from("tolerance analyze --robot r.toml --max-tilt 0.2 --sigma-error 0.1 --failure-error 0.5");
  EXPECT_TRUE(analyzed.at("converged"));
}

/// A batch as customers get it: calibrated by full poses, tried in all tilts.
TEST_P(TemplateWalk, BatchesAreMade) {
  const auto make = [](int machines, const std::string& options) {
    return fmt::format("yield --robot r.toml --machines {} --noise-mm 0.02 --rotation-noise-deg 0.01 --seed 5 {}",
                       machines, options);
  };
  const int machines = every_machine() ? 12 : 4;
  const json made = json_from(make(machines, "--max-position-aligned-mm 0.3 --max-rotation-deg 0.2"));
  EXPECT_EQ(made.at("fates").at("accepted"), machines);
  EXPECT_EQ(made.at("passed"), machines);
  for (const char* of : {"distance_mm", "volumetric_aligned_mm", "rotation_deg"}) {
    const json& one = made.at("quantities").at(of);
    EXPECT_LT(one.at("after").at("p95").get<double>(), 0.5 * one.at("before").at("p95").get<double>()) << of;
  }
  EXPECT_GT(made.at("quantities").at("tilt_rad").at("before").at("p50").get<double>(), 0.0);
  EXPECT_THAT(folder.run(make(1, "")).out, HasSubstr("rotation, deg"));
  const json planned = json_from(make(1, "--poses p.csv"));  // what `poses` chooses of as many is what is chosen here
  EXPECT_EQ(planned.at("batch").at("stations"), made.at("batch").at("stations"));
  done("poses --robot r.toml --measure pose --optimal 20 --candidates 300 --seed 9 --out q.csv");
  const json fewer = json_from(make(2, "--poses q.csv"));
  EXPECT_EQ(fewer.at("batch").at("stations").at("count"), 20);
  EXPECT_EQ(fewer.at("fates").at("accepted"), 2);
}

}  // namespace
}  // namespace paracal::test::robot_templates_test
