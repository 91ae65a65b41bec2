// The exported C header, compiled and loaded, on every robot.

#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "export_law.hpp"

namespace paracal::test::export_c99_test {
namespace {

using CHeaderLaw = ExportLaw;

/// The header compiled and loaded.
class CLibrary {
 public:
  explicit CLibrary(const std::string& header) {
    std::string name = (std::filesystem::temp_directory_path() / "paracal-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = name;
    std::ofstream(folder_ / "compensator.h") << header;
    std::ofstream(folder_ / "kernel.c")
        << "#include \"compensator.h\"\n"
           "int self_test(void);\nint self_test(void) { return paracal_self_test(); }\n"
           "int joints_of(const double pose[4], double joints[4], double tilt[2]);\n"
           "int joints_of(const double pose[4], double joints[4], double tilt[2]) {\n"
           "  return paracal_compensate(pose[0], pose[1], pose[2], pose[3], joints, tilt);\n}\n"
           "int pose_of(const double joints[4], double pose[4]);\n"
           "int pose_of(const double joints[4], double pose[4]) { return paracal_forward(joints, pose); }\n";
    const std::string command = fmt::format(
        "cd '{}' && {} -std=c99 -O1 -fPIC -ffreestanding -pedantic -Wall -Wextra -Wshadow -Wconversion -Werror -shared "
        "kernel.c -o kernel.so -lm",
        folder_.string(), PARACAL_GCC);
    if (std::system(command.c_str()) != 0)
      throw std::runtime_error("the header does not compile");  // NOLINT(*-env33-c)
    library_ = ::dlopen((folder_ / "kernel.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr) throw std::runtime_error(::dlerror());
  }
  ~CLibrary() {
    ::dlclose(library_);
    std::filesystem::remove_all(folder_);
  }
  CLibrary(const CLibrary&) = delete;
  CLibrary& operator=(const CLibrary&) = delete;

  template <typename Function>
  Function* function(const char* name) const {
    return reinterpret_cast<Function*>(::dlsym(library_, name));
  }

 private:
  std::filesystem::path folder_;
  void* library_ = nullptr;
};

using JointsOf = int(const double*, double*, double*);
using PoseOf = int(const double*, double*);
using SelfTest = int();

TEST_P(CHeaderLaw, GivesTheLibrarysJointsAndFindsTheWayBack) {
  if (*PARACAL_GCC == '\0') GTEST_SKIP() << "gcc is not installed";
  const CLibrary library(c99_header(robot, errors, kOrigin));
  const auto joints_of = library.function<JointsOf>("joints_of");
  const auto pose_of = library.function<PoseOf>("pose_of");
  EXPECT_EQ(library.function<SelfTest>("self_test")(), 0);
  Answer answer;
  const auto answer_to = [&](const CompensatorPose<double>& pose) {
    answer.status =
        joints_of(std::array{pose.x, pose.y, pose.z, pose.phi}.data(), answer.joints.data(), &answer.tilt.eps_x);
    return answer;
  };
  hold_to_the_library(answer_to);
  survive_bad_poses(answer_to);
  judge_poses_anywhere(answer_to);

  double worst = 0.0;
  for (int k = 0; k < 200; ++k) {
    const Pose pose = random.pose(robot);
    answer_to(compensator_pose(pose));
    std::array<double, 4> found{};
    ASSERT_EQ(pose_of(answer.joints.data(), found.data()), 0) << k;
    worst = std::max(worst, (Eigen::Vector3d(found.data()) - pose.position).norm());
    EXPECT_NEAR(found[3], pose.rotation, 1e-9);
  }
  EXPECT_LT(worst, 1e-8);
  std::array<double, 4> kept{1.0, 2.0, 3.0, 0.0};
  const double far = robot.actuator() == Actuator::linear ? 5000.0 : 3.0;
  EXPECT_NE(pose_of(std::array{far, -far, std::nan(""), 0.0}.data(), kept.data()), 0);
  EXPECT_EQ(kept, (std::array{1.0, 2.0, 3.0, 0.0}));
}

PARACAL_ON_EVERY_EXPORT(CHeaderLaw);

}  // namespace
}  // namespace paracal::test::export_c99_test
