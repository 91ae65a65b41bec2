// Exports of robots that are a file alone, each with the real thing: compilers, cppcheck, and HAL with the kinematics
// that LinuxCNC brings and with ours.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "linuxcnc_export.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::test::robot_templates_export_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double kDegrees = 180.0 / std::numbers::pi;

using TiltedPose = std::array<double, 6>;  ///< mm, deg

/// Anywhere in the robot's workspace.
std::vector<TiltedPose> tilted_poses(const Robot& robot, std::size_t count) {
  Random random(6);
  std::vector<TiltedPose> poses(count);
  for (TiltedPose& one : poses) {
    const Pose pose = random.pose(robot);
    const Eigen::Vector3d &at = pose.position, tilt = kDegrees * pose.tilt;
    one = {at.x(), at.y(), at.z(), tilt.x(), tilt.y(), tilt.z()};
  }
  return poses;
}

std::string line(const TiltedPose& pose, const char* separator) {
  std::ostringstream text;
  text.precision(17);
  for (std::size_t k = 0; k < pose.size(); ++k) text << (k == 0 ? "" : separator) << pose.at(k);
  return text.str();
}

/// A calibration of a template with errors of every kind, one a limb in turn.
void calibrate_template(const TemporaryFolder& folder, const Robot& robot) {
  ASSERT_EQ(folder.run(words(fmt::format("robot --template {} --out r.toml", robot.name()))).exit_code, kDone);
  json calibration{{"format", "paracal calibration 1"}, {"accepted", true}};
  std::size_t limb = 0;
  for (const Source source : sources_of(robot.actuator())) {
    calibration["parameters"].push_back({{"name", name(source)},
                                         {"limb", limb++ % robot.limb_count() + 1},
                                         {"value", limb % 2 == 0 ? 0.3 : -0.4},
                                         {"unit", file_unit(unit(source, robot.actuator()))}});
  }
  calibration["robot"] = json::parse(folder.run(words("robot --robot r.toml --json")).out);
  folder.write("c.json", calibration.dump());
}

void export_template(const TemporaryFolder& folder, const std::string& target, const std::string& file) {
  const ProgramResult result =
      folder.run(words(fmt::format("export --calibration c.json --target {} --out {}", target, file)));
  ASSERT_EQ(result.exit_code, kDone) << result.err;
}

/// The library's joints, mm or deg.
json joints_of(const TemporaryFolder& folder, const Robot& robot, const std::vector<TiltedPose>& poses) {
  std::string text = "x_mm,y_mm,z_mm,tilt_x_deg,tilt_y_deg,tilt_z_deg\n";
  for (const TiltedPose& pose : poses) text += line(pose, ",") + "\n";
  folder.write("tilted.csv", text);
  const json found = json_of(folder.run(words("compensate --calibration c.json --poses tilted.csv --json")));
  return found.at(fmt::format("joints_{}", file_unit(joint_unit(robot.actuator()))));
}

// ---- C99

/// Reads poses (mm, rad), prints joints (mm, rad) and how far forward from the first pose is from each.
const std::string kProgram = R"(#include <stdio.h>
#include "compensator.h"
int main(void) {
  double pose[6], joints[PARACAL_LIMBS], found[6];
  const double never = 0.0;
  int k;
  for (k = 0; k < PARACAL_LIMBS; ++k) joints[k] = 7.0;
  if (paracal_self_test() != 0) return 10;
  for (k = 0; k < 6; ++k) pose[k] = found[k] = paracal_tests[0].pose[k];
  joints[1] = never / never;  /* a limb that does not reach, before others that do */
  if (paracal_apart(joints, found) == paracal_apart(joints, found)) return 17;
  joints[1] = 7.0;
  pose[3] = never / never;
  if (paracal_compensate(pose, joints, 0) != PARACAL_NOT_FINITE || joints[0] != 7.0) return 11;
  if (paracal_forward(joints, pose) != PARACAL_NOT_FINITE) return 12;
  pose[3] = 0.0;
  pose[2] += 5000.0;
  if (paracal_compensate(pose, joints, 0) == PARACAL_UNREACHABLE) {
    if (joints[0] != 7.0) return 16;
  } else {  /* struts, which reach anything; but not so unlike each other */
    for (k = 0; k < PARACAL_LIMBS; ++k) joints[k] = k == 0 ? 5000.0 : -400.0;
    if (paracal_forward(joints, found) == PARACAL_OK || found[0] != paracal_tests[0].pose[0]) return 13;
  }
  while (scanf("%lf %lf %lf %lf %lf %lf", &pose[0], &pose[1], &pose[2], &pose[3], &pose[4], &pose[5]) == 6) {
    double away = 0.0;
    if (paracal_compensate(pose, joints, 0) != PARACAL_OK) return 14;
    for (k = 0; k < 6; ++k) found[k] = paracal_tests[0].pose[k];
    if (paracal_forward(joints, found) != PARACAL_OK) return 15;
    for (k = 0; k < 6; ++k) away = paracal_abs(found[k] - pose[k]) > away ? paracal_abs(found[k] - pose[k]) : away;
    for (k = 0; k < PARACAL_LIMBS; ++k) printf("%.17g ", joints[k]);
    printf("%.17g\n", away);
  }
  return 0;
}
)";

