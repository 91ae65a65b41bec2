#include "paracal/calibration/identifiability.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

#include "calibration/fit/null_space.hpp"
#include "paracal/calibration/plan.hpp"
#include "paracal/kinematics/exact_jacobian.hpp"
#include "paracal/kinematics/forward.hpp"
#include "support/robots.hpp"

namespace paracal::identifiability_test {
namespace {

using testing::Contains;
using testing::HasSubstr;

std::vector<std::string> texts(const Identifiability& seen) {
  std::vector<std::string> all;
  for (const NullDirection& one : seen.null_space) all.push_back(one.text);
  return all;
}

/// The table of docs/paper-slips.md, 2.3: the paper's fine poses, 32 columns.
struct RankCase {
  std::string name;
  bool distances, rotation;
  Frame frame;
  RotationZero zero;
  bool turned;
  int rank;
};

class PaperRanks : public testing::TestWithParam<RankCase> {};

TEST_P(PaperRanks, AreThoseOfTheTable) {
  const RankCase& one = GetParam();
  const Robot robot = catalogue::huang2016();
  std::vector<Station> stations = fine_stations(robot, 9);
  if (!one.turned) {
    for (Station& station : stations) station.commanded.rotation = 0.0;
  }
  const Measurements plan =
      planned(robot, stations,
              {.measurand = one.distances ? Measurand::distances : Measurand::coordinates, .rotation = one.rotation});
  const Identifiability seen = identifiability(robot, plan, {.frame = one.frame, .rotation_zero = one.zero});
  EXPECT_EQ(seen.rank, one.rank);
  EXPECT_EQ(seen.null_space.size(), 32u - static_cast<std::size_t>(one.rank));
  // With distances and with coordinates, whatever goes unseen is a motion of the whole robot, and is called so.
  for (const NullDirection& direction : seen.null_space) EXPECT_TRUE(direction.gauge) << direction.text;
}

constexpr auto kUnknown = RotationZero::unknown, kKnown = RotationZero::known;
INSTANTIATE_TEST_SUITE_P(
    Huang2016, PaperRanks,
    testing::Values(RankCase{"Distances", true, false, Frame::unknown, kUnknown, true, 27},
                    RankCase{"DistancesWithoutTurns", true, false, Frame::unknown, kUnknown, false, 25},
                    RankCase{"DistancesAndRelativeRotation", true, true, Frame::unknown, kUnknown, true, 27},
                    RankCase{"UnknownFrame", false, false, Frame::unknown, kUnknown, true, 27},
                    RankCase{"UnknownFrameWithoutTurns", false, false, Frame::unknown, kUnknown, false, 25},
                    RankCase{"UnknownFrameRelativeRotation", false, true, Frame::unknown, kUnknown, true, 27},
                    RankCase{"UnknownFrameAbsoluteRotation", false, true, Frame::unknown, kKnown, true, 28},
                    RankCase{"RobotFrame", false, false, Frame::robot, kUnknown, true, 31},
                    RankCase{"RobotFrameRelativeRotation", false, true, Frame::robot, kUnknown, true, 31},
                    RankCase{"RobotFrameAbsoluteRotation", false, true, Frame::robot, kKnown, true, 32}),
    [](const auto& one) { return one.param.name; });

TEST(Identifiability, NamesWhatDistancesDoNotSee) {
  const Robot robot = catalogue::huang2016();
  const Identifiability seen =
      identifiability(robot, planned(robot, fine_stations(robot, 9), {.measurand = Measurand::distances}));
  EXPECT_THAT(texts(seen), testing::ElementsAre(HasSubstr("shifts along x"), HasSubstr("shifts along y"),
                                                HasSubstr("shifts along z"), "the slide zero shifts",
                                                "the base rotates about the slide axis"));
}

TEST(Identifiability, NamesWhatEquation15LeavesOpen) {
  const Robot robot = catalogue::huang2016();
  std::vector<SoughtSource> columns;
  for (std::size_t limb = 0; limb < 4; ++limb) {
    for (const Source source :
         {Source("e_x"), Source("e_y"), Source("e_z"), Source("arm_length"), Source("rod_mean")}) {
      const bool fixed = (limb == 1 && (source == "e_x" || source == "e_z")) || (limb == 2 && source == "e_z") ||
                         (limb == 3 && (source == "e_x" || source == "e_y" || source == "e_z"));
      if (!fixed) columns.push_back({limb, source});
    }
    for (const Source source : {Source("theta_offset"), Source("alpha0"), Source("beta0")})
      columns.push_back({limb, source});
  }
  ASSERT_EQ(columns.size(), 26u);
  const Identifiability seen =
      identifiability(robot, planned(robot, fine_stations(robot, 9), {.measurand = Measurand::distances}), {}, columns);
  EXPECT_EQ(seen.rank, 25);
  ASSERT_EQ(seen.null_space.size(), 1u);
  EXPECT_THAT(seen.null_space[0].text,
              testing::AllOf(HasSubstr("the slide zero shifts"), HasSubstr("e_y of limb 1"), HasSubstr("of limb 2")));
  EXPECT_TRUE(seen.null_space[0].gauge);
}

TEST(Identifiability, FewPosesLeaveMoreThanMotionsOpen) {
  const Robot robot = catalogue::huang2016();
  const Identifiability seen =
      identifiability(robot, planned(robot, rough_stations(robot, 3), {.measurand = Measurand::distances}));
  EXPECT_LE(seen.rank, 6);
  EXPECT_THAT(seen.null_space, Contains(testing::Field(&NullDirection::gauge, false)));
  const std::string lines = detail::undetermined_lines(seen.null_space);
  EXPECT_EQ(std::ranges::count(lines, '\n'), 6);
  EXPECT_THAT(lines,
              HasSubstr(fmt::format("\n  and {} further combinations of parameters", seen.null_space.size() - 5)));
  EXPECT_THAT(seen.null_space.back().text, testing::MatchesRegex("mainly [a-z0-9_]+ of limb [1-4] .*"));
}

/// Rails that lie flat by beta0_deg = -90: alpha0 turns them about themselves, which leaves nothing of the machine
/// open. Where the carriage holds its joints beside the rail, their way round it is undone by e.
TEST(Identifiability, RailsThatLieFlatTurnAboutThemselvesUnseen) {
  for (const double arm : {0.0, 20.0}) {
    RobotDescription description = catalogue::linear_delta().description();
    test::redimension(description, [&](SharedDimensions& shared) { shared.base_radius = 500.0; });
    test::redimension(description, [&](SharedDimensions& shared) { shared.arm = arm; });
    test::redimension(description, [&](SharedDimensions& shared) { shared.rod = 700.0; });
    description.workspace = {.radius = 200.0, .height = 150.0, .top_z = -450.0};
    for (std::size_t limb = 0; limb < 3; ++limb)
      test::redimension(description,
                        [&](SharedDimensions& shared) { shared.differences(limb, "beta0") = -0.5 * std::numbers::pi; });
    const Robot robot(description);
    const Identifiability seen = identifiability(robot, planned(robot, fine_stations(robot, 9)));
    for (const NullDirection& one : seen.null_space) EXPECT_TRUE(one.gauge) << one.text;
    EXPECT_THAT(texts(seen), Contains(HasSubstr("the rail")).Times(3)) << arm;
  }
}

class GaugeLaw : public test::EveryRobot {};

/// A gauge motion moves every point alike: distances do not change, to first order.
TEST_P(GaugeLaw, MotionsKeepDistances) {
  const std::vector<Station> stations = fine_stations(robot, 5);
  for (const GaugeMotion& motion : gauge_motions(robot)) {
    const bool turns_slide = robot.slide() && motion.text.find("about ") != std::string::npos &&
                             motion.text.find("slide axis") == std::string::npos &&
                             motion.text.find("about y") == std::string::npos;
    if (turns_slide) continue;  // seen where phi is not 0
    SourceErrors small;
    for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
      for (const Source source : all_sources()) small(limb, source) = 1e-4 * motion.direction(limb, source);
    }
    const Machine moved = build(robot, small);
    std::vector<Eigen::Vector3d> before, after;
    for (const Station& station : stations) {
      before.push_back(station.commanded.position);
      after.push_back(forward(moved, believed_joints(robot, station)).plate.position);
    }
    for (std::size_t k = 1; k < stations.size(); ++k) {
      EXPECT_NEAR((after[k] - after[0]).norm(), (before[k] - before[0]).norm(), 2e-5) << motion.text;
    }
  }
}

/// A rigid plate's robot may turn any way, and the base joints of a robot on leaning rails shift along these.
TEST_P(GaugeLaw, UnknownFrameHidesExactlyTheMotions) {
  const Identifiability seen = identifiability(robot, planned(robot, fine_stations(robot, 9)));
  for (const NullDirection& direction : seen.null_space) EXPECT_TRUE(direction.gauge) << direction.text;
  const auto shifts = std::ranges::count_if(gauge_motions(robot), [](const GaugeMotion& one) {
    return one.text.find("along its rail") != std::string::npos;
  });
  EXPECT_EQ(shifts, robot.name() == "inclined_rails" ? 3 : 0);
  EXPECT_EQ(seen.rank, static_cast<int>(seen.parameters.size()) - (robot.slide() ? 5 : 6) - shifts);
}

PARACAL_ON_EVERY_ROBOT(GaugeLaw);
PARACAL_ON_UNUSUAL_ROBOTS(GaugeLaw);

TEST(Observability, IndicesOfKnownSingularValues) {
  const Observability o = observability(Eigen::Vector4d(8, 4, 2, 0), 3, 16);
  EXPECT_DOUBLE_EQ(o.O1, 4.0 / 4.0);
  EXPECT_DOUBLE_EQ(o.O2, 0.25);
  EXPECT_DOUBLE_EQ(o.O3, 2.0);
  EXPECT_DOUBLE_EQ(o.O4, 0.5);
  EXPECT_DOUBLE_EQ(o.O5, 1.0 / (1.0 / 8 + 1.0 / 4 + 1.0 / 2));
  EXPECT_EQ(observability(Eigen::Vector2d(0, 0), 0, 4).O2, 0.0);
}

}  // namespace
}  // namespace paracal::identifiability_test
