// What is exported for LinuxCNC: its component, built by halcompile and run by HAL, and its configuration, with which
// the whole of LinuxCNC is started.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <regex>
#include <sstream>

#include "linuxcnc_export.hpp"
#include "support/places.hpp"

namespace paracal::test::linuxcnc_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Calls whatever kinematics are loaded as the motion controller does: inverse, and forward of its answer from zero.
const std::string kProbe = R"(component paracal_probe "calls kinematics";
pin in float world.x;
pin in float world.y;
pin in float world.z;
pin in float world.c;
pin out float joint.#[4];
pin out float away "largest difference of forward(inverse(world)) and world, mm or deg";
pin out signed result;
option singleton yes;
option period no;
function call;
license "GPL";
;;
#include "rtapi_math.h"
#include "kinematics.h"

static double larger(double a, double b) { return a > b ? a : b; }

FUNCTION(call) {
  EmcPose wanted = {{world_x, world_y, world_z}, 0, 0, world_c, 0, 0, 0}, found = {{0, 0, 0}, 0, 0, 0, 0, 0, 0};
  double joints[16] = {0};
  unsigned long flags = 0;
  int i;
  result = kinematicsInverse(&wanted, joints, &flags, &flags);
  if (result == 0) result = kinematicsForward(joints, &found, &flags, &flags);
  for (i = 0; i < 4; ++i) joint(i) = joints[i];
  away = larger(larger(fabs(found.tran.x - wanted.tran.x), fabs(found.tran.y - wanted.tran.y)),
                larger(fabs(found.tran.z - wanted.tran.z), fabs(found.c - wanted.c)));
}
)";

/// Streams poses and the joints of the library through HAL, one line a period, and samples 1e9 times the differences.
/// Sampled numbers have six decimals, so differences are formed within HAL.
std::string hal_of_trial(std::size_t poses) {
  std::string hal = R"(loadrt paracal_trial
loadrt paracal_probe
loadrt threads name1=fast period1=100000
loadrt streamer depth=10001 cfg=ffffffff
loadrt sampler depth=10001 cfg=fffffffffss
loadrt sum2 count=8
loadrt mult2 count=1
addf streamer.0 fast
addf paracal-trial.compensate fast
addf paracal-probe.call fast
)";
  for (std::size_t k = 0; k < 4; ++k) {
    hal += fmt::format("net {1} streamer.0.pin.{0} paracal-trial.command.{1} paracal-probe.world.{1}\n", k, "xyzc"[k]);
    hal += fmt::format("net expected{0} streamer.0.pin.{1} sum2.{0}.in1 sum2.{1}.in1\n", k, 4 + k);
    hal += fmt::format("net pin{0} paracal-trial.joint.{0} sum2.{0}.in0\n", k);
    hal += fmt::format("net called{0} paracal-probe.joint.{0} sum2.{1}.in0\n", k, 4 + k);
  }
  for (std::size_t k = 0; k < 8; ++k) {
    hal += fmt::format("addf sum2.{0} fast\nsetp sum2.{0}.gain0 1e9\nsetp sum2.{0}.gain1 -1e9\n", k);
    hal += fmt::format("net difference{0} sum2.{0}.out sampler.0.pin.{0}\n", k);
  }
  return hal + R"(addf mult2.0 fast
setp mult2.0.in1 1e9
net away paracal-probe.away mult2.0.in0
net scaled mult2.0.out sampler.0.pin.8
net status paracal-trial.status sampler.0.pin.9
net result paracal-probe.result sampler.0.pin.10
addf sampler.0 fast
loadusr -w halstreamer stream.txt
start
loadusr -w halsampler -n )" +
         std::to_string(poses) + R"( samples.txt
stop
)";
}

TEST_F(LinuxcncExport, GivesTheLibrarysJointsAndFindsTheWayBack) {
  export_to("linuxcnc", "paracal_kins.comp");
  write_trial(folder.read("paracal_kins.comp"));
  folder.write("paracal_probe.comp", kProbe);
  for (const char* component : {"paracal_trial", "paracal_probe"}) {
    ASSERT_EQ(install(component), 0) << folder.read("halcompile.log");
  }
  const std::vector<PoseNumbers> poses = random_poses(every_machine() ? 10'000 : 2000);
  const json joints = library_joints(poses);
  std::ostringstream stream;
  stream.precision(17);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (const double number : poses[k]) stream << number << ' ';
    for (const json& joint : joints[k]) stream << joint.get<double>() << ' ';
    stream << '\n';
  }
  folder.write("stream.txt", stream.str());
  folder.write("trial.hal", hal_of_trial(poses.size()));
  ASSERT_EQ(halrun(), 0) << folder.read("halrun.log");

  std::istringstream samples(folder.read("samples.txt"));
  std::size_t count = 0;
  double worst_joint = 0.0, worst_return = 0.0;  // 1e-9 deg; 1e-9 mm or deg
  for (std::string line; std::getline(samples, line); ++count) {
    std::istringstream fields(line);
    double value = 0.0;
    for (int k = 0; k < 8 && fields >> value; ++k) worst_joint = std::max(worst_joint, std::abs(value));
    fields >> value;
    worst_return = std::max(worst_return, value);
    int status = -1, result = -1;
    fields >> status >> result;
    ASSERT_TRUE(fields && status == 0 && result == 0) << line;
  }
  EXPECT_EQ(count, poses.size());
  RecordProperty("worst_joint_deg", json(worst_joint * 1e-9).dump());
  RecordProperty("worst_return_mm_or_deg", json(worst_return * 1e-9).dump());
  EXPECT_LT(worst_joint, 1.0);
  EXPECT_LT(worst_return, 1000.0);
}

