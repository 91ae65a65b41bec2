// The exported C header, compiled and loaded, on every robot.

#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "export_law.hpp"
#include "paracal/kinematics/forward.hpp"

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
           "int joints_of(const double pose[6], double joints[PARACAL_LIMBS], double plate[6]);\n"
           "int joints_of(const double pose[6], double joints[PARACAL_LIMBS], double plate[6]) {\n"
           "  return paracal_compensate(pose, joints, plate);\n}\n"
           "int pose_of(const double joints[PARACAL_LIMBS], double pose[6]);\n"
           "int pose_of(const double joints[PARACAL_LIMBS], double pose[6]) { return paracal_forward(joints, pose); }\n"
           "int rates_of(const double pose[6], double rates[]);\n"
           "int rates_of(const double pose[6], double rates[]) { return paracal_jacobian(pose, rates); }\n"
           "static struct paracal_machine machine;\n"
           "int change(const double set[], double cycles);\n"
           "int change(const double set[], double cycles) { return paracal_change(&machine, set, cycles); }\n"
           "void start(void);\nvoid start(void) { paracal_start(&machine); }\n"
           "int cycle(const double pose[6], double joints[PARACAL_LIMBS]);\n"
           "int cycle(const double pose[6], double joints[PARACAL_LIMBS]) {\n"
           "  return paracal_cycle(&machine, pose, joints, NULL);\n}\n";
    const std::string command = fmt::format(
        "cd '{}' && {} -std=c99 -O1 -fPIC -ffreestanding -pedantic -Wall -Wextra -Wshadow -Wconversion "
        "-Wdouble-promotion -Werror -shared "
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
using Change = int(const double*, double);

std::array<double, 6> numbers(Pose pose, const Robot& robot) {
  std::array<double, 6> all{};
  for (std::size_t k = 0; k < 6; ++k) all.at(k) = coordinate(pose, robot, k);
  if (!robot.slide()) all[5] += pose.rotation;  // asked of a plate that cannot turn
  return all;
}

Answer answer_of(const CLibrary& library, const Robot& robot, const Pose& pose, Answer before = {}) {
  std::array<double, 6> plate{};
  before.status =
      library.function<JointsOf>("joints_of")(numbers(pose, robot).data(), before.joints.data(), plate.data());
  if (before.status == 0) {
    before.tilt = {plate[3] - pose.tilt.x(), plate[4] - pose.tilt.y(), plate[5] - pose.tilt.z()};
  }
  return before;
}

TEST_P(CHeaderLaw, GivesTheLibrarysJointsAndFindsTheWayBack) {
  if (*PARACAL_GCC == '\0') GTEST_SKIP() << "gcc is not installed";
  const CLibrary library(c99_header(robot, errors, kOrigin, drives));
  const auto pose_of = library.function<PoseOf>("pose_of");
  EXPECT_EQ(library.function<SelfTest>("self_test")(), 0);
  Answer answer;
  const auto answer_to = [&](const Pose& pose) {
    answer = answer_of(library, robot, pose, answer);
    return answer;
  };
  hold_to_the_library(answer_to);
  survive_bad_poses(answer_to);
  judge_poses_anywhere(answer_to);

  double worst = 0.0;
  std::array<double, 6> home{};
  ASSERT_NE(pose_of(answer.joints.data(), home.data()), 2);
  for (int k = 0; k < 200; ++k) {
    const Pose pose = random.pose(robot);
    answer_to(pose);
    std::array<double, 6> found = numbers({robot.workspace().centre()}, robot), wanted = numbers(pose, robot);
    ASSERT_EQ(pose_of(answer.joints.data(), found.data()), 0) << k;
    for (std::size_t place = 0; place < 6; ++place)
      worst = std::max(worst, std::abs(found.at(place) - wanted.at(place)));
  }
  EXPECT_LT(worst, 1e-8);
  std::array<double, 6> kept{1.0, 2.0, 3.0, 0.0, 0.0, 0.0};
  const double far = runs_on_rail(robot.actuator()) ? 5000.0 : 3.0;
  EXPECT_NE(pose_of(std::array{far, -far, std::nan(""), 0.0, 0.0, 0.0, 0.0}.data(), kept.data()), 0);
  EXPECT_EQ(kept, (std::array{1.0, 2.0, 3.0, 0.0, 0.0, 0.0}));
}

/// What cannot be commanded must be where it is held.
TEST_P(CHeaderLaw, RefusesWhatIsNotCommanded) {
  const CLibrary library(c99_header(robot, errors, kOrigin, drives));
  const std::vector<std::size_t> places = commanded_of(robot);
  for (std::size_t k = 0; k < 6; ++k) {
    if (std::ranges::count(places, k) > 0) continue;
    std::array<double, 6> pose = numbers({robot.workspace().centre()}, robot);
    std::array<double, 8> joints{};
    const auto joints_of = library.function<JointsOf>("joints_of");
    EXPECT_EQ(joints_of(pose.data(), joints.data(), nullptr), 0);
    pose.at(k) += 1e-3;
    EXPECT_EQ(joints_of(pose.data(), joints.data(), nullptr), 1) << k;
  }
}

TEST_P(CHeaderLaw, RatesAreThoseOfTheJoints) {
  const std::string text = c99_header(robot, errors, kOrigin, drives);
  const CLibrary library(text);
  const auto rates_at = [&](const Pose& pose) {
    std::vector<double> rates(robot.limb_count() * commanded_of(robot).size());
    EXPECT_EQ(library.function<PoseOf>("rates_of")(numbers(pose, robot).data(), rates.data()), 0);
    return rates;
  };
  const double stated = stated_rate_error(text);
  EXPECT_EQ(stated > 0.0, parameters().tilts_plate != 0);
  EXPECT_LT(stated, 0.05);
  hold_rates(rates_at, std::max(stated, 1e-7));
}

/// The numbers of a later calibration come in equal parts, without a jump, or not at all.
TEST_P(CHeaderLaw, ChangesInEqualParts) {
  const CLibrary library(c99_header(robot, errors, kOrigin, drives));
  SourceErrors later;
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    for (const Parameter& one : robot.parameters()) {
      if (one.limb == limb) later(limb, one.source) = 1.2 * errors(limb, one.source);
    }
  }
  std::vector<double> set = exported_set(robot, later, drives).set;
  const auto change = library.function<Change>("change");
  const auto cycle = library.function<PoseOf>("cycle");
  const std::array<double, 6> pose = numbers(random.pose(robot), robot);
  std::array<double, 8> first{}, between{}, last{};
  EXPECT_EQ(cycle(pose.data(), first.data()), 4);  // before it is started
  library.function<void()>("start")();
  ASSERT_EQ(cycle(pose.data(), first.data()), 0);
  for (const std::size_t damaged : {std::size_t{0}, set.size() / 2, set.size() - 2, set.size() - 1}) {
    std::vector<double> partial = set;
    partial[damaged] = damaged == 0 ? exported_set(robot, errors, drives).set[0] : partial[damaged] + 1.0;
    if (partial == set) continue;
    EXPECT_EQ(change(partial.data(), 4), 4) << damaged;
  }
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300, 0.0}) {
    std::vector<double> damaged = set;
    damaged[3] = bad;
    EXPECT_EQ(change(damaged.data(), 4), 4) << bad;
  }
  EXPECT_EQ(change(set_of_another_robot().data(), 4), 4);
  EXPECT_EQ(change(set.data(), 0), 4);
  ASSERT_EQ(cycle(pose.data(), between.data()), 0);
  EXPECT_EQ(between, first);
  ASSERT_EQ(change(set.data(), 4), 0);
  EXPECT_EQ(change(set.data(), 4), 5);
  std::vector<std::array<double, 8>> way;
  for (int k = 0; k < 5; ++k) ASSERT_EQ(cycle(pose.data(), way.emplace_back().data()), 0);
  last = way[3];
  const Machine machine = build(robot, later);
  Pose wanted{robot.workspace().centre()};
  for (std::size_t k = 0; k < 6; ++k) coordinate(wanted, robot, k) = pose.at(k);
  const Joints joints = drives.commanded(inverse(machine, wanted).joints);
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    EXPECT_NEAR(last.at(i), joints(static_cast<Eigen::Index>(i)), tolerance());
    EXPECT_EQ(way[4].at(i), last.at(i));
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = static_cast<double>(k + 1) / 4.0;
      EXPECT_NEAR(way[k].at(i), first.at(i) + share * (last.at(i) - first.at(i)), tolerance());
    }
  }
}

