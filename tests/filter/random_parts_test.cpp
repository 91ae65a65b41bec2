// Programs that nobody has written, read by LinuxCNC's interpreter before and after: in order, on the true machine, and
// in time.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "canonical_program.hpp"
#include "filtered_program.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "random_part.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::io::random_parts_test {
namespace {

namespace fs = std::filesystem;

const Eigen::Vector3d kOrigin(0, 0, -950);
constexpr double kChord = 0.02;      // mm
constexpr double kRounding = 4e-3;   // mm: rs274 prints four decimals, of inches, too
constexpr double kOfDegrees = 1e-3;  // deg

class RandomParts : public testing::TestWithParam<std::string_view> {
 protected:
  void SetUp() override {
    if (std::string_view(PARACAL_RS274).empty()) GTEST_SKIP() << "rs274 (linuxcnc-uspace) is not installed";
    folder = fs::temp_directory_path() / fmt::format("paracal-parts-{}-{}", GetParam(), getpid());
    fs::create_directories(folder);
    std::ofstream table(folder / "tool.tbl");  // the interpreter without a controller counts in inches
    for (int tool = 1; tool <= 2; ++tool) {
      table << fmt::format("T{} P{} Z{:.9f}\n", tool, tool, test::RandomPart::kToolLengths[tool - 1] / 25.4);
    }
  }
  void TearDown() override {
    if (!folder.empty()) fs::remove_all(folder);
  }

  test::CanonicalProgram read_by_linuxcnc(const std::string& text) const {
    std::ofstream(folder / "part.ngc") << text;
    return test::interpreted(std::string(PARACAL_RS274) + "' -t 'tool.tbl", folder, folder / "part.ngc", true);
  }

  /// Where the machine as built goes when its controller, which computes with the nominal robot, is told a place.
  Pose reached(const Eigen::Vector3d& told, double rotation) const {
    const InverseResult joints = inverse(robot.nominal(), Pose{told + kOrigin, to_radians(rotation)});
    const ForwardResult found = forward(machine, joints.joints);
    EXPECT_TRUE(joints.ok() && found.ok());
    Pose pose = pose_of(machine, found.plate);
    pose.position -= kOrigin;
    return pose;
  }

  const Robot robot = catalogue::find(GetParam());
  const bool turns = robot.slide().has_value();
  const SourceErrors errors = test::table4_machine(robot, 3);
  const Machine machine = build(robot, errors);
  const TargetCorrection correction{robot, errors};
  const ToolTable tools{{1, {0.0, 0.0, test::RandomPart::kToolLengths[0], 0.0}},
                        {2, {0.0, 0.0, test::RandomPart::kToolLengths[1], 0.0}}};
  fs::path folder = {};
};

/// The moves of a program by the line that states them.
std::map<int, test::CanonicalPath> by_lines(const test::CanonicalProgram& program) {
  std::map<int, test::CanonicalPath> lines;
  for (const test::CanonicalPath& path : program.paths) {
    for (const test::CanonicalMove& move : path) lines[move.line].push_back(move);
  }
  return lines;
}

double time_of(const test::CanonicalPath& path) {
  double time = 0.0;
  for (const test::CanonicalMove& move : path) time += move.time();
  return time;
}

/// Of what the interpreter prints with so many mm of rounding: its share of the time of a path.
double time_of_rounding(const test::CanonicalPath& path, double rounding) {
  double time = 0.0;
  for (const test::CanonicalMove& move : path) {
    if (move.time() > 0.0)
      time += move.time() * (2.0 * rounding / std::max(move.length(), rounding) + rounding / move.feed);
  }
  return time;
}

/// Each line ends where it ended, keeps within the chord of its path, in its order, and takes its time. Too few fail
/// where a state is followed wrongly: each program has some 25 lines of 14 kinds.
TEST_P(RandomParts, AreConvertedAndRight) {
  const int parts = test::machines({.claim = 500, .quick = 25});
  for (int k = 1; k <= parts; ++k) {
    const test::RandomPart part({.seed = static_cast<unsigned>(k), .turns = turns});
    SCOPED_TRACE(fmt::format("seed {}:\n{}", k, part.text()));
    const test::Filtered result =
        test::filtered_gcode(part.text(), correction,
                             {.origin = kOrigin, .chord = kChord, .dialect = GcodeDialect::linuxcnc, .tools = tools});
    ASSERT_TRUE(result.summary.complete()) << result.summary.passed.at(0).reason;
    const test::CanonicalProgram before = read_by_linuxcnc(part.text()), after = read_by_linuxcnc(result.text);
    ASSERT_TRUE(before.is_accepted) << before.complaint;
    ASSERT_TRUE(after.is_accepted) << after.complaint << result.text;
    const auto wanted = by_lines(before), told = by_lines(after);
    ASSERT_EQ(wanted.size(), told.size());
    bool is_first = true;  // from where nothing was corrected
    for (const auto& [line, path] : wanted) {
      ASSERT_TRUE(told.contains(line));
      ASSERT_EQ(path.size(), 1U);
      const test::CanonicalMove& move = path[0];
      const test::CanonicalPath& pieces = told.at(line);
      const Pose end = reached(pieces.back().to, pieces.back().to_rotation);
      EXPECT_LE((end.position - move.to).norm(), kRounding) << "line N" << line;
      if (turns) {
        EXPECT_NEAR(to_degrees(end.rotation), move.to_rotation, kOfDegrees) << "line N" << line;
      }
      if (!std::exchange(is_first, false)) {
        for (std::size_t j = 0; j < pieces.size(); ++j) {
          const Pose middle = reached(pieces[j].at(0.5), pieces[j].rotation_at(0.5));
          EXPECT_LE(move.distance(middle.position), kChord + kRounding) << "line N" << line;
          const double along = (static_cast<double>(j) + 0.5) / static_cast<double>(pieces.size());
          EXPECT_LE((middle.position - move.at(along)).norm(),
                    0.6 * move.length() / static_cast<double>(pieces.size()) + 0.1)
              << "line N" << line;
        }
        constexpr double kShort = 0.5;  // mm: four decimals of an inch are no time for it
        if (before.rounding > 1e-3 && move.length() < kShort) continue;
        EXPECT_NEAR(time_of(pieces), move.time(), 0.03 * move.time() + time_of_rounding(pieces, before.rounding) + 1e-9)
            << "line N" << line;
      }
      if (HasFailure()) FAIL() << result.text;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, RandomParts, testing::Values(std::string_view("huang2016"), "rotary_delta"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace paracal::io::random_parts_test