using TemplateAndCompiler = std::tuple<std::string_view, const char*>;

class TemplateC99 : public Export, public testing::WithParamInterface<TemplateAndCompiler> {
 protected:
  void SetUp() override {
    Export::SetUp();
    if (*compiler == '\0') GTEST_SKIP() << "this compiler is not installed";
    calibrate_template(folder, robot);
    export_template(folder, "c99", "compensator.h");
  }

  Robot robot = robot_named(std::get<0>(GetParam()));
  const char* compiler = std::get<1>(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Compilers, TemplateC99,
                         testing::Combine(testing::ValuesIn(template_names()),
                                          testing::Values(PARACAL_GCC, PARACAL_CLANG)),
                         [](const auto& one) {
                           std::string name(std::get<0>(one.param));
                           std::ranges::replace(name, '-', '_');
                           return name + (one.index % 2 == 0 ? "_gcc" : "_clang");
                         });

TEST_P(TemplateC99, GivesTheLibrarysJointsAndTheWayBack) {
  folder.write("program.c", kProgram);
  for (const char* language : {"-std=c99", "-x c++ -std=c++98", "-x c++ -std=c++20"}) {
    ASSERT_EQ(shell(fmt::format("{} {} -O2 -pedantic -Wall -Wextra -Wconversion -Werror program.c -lm -o program",
                                compiler, language)),
              0)
        << language;
  }
  std::vector<TiltedPose> poses = tilted_poses(robot, every_machine() ? 10'000 : 1000);
  const json expected = joints_of(folder, robot, poses);
  const double shown = to_file_unit(joint_unit(robot.actuator()), 1.0);
  std::string text;
  for (TiltedPose pose : poses) {
    for (std::size_t k = 3; k < 6; ++k) pose.at(k) /= kDegrees;
    text += line(pose, " ") + "\n";
  }
  folder.write("poses.txt", text);
  ASSERT_EQ(shell("./program < poses.txt > joints.txt"), 0);
  std::istringstream found(folder.read("joints.txt"));
  double worst = 0.0, worst_return = 0.0, number = 0.0;
  for (const json& row : expected) {
    for (const json& joint : row) {
      found >> number;
      worst = std::max(worst, std::abs(shown * number - joint.get<double>()));
    }
    found >> number;
    worst_return = std::max(worst_return, number);
  }
  ASSERT_TRUE(found);
  RecordProperty("worst", json(worst).dump());
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT(worst_return, 1e-9);
}

class TemplateMisra : public Export, public testing::WithParamInterface<std::string_view> {};
PARACAL_ON_ROBOT_TEMPLATES(TemplateMisra);

TEST_P(TemplateMisra, IsKeptTo) {
  if (*PARACAL_CPPCHECK == '\0') GTEST_SKIP() << "cppcheck is not installed";
  calibrate_template(folder, robot_named(GetParam()));
  export_template(folder, "c99", "compensator.h");
  folder.write("kernel.c",
               "#include \"compensator.h\"\nint self_test(void);\n"
               "int self_test(void) { return paracal_self_test(); }\n");
  const std::string check = std::string(PARACAL_CPPCHECK) +
                            " --addon=misra --enable=style,warning,performance,portability --std=c99 --quiet "
                            "--error-exitcode=1 --suppress=misra-c2012-2.5 --suppress=misra-c2012-15.5 "
                            "--suppress=misra-c2012-21.2 kernel.c 2> said.txt";
  EXPECT_EQ(shell(check), 0);
  EXPECT_EQ(folder.read("said.txt"), "");
}

// ---- HAL

/// Calls whatever kinematics are loaded as the motion controller does: inverse, and forward of its answer from nearby.
const std::string kProbe = R"(component paracal_probe "calls kinematics";
pin in float world.x;
pin in float world.y;
pin in float world.z;
pin in float world.a;
pin in float world.b;
pin in float world.c;
pin out float joint.#[6];
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
  EmcPose wanted = {{world_x, world_y, world_z}, world_a, world_b, world_c, 0, 0, 0}, found = wanted;
  double joints[16] = {0};
  unsigned long flags = 0;
  int i;
  found.tran.x += 2.0;
  found.tran.z -= 1.0;
  found.a += 0.5;
  found.c -= 0.5;
  result = kinematicsInverse(&wanted, joints, &flags, &flags);
  if (result == 0) result = kinematicsForward(joints, &found, &flags, &flags);
  for (i = 0; i < 6; ++i) joint(i) = joints[i];
  away = larger(larger(fabs(found.tran.x - wanted.tran.x), fabs(found.tran.y - wanted.tran.y)),
                fabs(found.tran.z - wanted.tran.z));
  away = larger(larger(away, fabs(found.a - wanted.a)), larger(fabs(found.b - wanted.b), fabs(found.c - wanted.c)));
}
)";