/// Each variant states its largest error in um, and keeps to it where nobody has looked.
TEST_P(CHeaderLaw, VariantsStateTheirError) {
  if (parameters().tilts_plate == 0) return;
  const Machine machine = build(robot, errors);
  for (const ExportVariant variant : {ExportVariant::one_step, ExportVariant::single}) {
    ExportOrigin origin = kOrigin;
    origin.variant = variant;
    const std::string text = c99_header(robot, errors, origin, drives);
    const CLibrary library(text);
    EXPECT_EQ(library.function<SelfTest>("self_test")(), 0);
    const std::string before = "error        at most ";
    const std::size_t at = text.find(before);
    const double stated = at == std::string::npos ? 1e-3 : std::stod(text.substr(at + before.size()));
    double worst = 0.0;
    for (int k = 0; k < 500; ++k) {
      const Pose pose = random.pose(robot);
      const Answer answer = answer_of(library, robot, pose);
      ASSERT_EQ(answer.status, 0);
      const Joints joints = drives.actual(compensated_joints(robot, answer.joints));
      const ForwardResult reached = forward(machine, joints, {.start = plate_at(machine, pose)});
      ASSERT_TRUE(reached.ok());
      worst = std::max(worst, 1e3 * (reached.plate.position - pose.position).norm());
    }
    EXPECT_LT(worst, 1.3 * stated);
    EXPECT_LT(stated, variant == ExportVariant::single ? 1.0 : 20.0);
  }
}

PARACAL_ON_EVERY_EXPORT(CHeaderLaw);

}  // namespace
}  // namespace paracal::test::export_c99_test
