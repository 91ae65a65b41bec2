// Programs and what becomes of them, read by LinuxCNC's own interpreter: the machine as built must follow the path that
// was programmed.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "canonical_program.hpp"
#include "paracal/filter/target_filter.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::io::gcode_paths_test {
namespace {

namespace fs = std::filesystem;

const Eigen::Vector3d kOrigin(0, 0, -900);

std::vector<fs::path> programs() {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "tests/filter/programs"))
    paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

class GcodePaths : public test::EveryRobot {
 protected:
  void SetUp() override {
    if (std::string_view(PARACAL_RS274).empty()) GTEST_SKIP() << "rs274 (linuxcnc-uspace) is not installed";
    folder = fs::temp_directory_path() / fmt::format("paracal-paths-{}-{}", GetParam(), getpid());
    fs::create_directories(folder);
  }
  void TearDown() override {
    if (!folder.empty()) fs::remove_all(folder);
  }

  FilterSummary filtered(const fs::path& program, const fs::path& to, double chord) const {
    std::ifstream in(program, std::ios::binary);
    std::ofstream out(to, std::ios::binary);
    return filter_gcode({program.string(), in}, [&](std::string_view text) { out << text; }, correction,
                        {.origin = kOrigin, .chord = chord});
  }

  /// Where the machine as built goes when its controller, which computes with the nominal robot, is told a place.
  Eigen::Vector3d reached(const Eigen::Vector3d& told, double rotation) const {
    const bool turns = robot.slide().has_value();
    const InverseResult joints = inverse(robot.nominal(), Pose{told + kOrigin, turns ? to_radians(rotation) : 0.0});
    EXPECT_TRUE(joints.ok());
    const ForwardResult pose = forward(build(robot, errors), joints.joints);
    EXPECT_TRUE(pose.ok());
    return pose.plate.position - kOrigin;
  }

  std::vector<Eigen::Vector3d> reached(const test::CanonicalPath& told) const {
    std::vector<Eigen::Vector3d> points;
    for (const test::CanonicalMove& move : told) {
      constexpr int kParts = 4;
      for (int k = points.empty() ? 0 : 1; k <= kParts; ++k) {
        points.push_back(
            reached(move.at(static_cast<double>(k) / kParts), move.rotation_at(static_cast<double>(k) / kParts)));
      }
    }
    return points;
  }

  test::Random random;
  SourceErrors errors = test::table4_machine(robot, 3);
  TargetCorrection correction{robot, errors};
  fs::path folder = {};
};

double distance_to(const test::CanonicalPath& path, const Eigen::Vector3d& point) {
  double nearest = 1e9;
  for (const test::CanonicalMove& move : path) nearest = std::min(nearest, move.distance(point));
  return nearest;
}

double distance_to(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& point) {
  double nearest = 1e9;
  for (std::size_t k = 1; k < points.size(); ++k) {
    nearest = std::min(nearest, test::CanonicalMove{.from = points[k - 1], .to = points[k]}.distance(point));
  }
  return nearest;
}

constexpr double kMicrometre = 1e-3;

/// LinuxCNC refuses nothing, calls all else as before, and on the machine as built the path of the output lies within
/// the chord and a micrometre of the path that was programmed; that is all of it.
TEST_P(GcodePaths, TheMachineFollowsThePathOfTheProgram) {
  double farthest = 0.0;
  for (const double chord : {0.01, 0.2}) {
    for (const fs::path& program : programs()) {
      SCOPED_TRACE(program.stem().string() + fmt::format(", chord {}", chord));
      const fs::path output = folder / program.filename();
      const FilterSummary summary = filtered(program, output, chord);
      if (!robot.slide() && program.stem() == "rotation") {  // its C is another axis of theirs
        EXPECT_FALSE(summary.whole());
        continue;
      }
      EXPECT_TRUE(summary.whole());
      EXPECT_GT(summary.corrected, 0);
      const test::CanonicalProgram before = test::interpreted(PARACAL_RS274, folder, program);
      const test::CanonicalProgram after = test::interpreted(PARACAL_RS274, folder, output);
      ASSERT_TRUE(before.is_accepted) << before.complaint;
      ASSERT_TRUE(after.is_accepted) << after.complaint;
      ASSERT_EQ(before.others, after.others);
      const double slack = kMicrometre + before.rounding;
      std::size_t approach = 1;  // the first motion comes from where nothing was corrected
      for (std::size_t k = 0; k < before.paths.size(); ++k) {
        const test::CanonicalPath &wanted = before.paths[k], &told = after.paths[k];
        ASSERT_EQ(wanted.empty(), told.empty());
        if (wanted.empty()) continue;
        const std::vector<Eigen::Vector3d> path = reached(told);
        for (std::size_t j = 4 * approach; j < path.size(); ++j) {
          const double off = distance_to(wanted, path[j]);
          farthest = std::max(farthest, off / (chord + slack));
          EXPECT_LE(off, chord + slack);
        }
        EXPECT_LE((path.back() - wanted.back().to).norm(), slack);
        for (std::size_t m = std::exchange(approach, 0); m < wanted.size(); ++m) {
          for (int j = 0; j <= 8; ++j) {
            EXPECT_LE(distance_to(path, wanted[m].at(j / 8.0)), chord + slack) << "of what was wanted";
          }
        }
      }
    }
  }
  EXPECT_GT(farthest, 0.8);  // not finer than asked for
}

// Robots that reach all of the programs.
INSTANTIATE_TEST_SUITE_P(Rotary, GcodePaths,
                         testing::Values(std::string_view("huang2016"), "rotary_delta", "unlike_limbs"),
                         test::robot_name);

}  // namespace
}  // namespace paracal::io::gcode_paths_test
