// A robot whose workspace is a box, from its file to corrected joints and a page.

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "json_checks.hpp"
#include "run_program.hpp"
#include "support/places.hpp"

namespace paracal::test::workspace_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// With the sample's box [-150, 250] x [-200, 200] x [-850, -700] mm.
class BoxWalk : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("r.toml", read_text(source_folder() / "samples/belt_robot.toml"));
    folder.make(
        {"poses --robot r.toml --optimal 30 --candidates 400 --out p.csv",
         "simulate --robot r.toml --poses p.csv --seed 3 --noise-mm 0.01 --frame robot --out m.csv --truth t.toml",
         "calibrate --robot r.toml --measurements m.csv --frame robot --out c.json"});
  }
  json json_from(const std::string& command) const { return json_of(folder.run(words(command + " --json"))); }

  TemporaryFolder folder;
};

bool is_inside(double x, double y, double z) {
  return x >= -150 && x <= 250 && y >= -200 && y <= 200 && z >= -850 && z <= -700;
}

TEST_F(BoxWalk, PlannedPosesFillTheBox) {
  const json plan = json_from("poses --robot r.toml --optimal 30 --candidates 400");
  double rightmost = -1e9, leftmost = 1e9;
  for (const json& pose : plan.at("poses")) {
    const double x = pose.at("x_cmd_mm"), y = pose.at("y_cmd_mm"), z = pose.at("z_cmd_mm");
    EXPECT_TRUE(is_inside(x, y, z)) << pose;
    rightmost = std::max(rightmost, x);
    leftmost = std::min(leftmost, x);
  }
  EXPECT_GT(rightmost, 240.0);
  EXPECT_LT(leftmost, -140.0);
}

TEST_F(BoxWalk, TheCalibrationIsSoundAndCorrectsItsCorners) {
  const json found = json::parse(folder.read("c.json"));
  EXPECT_EQ(found.at("verdict"), "accepted");
  EXPECT_EQ(found.at("robot").at("workspace").at("x_mm"), json::parse("[-150.0, 250.0]"));
  EXPECT_FALSE(found.at("robot").at("workspace").contains("radius_mm"));
  folder.write("corners.csv", "x_mm,y_mm,z_mm\n250,200,-700\n-150,-200,-850\n");
  const json ours = json_from("compensate --calibration c.json --poses corners.csv");
  const json truth = json_from("inverse --robot r.toml --errors t.toml --poses corners.csv");
  const json nominal = json_from("inverse --robot r.toml --poses corners.csv");
  const auto off = [&](const json& joints) {
    double largest = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        const double q = joints.at("joints_deg")[k][i], wanted = truth.at("joints_deg")[k][i];
        largest = std::max(largest, std::abs(q - wanted));
      }
    }
    return largest;
  };
  EXPECT_LT(off(ours), 0.02 * off(nominal));
}

TEST_F(BoxWalk, ItsPageMapsTheBox) {
  const ProgramResult made = folder.run(words("report --calibration c.json --measurements m.csv --out page.html"));
  ASSERT_EQ(made.exit_code, kDone) << made.err;
  const json map = data_in(folder.read("page.html")).at("figures").at("error_map");
  EXPECT_EQ(map.at("layers_mm"), json::parse("[-700.0, -775.0, -850.0]"));
  int corners = 0;
  for (const json& point : map.at("points")) {
    const double x = point.at("x_mm"), y = point.at("y_mm");
    EXPECT_TRUE(is_inside(x, y, point.at("z_mm"))) << point;
    corners += (x == -150 || x == 250) && (y == -200 || y == 200) ? 1 : 0;
  }
  EXPECT_EQ(corners, 12);
}

TEST_F(BoxWalk, TargetsOutsideOfTheBoxAreCounted) {
  folder.write("part.ngc", "G21 G90 G94\nG1 X240 Y0 Z-800 F1000\nG1 X-160 Y0 Z-800\nM2\n");
  const json summary = json_from("export --calibration c.json --target gcode --input part.ngc --out corrected.ngc");
  EXPECT_EQ(summary.at("outside_workspace").at("first_line"), 3) << summary.at("outside_workspace");
}

TEST_F(BoxWalk, LinuxcncGetsItsLimits) {
  const ProgramResult made = folder.run(words("export --calibration c.json --target linuxcnc --config linuxcnc"));
  ASSERT_EQ(made.exit_code, kDone) << made.err;
  const std::string ini = folder.read("linuxcnc/paracal.ini"), motions = folder.read("linuxcnc/first_motions.ngc");
  EXPECT_THAT(ini, HasSubstr("MIN_LIMIT = -150"));
  EXPECT_THAT(ini, HasSubstr("MAX_LIMIT = 250"));
  EXPECT_THAT(motions, HasSubstr("G0 X50 Y0 Z-775\nG1 X100 F20000\nG2 I-50\n"));
}

}  // namespace
}  // namespace paracal::test::workspace_test