/// The component is what a machine runs, so it must not load with constants that were damaged on the way.
TEST_F(LinuxcncExport, ADamagedConstantIsRefusedWhileLoading) {
  export_to("linuxcnc", "paracal_kins.comp");
  std::string text = folder.read("paracal_kins.comp");
  const std::size_t arm = text.find("375.15");  // arm of limb 3
  ASSERT_NE(arm, std::string::npos);
  text.replace(arm, 6, "375.16");
  write_trial(text);
  ASSERT_EQ(install("paracal_trial"), 0);
  folder.write("trial.hal", "loadrt paracal_trial\n");
  EXPECT_NE(halrun(), 0);
  EXPECT_THAT(folder.read("halrun.log"), HasSubstr("of the self-test failed"));
}

// ---- The whole of LinuxCNC: task, interpreter, motion, HAL; linuxcnc_trial.py in place of a screen

class LinuxcncMachine : public LinuxcncExport, public testing::WithParamInterface<const char*> {
 protected:
  /// Its joints are those of huang2016, its world that of linear_delta.
  static bool is_left_out() { return std::string(GetParam()) == "rotary_delta" && !every_machine(); }

  void SetUp() override {
    LinuxcncExport::SetUp();
    if (IsSkipped() || is_left_out()) return;
    calibrate(GetParam());
    const json robot = json_from(fmt::format("robot --robot {}", GetParam()));
    const json& workspace = robot.at("workspace");
    radius = workspace.at("radius_mm");
    height = workspace.at("height_mm");
    floor = workspace.at("top_z_mm").get<double>() - height;
    turns = robot.contains("plate");
    ASSERT_EQ(folder.run(fmt::format("{} --robot {}", kConfigure, GetParam())).exit_code, kDone);
    write_trial(folder.read("machine/paracal_kins.comp"));
    ASSERT_EQ(install("paracal_trial"), 0) << folder.read("halcompile.log");
  }

  void write_program(const std::string& name, const std::string& blocks) const {
    folder.write("machine/" + name, fmt::format("G21 G90 G17 G94 F20000\nG54 G49 {}\nM2\n", blocks));
  }

  /// Where the joints of the library are for these poses, against where LinuxCNC had them.
  void expect_joints(const json& found, const std::vector<PoseNumbers>& poses) const {
    const json expected = library_joints(poses, GetParam());
    ASSERT_EQ(found.size(), poses.size());
    double worst = 0.0;
    for (std::size_t k = 0; k < poses.size(); ++k) {
      ASSERT_EQ(found[k].size(), expected[k].size());
      for (std::size_t i = 0; i < expected[k].size(); ++i) {
        worst = std::max(worst, std::abs(found[k][i].get<double>() - expected[k][i].get<double>()));
      }
    }
    EXPECT_LT(worst, 1e-9);  // deg, mm
  }

  PoseNumbers home() const { return {0.0, 0.0, floor + 0.5 * height, 0.0}; }
  /// A place about home, in quarters of the workspace's radius, mm and deg.
  PoseNumbers about_home(double x, double y, double z, double phi) const {
    return {0.25 * radius * x, 0.25 * radius * y, home()[2] + z, turns ? phi : 0.0};
  }
  /// Words of a place, with C where there is one.
  std::string words_of(const PoseNumbers& pose) const {
    const auto& [x, y, z, phi] = pose;
    return fmt::format("X{} Y{} Z{}{}", x, y, z, turns ? fmt::format(" C{}", phi) : "");
  }