/// Streams poses and the joints of the library, and samples 1e9 times what they differ by from pins named by
/// `joint_pin`, so many, and how far the way back is off. `lines` stand behind the kinematics and their caller.
std::string hal_of(const std::string& kinematics, const std::string& lines, const std::string& joint_pin,
                   std::size_t joints = 6) {
  std::string hal = "loadrt " + kinematics + R"(
loadrt threads name1=servo-thread period1=200000
loadrt streamer depth=2001 cfg=ffffffffffff
loadrt sampler depth=2001 cfg=fffffffs
loadrt paracal_probe
loadrt sum2 count=6
loadrt mult2 count=1
addf streamer.0 servo-thread
addf paracal-probe.call servo-thread
)" + lines;
  for (std::size_t k = 0; k < 6; ++k) {
    hal += fmt::format("net {1} streamer.0.pin.{0} paracal-probe.world.{1}\n", k, "xyzabc"[k]);
    if (k >= joints) continue;
    hal += fmt::format("net expected{0} streamer.0.pin.{1} sum2.{0}.in1\n", k, 6 + k);
    hal += fmt::format("net found{0} {1} sum2.{0}.in0\n", k, fmt::format(fmt::runtime(joint_pin), k));
    hal += fmt::format("addf sum2.{0} servo-thread\nsetp sum2.{0}.gain0 1e9\nsetp sum2.{0}.gain1 -1e9\n", k);
    hal += fmt::format("net difference{0} sum2.{0}.out sampler.0.pin.{0}\n", k);
  }
  return hal + R"(addf mult2.0 servo-thread
setp mult2.0.in1 1e9
net away paracal-probe.away mult2.0.in0
net scaled mult2.0.out sampler.0.pin.6
net result paracal-probe.result sampler.0.pin.7
addf sampler.0 servo-thread
loadusr -w halstreamer stream.txt
start
loadusr -w halsampler -n 2000 samples.txt
stop
)";
}

/// The angles of R = Rot(z, C) Rot(y, B) Rot(x, A) that turn a plate as its tilts do.
TiltedPose roll_pitch_yaw(TiltedPose pose) {
  const double a = pose[3] / kDegrees, b = pose[4] / kDegrees, g = pose[5] / kDegrees;
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b), cg = std::cos(g),
               sg = std::sin(g);
  const double x0 = cb * cg, x1 = ca * sg + sa * sb * cg, x2 = sa * sg - ca * sb * cg;
  const double y2 = sa * cg + ca * sb * sg, z2 = ca * cb;
  pose[3] = std::atan2(y2, z2) * kDegrees;
  pose[4] = std::atan2(-x2, std::hypot(x0, x1)) * kDegrees;
  pose[5] = std::atan2(x1, x0) * kDegrees;
  return pose;
}

class SixFreedomsHal : public LinuxcncExport {
 protected:
  void calibrate(std::string_view kind) {
    robot = robot_named(kind);
    calibrate_template(folder, robot);
    folder.write("paracal_probe.comp", kProbe);
    ASSERT_EQ(install("paracal_probe"), 0) << folder.read("halcompile.log");
  }

