// Exports, each with the real thing: the C99 header built by compilers, the component of LinuxCNC built by halcompile
// and run by HAL.

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "broken_input.hpp"
#include "calibrated_machine.hpp"

namespace paracal::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Export : public CalibratedMachine {
 protected:
  /// Exit status of a command of the shell in the folder.
  int shell(const std::string& command) const {
    return std::system(fmt::format("cd '{}' && {}", folder.path().string(), command).c_str());  // NOLINT(*-env33-c)
  }

  void export_to(const std::string& target, const std::string& file) const {
    ASSERT_EQ(
        folder.run(fmt::format("export --calibration calibration.json --target {} --out {}", target, file)).exit_code,
        kDone);
  }

  json library_joints(const std::vector<PoseNumbers>& poses) const {
    folder.write("poses.csv", lines(poses, ",").insert(0, "x_mm,y_mm,z_mm,phi_deg\n"));
    return json_from(kCompensate).at("joints_deg");
  }
};

// ---- C99

/// The C program around the header: reads poses (mm, rad) and prints joints in deg.
const std::string kKernel = R"(#include "compensator.h"
int self_test(void) { return paracal_self_test(); }
int joints_of(const double pose[4], double joints[4]) {
  return paracal_compensate(pose[0], pose[1], pose[2], pose[3], joints, 0);
}
)";

const std::string kMain = R"(#include <math.h>
#include <stdio.h>
int self_test(void);
int joints_of(const double pose[4], double joints[4]);
int main(void) {
  double p[4], q[4] = {7.0, 7.0, 7.0, 7.0};
  const double degrees = 180.0 / 3.14159265358979323846;
  if (self_test() != 0) return 10;
  p[0] = p[1] = p[3] = 0.0;
  p[2] = -5000.0;
  if (joints_of(p, q) != 1 || q[0] != 7.0) return 11;
  p[2] = NAN;
  if (joints_of(p, q) != 2 || q[0] != 7.0) return 12;
  while (scanf("%lf %lf %lf %lf", &p[0], &p[1], &p[2], &p[3]) == 4) {
    p[3] /= degrees;
    if (joints_of(p, q) != 0) return 13;
    printf("%.17g %.17g %.17g %.17g\n", q[0] * degrees, q[1] * degrees, q[2] * degrees, q[3] * degrees);
  }
  return 0;
}
)";

class C99Export : public Export, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    Export::SetUp();
    if (*GetParam() == '\0') GTEST_SKIP() << "this compiler is not installed";
    export_to("c99", "compensator.h");
    folder.write("kernel.c", kKernel);
    folder.write("main.c", kMain);
  }
};

INSTANTIATE_TEST_SUITE_P(Compilers, C99Export, testing::Values(PARACAL_GCC, PARACAL_CLANG),
                         [](const auto& one) { return one.index == 0 ? "gcc" : "clang"; });

TEST_P(C99Export, GivesTheLibrarysJoints) {
  const std::string compile = std::string(GetParam()) + " -std=c99 -O2 -pedantic -Wall -Wextra -Werror ";
  ASSERT_EQ(shell(compile + "-ffreestanding -Wshadow -Wconversion -c kernel.c"), 0);
  ASSERT_EQ(shell(compile + "main.c kernel.o -lm -o program"), 0);
  const std::vector<PoseNumbers> poses = random_poses(10'000);
  folder.write("poses.txt", lines(poses, " "));
  ASSERT_EQ(shell("./program < poses.txt > joints.txt"), 0);
  const json expected = library_joints(poses);
  const std::string text = folder.read("joints.txt");
  const char* at = text.c_str();
  double worst = 0.0;
  for (const json& row : expected) {
    for (const json& joint : row) {
      char* end = nullptr;
      worst = std::max(worst, std::abs(std::strtod(at, &end) - joint.get<double>()));
      ASSERT_NE(at, end);
      at = end;
    }
  }
  RecordProperty("worst_deg", json(worst).dump());
  EXPECT_LT(worst, 1e-9);
}

/// In two files of one C++ program, the oldest standard that compilers know and the newest, before and after the
/// library's own declarations.
TEST_P(C99Export, LinksFromCpp) {
  folder.write("first.cpp",
               "#include \"compensator.h\"\n#include <cmath>\n"
               "int other(const double pose[4], double joints[4]);\n"
               "int main() {\n  const double pose[4] = {0.0, 0.0, -900.0, std::sqrt(0.04)};\n"
               "  double a[4] = {0.0}, b[4] = {1.0};\n"
               "  if (paracal_compensate(pose[0], pose[1], pose[2], pose[3], a, NULL) != PARACAL_OK) return 1;\n"
               "  return other(pose, b) != 0 || a[3] < b[3] || a[3] > b[3] || paracal_self_test() != 0;\n}\n");
  folder.write("second.cpp",
               "#include <cmath>\n#include \"compensator.h\"\n"
               "int other(const double pose[4], double joints[4]);\n"
               "int other(const double pose[4], double joints[4]) {\n"
               "  return paracal_compensate(pose[0], pose[1], pose[2], pose[3], joints, NULL);\n}\n");
  for (const char* standard : {"c++98", "c++20"}) {
    const std::string compile = fmt::format(
        "{} -x c++ -std={} -pedantic -Wall -Wextra -Wshadow -Wconversion -Wold-style-cast -Werror first.cpp second.cpp "
        "-lstdc++ -lm -o program",
        GetParam(), standard);
    ASSERT_EQ(shell(compile), 0) << standard;
    EXPECT_EQ(shell("./program"), 0);
  }
}

/// Three limbs, and errors of the position group alone: the header's other half.
TEST_P(C99Export, OfALevelRigidPlatePassesItsSelfTest) {
  // As text: a calibration's robot keeps the order of its keys.
  const std::string robot = folder.run("robot --robot rotary_delta --json").out;
  folder.write("delta.json", R"({"accepted": true, "parameters": [
    {"name": "e_z", "limb": 3, "value": 0.4, "unit": "mm"}], "robot": )" +
                                 robot + "}");
  const std::string command = "export --robot rotary_delta --calibration delta.json --target c99 --out compensator.h";
  ASSERT_EQ(folder.run(command).exit_code, kDone);
  folder.write("test.c", "#include \"compensator.h\"\nint main(void) { return paracal_self_test(); }\n");
  const std::string compile = std::string(GetParam()) + " -std=c99 -pedantic -Wall -Wextra -Wconversion -Werror ";
  ASSERT_EQ(shell(compile + "test.c -lm -o test"), 0);
  EXPECT_EQ(shell("./test"), 0);
}

