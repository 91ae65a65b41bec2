// The component of LinuxCNC, built by halcompile and run by HAL.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <sstream>

#include "broken_input.hpp"
#include "exported.hpp"

namespace paracal::test {
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