  /// To two places, along an arc, and with the tip of a tool to a place above the table.
  void write_motions() const {
    write_program("motions.ngc", fmt::format("G0 {}\nM0\nG1 {}\nM0\nG3 X0 Y{} I{} J0\nM0\nT2 M6 G43\nG55 G1 {}",
                                             words_of(about_home(2, 1, 20, 30)), words_of(about_home(-1, -1, -15, -30)),
                                             -0.5 * radius, 0.25 * radius, words_of({10, 20, 30, 0})));
  }
  /// From homing to the end of programs the joints are the library's.
  void expect_motions(const json& seen) const {
    const PoseNumbers jogged = seen.at("jogged").at("place");
    EXPECT_NEAR(jogged[0], 10.0, 1e-4);
    json joints{seen.at("homed"), seen.at("jogged").at("joints")};
    for (const char* program : {"motions.ngc", "first_motions.ngc"}) {
      EXPECT_THAT(seen.at(program).at("messages"), testing::IsEmpty()) << program;
      for (const json& rest : seen.at(program).at("rests")) joints.push_back(rest);
    }
    expect_joints(joints, {home(),
                           jogged,
                           about_home(2, 1, 20, 30),
                           about_home(-1, -1, -15, -30),
                           about_home(0, -2, -15, -30),
                           {10, 20, floor + 30 + 50, 0},
                           about_home(0, 0, 0.25 * height, 0)});
  }

  /// Home, and from there to what cannot be taken.
  void write_refused(const std::string& name, const std::string& blocks) const {
    write_program(name, fmt::format("G0 {}\nM0\n{}\nG0 X1 Y1", words_of(home()), blocks));
  }
  /// Nothing moved towards it, nor to what stands behind it.
  void expect_refused(const json& program, const std::string& message) const {
    EXPECT_THAT(program.at("messages"), testing::Contains(testing::ContainsRegex(message)));
    expect_joints(program.at("rests"), {home(), home()});
  }
  /// It left where it paused for the second time, and came to rest on its way; NaN would be no JSON.
  static void expect_stopped(const json& program) {
    EXPECT_THAT(program.at("messages"),
                testing::Contains(testing::ContainsRegex("^Exceeded [A-Z]+ soft limit .* joint")));
    ASSERT_EQ(program.at("rests").size(), 3u);
    EXPECT_NE(program.at("rests")[2], program.at("rests")[1]);
    for (const json& joint : program.at("rests")[2]) EXPECT_TRUE(joint.is_number_float()) << joint;
  }

  double radius = 0.0, height = 0.0, floor = 0.0;
  bool turns = false;
};

INSTANTIATE_TEST_SUITE_P(Catalogue, LinuxcncMachine, testing::Values("huang2016", "rotary_delta", "linear_delta"),
                         [](const auto& one) { return std::string(one.param); });

TEST_P(LinuxcncMachine, MovesAsTheLibrarySaysAndRefusesTheRest) {
  if (is_left_out()) return;
  write_motions();
  write_refused("box.ngc", fmt::format("G1 X{}", radius + 1.0));
  write_refused("corner.ngc", fmt::format("G1 X{0} Y{0} Z{1}", radius, floor));
  write_refused("on_the_way.ngc", fmt::format("G0 X{0} Z{1}\nM0\nG2 X{0} I{2}", 0.9 * radius, floor, radius));
  const json seen = seen_while_running("motions.ngc first_motions.ngc box.ngc corner.ngc on_the_way.ngc");
  expect_motions(seen);
  expect_refused(seen.at("box.ngc"), "^Linear move on line 4 would exceed X's positive limit$");
  expect_refused(seen.at("corner.ngc"), "^Linear move on line 4 (fails kinematicsInverse|would exceed joint)");
  expect_stopped(seen.at("on_the_way.ngc"));
}

class LinuxcncEncoders : public LinuxcncMachine {};

INSTANTIATE_TEST_SUITE_P(Catalogue, LinuxcncEncoders, testing::Values("huang2016"),
                         [](const auto& one) { return std::string(one.param); });

/// Changed as README.md says for absolute encoders, the machine is where these show it, however often it is homed.
TEST_P(LinuxcncEncoders, SayWhereTheMachineStands) {
  const PoseNumbers place = about_home(1, 2, 30, 40);
  const json shown = library_joints({place}, GetParam()).at(0);
  std::string hal = std::regex_replace(folder.read("machine/paracal.hal"), std::regex("net joint-(.) .*"),
                                       "net joint-$1 joint.$1.motor-pos-fb");
  for (std::size_t i = 0; i < shown.size(); ++i) hal += fmt::format("sets joint-{} {}\n", i, shown[i].get<double>());
  folder.write("machine/paracal.hal", hal);
  folder.write("machine/paracal.ini",
               std::regex_replace(folder.read("machine/paracal.ini"), std::regex("HOME_OFFSET = .*"),
                                  "HOME_ABSOLUTE_ENCODER = 2\nHOME_OFFSET = 0"));
  const json seen = seen_while_running("");
  expect_joints({seen.at("homed"), seen.at("homed_again")}, {place, place});
  for (const char* said : {"`HOME_ABSOLUTE_ENCODER = 2`", "`HOME_OFFSET = 0`"}) {
    EXPECT_THAT(folder.read("machine/README.md"), HasSubstr(said));
  }
}

}  // namespace
}  // namespace paracal::test::linuxcnc_test