/// Carriages on rails, with and without tilt.
TEST_P(C99Export, OfARobotOnRailsPassesItsSelfTest) {
  const std::string robot = folder.run("robot --robot linear_delta --json").out;
  const std::string level = R"({"name": "beta0", "limb": 3, "value": 0.2, "unit": "deg"})";
  const std::string tilting = R"({"name": "rod_difference", "limb": 1, "value": 0.3, "unit": "mm"})";
  for (const std::string& errors : {level, fmt::format("{}, {}", level, tilting)}) {
    folder.write("delta.json", fmt::format(R"({{"accepted": true, "parameters": [{}], "robot": {}}})", errors, robot));
    const std::string command = "export --robot linear_delta --calibration delta.json --target c99 --out compensator.h";
    ASSERT_EQ(folder.run(command).exit_code, kDone);
    folder.write("test.c", "#include \"compensator.h\"\nint main(void) { return paracal_self_test(); }\n");
    const std::string compile = std::string(GetParam()) + " -std=c99 -pedantic -Wall -Wextra -Wconversion -Werror ";
    ASSERT_EQ(shell(compile + "test.c -lm -o test"), 0);
    EXPECT_EQ(shell("./test"), 0);
  }
}

TEST_F(Export, TheHeaderSaysWhereItComesFrom) {
  const std::string header = folder.run("export --calibration calibration.json --target c99").out;
  for (const char* said :
       {"robot        huang2016", "calibration  calibration.json", "mm and rad", "SHA-256", "date"}) {
    EXPECT_THAT(header, HasSubstr(said));
  }
  EXPECT_EQ(header.find('$'), std::string::npos);
  const json exported = json_from("export --calibration calibration.json --target c99");
  EXPECT_THAT(header, HasSubstr(exported.at("calibration_sha256").get<std::string>()));
}

/// The header names the rules of MISRA C:2012 that it does not keep.
TEST_F(Export, TheHeaderKeepsToMisra) {
  if (*PARACAL_CPPCHECK == '\0') GTEST_SKIP() << "cppcheck is not installed";
  const std::string check = std::string(PARACAL_CPPCHECK) +
                            " --addon=misra --enable=style,warning,performance,portability --std=c99 --quiet "
                            "--error-exitcode=1 --suppress=misra-c2012-2.5 --suppress=misra-c2012-15.5 "
                            "--suppress=misra-c2012-21.2 ";
  folder.write("careless.c", "int f(int a);\nint f(int a) { if (a) { return 1; } return 2; }\n");
  EXPECT_NE(shell(check + "careless.c 2> careless.txt"), 0);
  EXPECT_THAT(folder.read("careless.txt"), HasSubstr("misra-c2012-14.4"));
  export_to("c99", "compensator.h");
  EXPECT_THAT(folder.read("compensator.h"), HasSubstr("but for 2.5"));
  folder.write("kernel.c",
               "#include \"compensator.h\"\nint self_test(void);\n"
               "int self_test(void) { return paracal_self_test(); }\n");
  // Rules on the program as a whole do not count for its exit code.
  EXPECT_EQ(shell(check + "kernel.c 2> said.txt"), 0);
  EXPECT_EQ(folder.read("said.txt"), "");
}