  /// Joints may differ by `joint`, and the way back by `way_back`, in 1e-9 mm or deg; that of so many first poses is
  /// not asked for.
  void run_hal(const std::string& hal, TiltedPose angles_of(TiltedPose), double joint, double way_back,
               std::size_t first = 0) {
    const std::vector<TiltedPose> poses = tilted_poses(robot, 2000);
    const json joints = joints_of(folder, robot, poses);
    std::ostringstream stream;
    stream.precision(17);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      TiltedPose pose = poses[k];
      std::vector<double> expected = joints[k];
      for (std::size_t axis = 0; axis < pose.size(); ++axis) {
        if (robot.freedoms().free[axis]) continue;
        pose[axis] = static_cast<double>(k % 100) + 0.25 * static_cast<double>(axis);  // as a pen goes up and down
        expected.push_back(pose[axis]);
      }
      stream << line(angles_of(pose), " ");
      for (const double one : expected) stream << ' ' << one;
      stream << '\n';
    }
    folder.write("stream.txt", stream.str());
    folder.write("trial.hal", hal);
    ASSERT_EQ(halrun(), 0) << folder.read("halrun.log");
    std::istringstream samples(folder.read("samples.txt"));
    std::size_t count = 0;
    for (std::string sample; std::getline(samples, sample); ++count) {
      std::istringstream fields(sample);
      double value = 0.0;
      for (int k = 0; k < 6 && fields >> value; ++k) EXPECT_LT(std::abs(value), joint) << sample;
      fields >> value;
      int result = -1;
      fields >> result;
      ASSERT_TRUE(fields) << sample;
      if (count < first) continue;
      EXPECT_LT(value, way_back) << sample;
      ASSERT_EQ(result, 0) << sample;
    }
    EXPECT_EQ(count, poses.size());
  }

  Robot robot = robot_named(template_names().front());
};

class TemplateHal : public SixFreedomsHal, public testing::WithParamInterface<std::string_view> {};
PARACAL_ON_ROBOT_TEMPLATES(TemplateHal);

TEST_P(TemplateHal, OurComponentGivesTheLibrarysJoints) {
  calibrate(GetParam());
  export_template(folder, "linuxcnc", "paracal_kins.comp");
  write_trial(folder.read("paracal_kins.comp"));
  ASSERT_EQ(install("paracal_trial"), 0) << folder.read("halcompile.log");
  const auto same = [](TiltedPose pose) { return pose; };
  run_hal(hal_of("paracal_trial", "", "paracal-probe.joint.{}"), same, 1.0, 100.0);
  // And on its own pins, without the controller.
  std::string commands;
  for (std::size_t k = 0; k < 6; ++k) {
    if (robot.freedoms().free[k]) commands += fmt::format("net {0} paracal-trial.command.{0}\n", "xyzabc"[k]);
  }
  run_hal(replaced(hal_of("paracal_trial", "addf paracal-trial.compensate servo-thread\n", "paracal-trial.joint.{}",
                          robot.limb_count()),
                   "addf sampler.0", commands + "addf sampler.0"),
          same, 1.0, 100.0);
}

/// LinuxCNC's own kinematics with our lines: lengths of struts, and through the drives' scales the joints that our
/// inverse gives.
TEST_F(SixFreedomsHal, GenhexkinsWithOurLinesGivesTheLibrarysJoints) {
  calibrate("hexapod");
  export_template(folder, "genhexkins", "hexapod.hal");
  std::string drives = "source hexapod.hal\n";
  for (int k = 0; k < 6; ++k) drives += fmt::format("net length{0} paracal-probe.joint.{0} strut.{0}.in\n", k);
  run_hal(hal_of("genhexkins", drives, "strut.{}.out"), roll_pitch_yaw, 1.0, 1000.0,
          1);  // it starts from the last pose that it had
  // What a drive has done, as the controller takes it: gain of limb 5, zero of limb 1.
  const std::string said = folder.read("hexapod.hal");
  EXPECT_THAT(said, HasSubstr("setp strut-back.4.gain 0.9996\n"));
  EXPECT_THAT(said, HasSubstr("setp strut-back.0.offset 499.6\n"));
  EXPECT_THAT(said, HasSubstr("#   [JOINT_4] LENGTH 500 GROWTH 0.9996\n"));
}

TEST_F(Export, GenhexkinsIsOfStruts) {
  const ProgramResult refused = folder.run("export --calibration calibration.json --target genhexkins");
  EXPECT_NE(refused.exit_code, kDone);
  EXPECT_THAT(refused.err, HasSubstr("expected a plate on six struts, got huang2016"));
}

}  // namespace
}  // namespace paracal::test::robot_templates_export_test
