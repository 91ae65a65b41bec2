// A machine with uneven drives, from its readings to corrected joints and exports.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <sstream>

#include "json_checks.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/units.hpp"
#include "run_program.hpp"
#include "support/places.hpp"

namespace paracal::test::drives_cli_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// Points of a rotary Delta whose joints are off by some hundredths of a degree, smoothly along their stroke.
std::string readings(double off_deg) {
  const Robot robot = catalogue::rotary_delta();
  RandomStream random(3);
  const Machine machine = build(robot, draw_errors(robot, tolerances_of(robot), random));
  std::string text = "# robot: rotary_delta\npose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm\n";
  const std::vector<Station> stations = candidate_stations(robot, 40, 5);
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const Eigen::Vector3d& at = stations[k].commanded.position;
    Joints joints = believed_joints(robot, stations[k]);
    for (Eigen::Index i = 0; i < joints.size(); ++i)
      joints(i) += to_radians(off_deg) * std::sin(5.0 * joints(i) + static_cast<double>(i));
    const Eigen::Vector3d there = forward(machine, joints).plate.position;
    for (int visit = 0; visit < 3; ++visit) {
      text += fmt::format("P{},{},{},{}", k, at.x(), at.y(), at.z());
      for (int axis = 0; axis < 3; ++axis) text += fmt::format(",{:.6f}", there(axis) + 0.017 * random.normal());
      text += '\n';
    }
  }
  return text;
}

class UnevenDrives : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("measured.csv", readings(0.008));
    folder.write("poses.csv", "x_mm,y_mm,z_mm\n0,0,-900\n120,-80,-850\n-150,100,-950\n");
    calibrated = folder.run("calibrate --robot rotary_delta --measurements measured.csv --out c.json");
    ASSERT_EQ(calibrated.exit_code, kDone) << calibrated.out << calibrated.err;
  }
  std::string out(const std::string& command) const {
    const ProgramResult result = folder.run(command + " --robot rotary_delta");
    EXPECT_EQ(result.exit_code, kDone) << command << "\n" << result.err;
    return result.out;
  }

  TemporaryFolder folder;
  ProgramResult calibrated;
};

std::string without_comments(const std::string& text) {
  std::string lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with('#')) lines += line + '\n';
  }
  return lines;
}

TEST_F(UnevenDrives, AreStatedAndUsed) {
  EXPECT_THAT(calibrated.out, HasSubstr("uneven drives: with their smooth errors, 40 poses omitted one by one"));
  const std::string joints = without_comments(out("compensate --calibration c.json --poses poses.csv"));
  EXPECT_EQ(joints, without_comments(out("inverse --errors c.json --poses poses.csv")));
  EXPECT_NE(joints, without_comments(out("compensate --rigid --calibration c.json --poses poses.csv")));
  folder.write("joints.csv", joints);
  const json poses = json::parse(out("forward --errors c.json --joints joints.csv --json"))["poses"];
  EXPECT_NEAR(poses[1]["x_mm"].get<double>(), 120.0, 1e-3);
  EXPECT_NEAR(poses[1]["z_mm"].get<double>(), -850.0, 1e-3);
}

/// A compensated pose and its joints, from an export whose self-test is of the machine with its drives.
TEST_F(UnevenDrives, AreExportedToControllers) {
  const std::string joints = without_comments(out("compensate --calibration c.json --poses poses.csv"));
  for (const char* target : {"c99", "st", "linuxcnc"}) {
    const std::string text = out(fmt::format("export --calibration c.json --target {}", target)).substr(0, 3000);
    EXPECT_THAT(text, HasSubstr("; uneven drives included")) << target;
    EXPECT_THAT(text, Not(HasSubstr("drives are omitted"))) << target;
  }
  const json parameters = json::parse(out("export --calibration c.json --target json"));
  ASSERT_EQ(parameters["drives"].size(), 3U);
  EXPECT_EQ(parameters["drives"][0]["sizes_deg"].size(), 11U);
  const json calibration = json::parse(folder.read("c.json"));
  EXPECT_NEAR(parameters["drives"][0]["sizes_deg"][4].get<double>(), calibration["drives"][4]["size"].get<double>(),
              1e-12);
  const json& pose = parameters["self_test"][0]["pose"];
  folder.write("centre.csv", fmt::format("x_mm,y_mm,z_mm\n{},{},{}\n", pose["x_mm"].get<double>(),
                                         pose["y_mm"].get<double>(), pose["z_mm"].get<double>()));
  const json compensated =
      json::parse(out("compensate --calibration c.json --poses centre.csv --json"))["joints_deg"][0];
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(parameters["self_test"][0]["joints_deg"][i].get<double>(), compensated[i].get<double>(), 1e-9);
  }
}