// ---- Structured Text, whose laws are in tests/compensation

TEST_F(Export, StructuredTextSaysWhereItComesFrom) {
  const json exported = json_from("export --calibration calibration.json --target st");
  const std::string text = exported.at("text");
  EXPECT_EQ(text, folder.run("export --calibration calibration.json --target st").out);
  for (const char* said : {"robot        huang2016", "calibration  calibration.json", "joints in rad",
                           "FUNCTION_BLOCK paracal_compensator", "FUNCTION_BLOCK paracal_self_test"}) {
    EXPECT_THAT(text, HasSubstr(said));
  }
  EXPECT_THAT(text, HasSubstr(exported.at("calibration_sha256").get<std::string>()));
  EXPECT_EQ(text.find('$'), std::string::npos);
}

/// A name cannot end the comment or the string that it stands in.
TEST_F(Export, AFilesNameStaysAName) {
  folder.write("*\" #error.json", kCalibration);
  const std::string header =
      folder.run(std::vector<std::string>{"export", "--target", "c99", "--calibration", "*\" #error.json"}).out;
  EXPECT_THAT(header, HasSubstr("calibration  __ #error.json"));
}

// ---- LinuxCNC

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
std::string hal_of_trial() {
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
loadusr -w halsampler -n 10000 samples.txt
stop
)";
}

/// HAL loads modules from its own folder only, so the two are installed, under a name that no machine uses.
class LinuxcncExport : public Export {
 protected:
  static inline const std::filesystem::path kModules = "/usr/lib/linuxcnc/modules";

  void SetUp() override {
    Export::SetUp();
    if (*PARACAL_HALCOMPILE == '\0') GTEST_SKIP() << "halcompile (linuxcnc-uspace-dev) is not installed";
    if (::access(kModules.c_str(), W_OK) != 0) GTEST_SKIP() << "installing into " << kModules << " needs root";
    lock_ = ::open("/tmp/paracal-hal.lock", O_CREAT | O_RDWR, 0666);
    ASSERT_EQ(::flock(lock_, LOCK_EX), 0);  // a machine has one HAL
    // Started by root, HAL becomes another user, who needs a socket and files to write.
    std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
    folder.write("trial.hal", "loadrt or2\n");
    if (halrun() != 0) GTEST_SKIP() << "HAL does not start here: " << folder.read("halrun.log");
  }

  void TearDown() override {
    for (const char* module : {"paracal_trial.so", "paracal_probe.so"}) std::filesystem::remove(kModules / module);
    ::close(lock_);
  }

  int install(const char* component) const {
    return shell(fmt::format("{} --install {}.comp > halcompile.log 2>&1", PARACAL_HALCOMPILE, component));
  }

  int halrun() const {
    return shell(fmt::format("{} RTAPI_FIFO_PATH=$PWD/socket timeout 120 halrun trial.hal > halrun.log 2>&1",
                             ::geteuid() == 0 ? "RTAPI_UID=65534" : ""));
  }

 private:
  int lock_ = -1;
};

TEST_F(LinuxcncExport, GivesTheLibrarysJointsAndFindsTheWayBack) {
  export_to("linuxcnc", "paracal_kins.comp");
  folder.write("paracal_trial.comp",
               replaced(folder.read("paracal_kins.comp"), "component paracal_kins ", "component paracal_trial "));
  folder.write("paracal_probe.comp", kProbe);
  for (const char* component : {"paracal_trial", "paracal_probe"}) {
    ASSERT_EQ(install(component), 0) << folder.read("halcompile.log");
  }
  const std::vector<PoseNumbers> poses = random_poses(10'000);
  const json joints = library_joints(poses);
  std::ostringstream stream;
  stream.precision(17);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (const double number : poses[k]) stream << number << ' ';
    for (const json& joint : joints[k]) stream << joint.get<double>() << ' ';
    stream << '\n';
  }
  folder.write("stream.txt", stream.str());
  folder.write("trial.hal", hal_of_trial());
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
  std::string text = replaced(folder.read("paracal_kins.comp"), "component paracal_kins ", "component paracal_trial ");
  const std::size_t arm = text.find("375.15");  // arm of limb 3
  ASSERT_NE(arm, std::string::npos);
  text.replace(arm, 6, "375.16");
  folder.write("paracal_trial.comp", text);
  ASSERT_EQ(install("paracal_trial"), 0);
  folder.write("trial.hal", "loadrt paracal_trial\n");
  EXPECT_NE(halrun(), 0);
  EXPECT_THAT(folder.read("halrun.log"), HasSubstr("of the self-test failed"));
}

}  // namespace
}  // namespace paracal::test