/// Who asks for the rigid machine is told what that costs.
TEST_F(UnevenDrives, RigidExportsSayWhatTheyOmit) {
  for (const char* target : {"c99", "st", "linuxcnc", "json"}) {
    const std::string text =
        out(fmt::format("export --rigid --calibration c.json --target {}", target)).substr(0, 3000);
    EXPECT_THAT(text, HasSubstr("the smooth errors of the drives are omitted")) << target;
    EXPECT_THAT(text, Not(HasSubstr("uneven drives included"))) << target;
  }
}

/// Of a region from -130 to 90 mm: x = 120 mm is farther than a tenth of its width outside, -150 mm is not.
TEST_F(UnevenDrives, PosesOutsideOfTheCalibratedRegionAreCounted) {
  const std::string command = "compensate --calibration c.json --poses poses.csv";
  EXPECT_THAT(out(command), Not(HasSubstr("outside of the region")));
  EXPECT_EQ(json::parse(out(command + " --json"))["extrapolated"], 0);
  json narrow = json::parse(folder.read("c.json"));
  constexpr int kAlongX = 8;
  narrow["region"]["low_mm"][kAlongX] = -130.0;
  narrow["region"]["high_mm"][kAlongX] = 90.0;
  folder.write("c.json", narrow.dump(1));
  EXPECT_THAT(out(command), HasSubstr("# note: 1 of these poses lies outside of the region"));
  EXPECT_EQ(json::parse(out(command + " --json"))["extrapolated"], 1);
  narrow["region"] = nullptr;  // as in files of before
  folder.write("c.json", narrow.dump(1));
  EXPECT_EQ(json::parse(out(command + " --json"))["extrapolated"], 0);
}

/// A file that says that its drives count, but lacks a part of them, is refused with the key.
TEST_F(UnevenDrives, DamagedDrivesAreRefused) {
  const json whole = json::parse(folder.read("c.json"));
  const auto refused = [&](const std::function<void(json&)>& damage, const std::string& key) {
    json damaged = whole;
    damage(damaged);
    folder.write("d.json", damaged.dump(1));
    const ProgramResult result = folder.run("compensate --robot rotary_delta --calibration d.json --poses poses.csv");
    EXPECT_EQ(result.exit_code, kBadInputFile) << key << result.out;
    EXPECT_THAT(result.err, HasSubstr(key));
  };
  refused([](json& c) { c["drives"][2].erase("size"); }, "size");
  refused([](json& c) { c["drives"][2]["size"] = "much"; }, "size");
  refused([](json& c) { c["parameters"][0].erase("with_drives"); }, "with_drives");
  refused([](json& c) { c["drives"] = json::array(); }, "drives");
  refused([](json& c) { c["drives"][5]["size"] = 0.15 * c["drives"][5]["spacing"].get<double>(); }, "covariance");
  refused([](json& c) { c["uses_drives"] = 1; }, "uses_drives");
  refused([](json& c) { c["region"]["low_mm"].erase(0); }, "13 numbers");
  refused([](json& c) { std::swap(c["region"]["low_mm"], c["region"]["high_mm"]); }, "13 numbers");
  refused([](json& c) { std::swap(c["drives"][1], c["drives"][2]); }, "equally spaced");
  refused([](json& c) { c["drives"][2]["spacing"] = 0.9 * c["drives"][2]["spacing"].get<double>(); }, "equally spaced");
  refused([](json& c) { c["drives"][5]["size"] = 0.3 * c["drives"][5]["spacing"].get<double>(); }, "change by less");
}

/// Their rigid fit leaves residuals and moves a part far from its tolerance, and a moved instrument would explain some
/// of that. But with the drives every omitted pose is predicted, and nothing else is wrong.
TEST(SampleOfUnevenDrives, IsNoMistakeOfTheInput) {
  const TemporaryFolder folder;
  for (const auto& [robot, file] :
       {std::pair("rotary_delta", "uneven.csv"), std::pair("linear_delta", "uneven_rails.csv")}) {
    const auto measured = source_folder() / "tests/corpus/files" / file;
    const ProgramResult result =
        folder.run(fmt::format("calibrate --robot {} --measurements {} --out c.json", robot, measured.string()));
    EXPECT_EQ(result.exit_code, kDone) << result.out;
    EXPECT_EQ(json::parse(folder.read("c.json"))["uses_drives"], true) << robot;
  }
}

TEST(EvenDrives, AreNotMentioned) {
  const TemporaryFolder folder;
  folder.write("measured.csv", readings(0.0));
  const ProgramResult result = folder.run("calibrate --robot rotary_delta --measurements measured.csv --out c.json");
  EXPECT_EQ(result.exit_code, kDone) << result.err;
  EXPECT_THAT(result.out, Not(HasSubstr("uneven drives: with")));
  EXPECT_THAT(folder.run("export --robot rotary_delta --calibration c.json --target c99").out,
              Not(HasSubstr("neven drives")));
}

}  // namespace
}  // namespace paracal::test::drives_cli_test
