// Filters on robots whose plate does more or less than stay level: tilts, stays in a plane, or has limbs to spare.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "filtered_program.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/compensation/self_test.hpp"
#include "paracal/error.hpp"
#include "paracal/io/file.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/random.hpp"
#include "paracal/units.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"

namespace paracal::io::any_robot_test {
namespace {

using testing::HasSubstr, testing::IsEmpty, testing::SizeIs;

using test::Filtered, test::filtered_gcode, test::filtered_table, test::lines_in, test::word;

constexpr std::string_view kLetters = "XYZABC";

/// A template, or a file of the samples.
Robot robot_called(std::string_view name) {
  const auto path = test::source_folder() / "samples" / fmt::format("{}.toml", name);
  return std::filesystem::exists(path) ? read_robot(read_file(path)) : test::robot_named(name);
}

SourceErrors errors_of(const Robot& robot) {
  RandomStream stream(4);
  return draw_errors(robot, tolerances_of(robot), stream);
}

/// The plate's six coordinates, mm and deg.
ProgramAxes axes_of(const Pose& pose) {
  const Eigen::Vector3d& r = pose.position;
  return {r.x(), r.y(), r.z(), to_degrees(pose.tilt.x()), to_degrees(pose.tilt.y()), to_degrees(pose.tilt.z())};
}

Pose pose_of(const ProgramAxes& axes) {
  return {{axes[0], axes[1], axes[2]}, 0.0, {to_radians(axes[3]), to_radians(axes[4]), to_radians(axes[5])}};
}

class AnyRobot : public testing::TestWithParam<std::string_view> {
 protected:
  bool moves(std::size_t axis) const { return robot.nominal().freedoms.free.at(axis); }

  /// The axes that the robot moves, as words of a block.
  std::string words(const Pose& pose) const {
    std::string text;
    for (std::size_t axis = 0; axis < kLetters.size(); ++axis) {
      if (moves(axis)) text += fmt::format(" {}{:.4f}", kLetters[axis], axes_of(pose).at(axis));
    }
    return text;
  }

  /// Poses that a text tells one after the other; axes that a line does not state stay.
  std::vector<Pose> told_in(const std::string& text) const {
    ProgramAxes held = axes_of({robot.workspace().centre()});
    std::vector<Pose> poses;
    for (const std::string& line : lines_in(text)) {
      for (std::size_t axis = 0; axis < kLetters.size(); ++axis) {
        if (moves(axis)) held.at(axis) = word(line, kLetters[axis]).value_or(held.at(axis));
      }
      poses.push_back(pose_of(held));
    }
    return poses;
  }

  /// All axes at first, then some.
  std::string random_program(int lines) {
    std::string text = "G0" + words({robot.workspace().centre()}) + "\n";
    for (int k = 0; k < lines; ++k) {
      const std::string all = words(random.pose(robot));
      text += "G1";
      for (std::size_t at = 0; at < all.size();) {
        const std::size_t next = std::min(all.find(' ', at + 1), all.size());
        if (random.uniform(0.0, 1.0) < 0.6) text += all.substr(at, next - at);
        at = next;
      }
      text += k == 5 ? " (go)\n" : "\n";
    }
    return text;
  }

  /// mm, turns at 100 mm from their axes; of what the robot moves.
  double distance(const Pose& one, const Pose& other) const {
    Eigen::Vector3d turned = one.tilt - other.tilt;
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (!moves(3 + static_cast<std::size_t>(k))) turned(k) = 0.0;
    }
    return std::max((one.position - other.position).norm(), 100.0 * turned.norm());
  }

  /// The largest distance of what a controller does from what a path asks of it, at quarters of the pieces.
  double farthest_from(const auto& path, const std::vector<Pose>& told) const {
    double farthest = 0.0;
    const double pieces = static_cast<double>(told.size()) - 1.0;
    for (std::size_t k = 1; k < told.size(); ++k) {
      for (const double part : {0.25, 0.5, 0.75, 1.0}) {
        const Pose &from = told[k - 1], &to = told[k];
        const Pose asked{from.position + part * (to.position - from.position), 0.0,
                         from.tilt + part * (to.tilt - from.tilt)};
        const double t = (static_cast<double>(k) - 1.0 + part) / pieces;
        farthest = std::max(farthest, distance(asked, *correction.target(path(t))));
      }
    }
    return farthest;
  }

  test::Random random;
  const Robot robot = robot_called(GetParam());
  const SourceErrors errors = errors_of(robot);
  const Machine machine = build(robot, errors);
  const TargetCorrection none{robot, {}}, correction{robot, errors};
};

PARACAL_ON_ROBOT_TEMPLATES(AnyRobot);
INSTANTIATE_TEST_SUITE_P(Sample, AnyRobot, testing::Values("mixed_limbs", "planar_belts", "seven_struts"),
                         test::robot_name);

TEST_P(AnyRobot, WithoutErrorsNothingChanges) {
  const std::string text = random_program(300);
  const Filtered result = filtered_gcode(text, none);
  EXPECT_EQ(result.text, text);
  EXPECT_GT(result.summary.corrected, 200);
  EXPECT_THAT(result.summary.passed, IsEmpty());
}

/// With spare limbs no pose has the joints; the target is the nearest.
TEST_P(AnyRobot, TheNominalInverseOfCorrectedTargetsGivesTheJoints) {
  const std::string text = random_program(300);
  const Filtered result = filtered_gcode(text, correction, {.chord = 0.0});  // no line is divided
  EXPECT_TRUE(result.summary.complete());
  const std::vector<Pose> wanted = told_in(text), told = told_in(result.text);
  ASSERT_EQ(wanted.size(), told.size());
  double joints_off = 0.0, off = 0.0, moved = 0.0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const InverseResult expected = inverse(machine, wanted[k]), joints = inverse(robot.nominal(), told[k]);
    ASSERT_TRUE(expected.ok() && joints.ok());
    const auto target = corrected_target(robot, expected.joints, wanted[k]);
    ASSERT_TRUE(target);
    off = std::max(off, distance(*target, told[k]));
    moved = std::max(moved, distance(wanted[k], told[k]));
    joints_off = std::max(joints_off, (joints.joints - expected.joints).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(off, 2e-4);  // half of the last digits
  EXPECT_GT(moved, 0.1);
  const bool agree = robot.nominal().spare_limbs() == 0;
  EXPECT_TRUE(!agree || joints_off < 1e-6 * test::joint_scale(robot)) << joints_off;
}

/// Of a line along and about all axes, and of a helix that tilts, in pieces.
TEST_P(AnyRobot, PathsStayWithinTheChord) {
  const Workspace& workspace = robot.workspace();
  const Pose from{workspace.at(0.9, 0.3, 0.2), 0.0, 0.9 * workspace.tilts().back()};
  const Pose to{workspace.at(0.9, 3.0, 0.8), 0.0, -0.5 * workspace.tilts().back()};
  const double radius = 0.5 * std::min(workspace.half_width(0), workspace.half_width(1));
  const Eigen::Vector3d centre = workspace.centre();
  const auto on_line = [&](double t) {
    return Pose{from.position + t * (to.position - from.position), 0.0, from.tilt + t * (to.tilt - from.tilt)};
  };
  const auto on_arc = [&](double t) {
    Pose pose = on_line(t);
    pose.position.head<2>() = centre.head<2>() + radius * Eigen::Vector2d(std::cos(2 * t), std::sin(2 * t));
    return pose;
  };
  const std::string arc = fmt::format("G3{} R{:.6f}\n", words(on_arc(1)), radius);
  for (const double chord : {0.003, 0.02}) {
    const Filtered line = filtered_gcode("G0" + words(from) + "\nG1" + words(to) + "\n", correction, {.chord = chord});
    const Filtered turn = filtered_gcode("G0" + words(on_arc(0)) + "\n" + arc, correction, {.chord = chord});
    EXPECT_TRUE(line.summary.complete());
    EXPECT_TRUE(turn.summary.complete());
    EXPECT_GT(turn.summary.added, 3);
    EXPECT_LT(farthest_from(on_line, told_in(line.text)), chord + 1e-3);
    EXPECT_LT(farthest_from(on_arc, told_in(turn.text)), chord + 1e-3);
  }
}

TEST_P(AnyRobot, TablesHaveColumnsOfWhatIsMoved) {
  const Pose wanted = random.pose(robot);
  const std::array names{"x_mm", "y_mm", "z_mm", "tilt_x_deg", "tilt_y_deg", "tilt_z_deg"};
  std::string header = "pose", row = "\na";
  for (std::size_t axis = 0; axis < names.size(); ++axis) {
    if (!moves(axis)) continue;
    header += fmt::format(",{}", names.at(axis));
    row += fmt::format(",{:.6f}", axes_of(wanted).at(axis));
  }
  const Filtered result = filtered_table(header + row, correction);
  EXPECT_TRUE(result.summary.complete());
  const Pose target = *correction.target(wanted);
  std::string expected = header + "\na";
  for (std::size_t axis = 0; axis < names.size(); ++axis) {
    if (moves(axis)) expected += fmt::format(",{:.6f}", axes_of(target).at(axis));
  }
  EXPECT_EQ(result.text.substr(0, header.size() + 3), expected.substr(0, header.size() + 3));
  const auto column = [](const std::string& text) { return std::stod(text.substr(text.rfind(',') + 1)); };
  EXPECT_NEAR(column(result.text), column(expected), 1e-5);
  EXPECT_GT(std::abs(column(result.text) - column(row)), 1e-5);
  const std::string without_last = header.substr(0, header.rfind(','));
  EXPECT_THAT([&] { filtered_table(without_last + "\na,0\n", correction); },
              testing::ThrowsMessage<InputFileError>(HasSubstr(header.substr(header.rfind(',') + 1))));
}

TEST_P(AnyRobot, TheSelfTestHasAllTilts) {
  const std::vector<SelfTestCase> cases = self_test(robot, machine);
  EXPECT_EQ(cases.front().pose.position, robot.workspace().centre());
  for (const Eigen::Vector3d& tilt : robot.workspace().tilts()) {
    EXPECT_TRUE(std::ranges::any_of(cases, [&](const SelfTestCase& one) { return one.pose.tilt == tilt; }));
  }
  for (const SelfTestCase& one : cases) EXPECT_EQ(one.joints, inverse(machine, one.pose).joints);
}

// ---- G-code, word by word

class Tilting : public testing::Test {
 protected:
  Filtered of(const std::string& text, const GcodeOptions& options = {}) const {
    return filtered_gcode(text, correction, options);
  }
  /// What a line is to state.
  void expect_words(const std::string& line, const Pose& target) const {
    const ProgramAxes axes = axes_of(target);
    for (std::size_t axis = 0; axis < kLetters.size(); ++axis) {
      const auto stated = word(line, kLetters[axis]);
      ASSERT_TRUE(stated) << line;
      EXPECT_NEAR(*stated, axes.at(axis), axis < 3 ? 0.5001e-4 : 0.5001e-5) << line;
    }
  }
  Pose target(double x, double a, double b, double c) const {
    return *correction.target({{x, 0, 500}, 0.0, {to_radians(a), to_radians(b), to_radians(c)}});
  }

  const std::string kStart = "G0 X0 Y0 Z500 A0 B0 C0\n";
  const Robot robot = test::robot_named("hexapod");
  const TargetCorrection correction{robot, errors_of(robot)};
};

TEST_F(Tilting, TiltsAreWordsAsPlacesAre) {
  const Filtered result = of(kStart + "G91 G1 X5 A2\nG90 G92 A0\nG1 A3 B-1\nG10 L2 P1 X0 Y0 Z0 A1 B0 C0\n");
  EXPECT_TRUE(result.summary.complete());
  const std::vector<std::string> lines = result.lines();
  expect_words(lines[0], target(0, 0, 0, 0));
  EXPECT_NEAR(*word(lines[1], 'A'), to_degrees(target(5, 2, 0, 0).tilt.x() - target(0, 0, 0, 0).tilt.x()), 2e-5);
  EXPECT_NEAR(*word(lines[3], 'A') - *word(lines[2], 'A'),
              to_degrees(target(5, 5, -1, 0).tilt.x() - target(5, 2, 0, 0).tilt.x()), 4e-5);
  EXPECT_NEAR(*word(lines[3], 'B'), to_degrees(target(5, 5, -1, 0).tilt.y()), 2e-5);
  const Filtered inches = of("G20 G0 X0 Y0 Z19.685039370 A0 B0 C4\n");
  EXPECT_NEAR(*word(inches.text, 'C'), to_degrees(target(0, 0, 0, 4).tilt.z()), 1e-5);
}

TEST_F(Tilting, SystemsMayTurn) {
  const std::string systems = "G10 L2 P1 X0 Y0 Z0 A1 B0 C-2\n";
  const Filtered result = of(systems + "G54 G0 X0 Y0 Z500 A0 B0 C0\nG53 G0 X0 Y0 Z500 A0 B0 C0\n");
  EXPECT_TRUE(result.summary.complete());
  EXPECT_THAT(result.summary.assumed, IsEmpty());
  // The frame of the first target is that of the robot: machine coordinates lie elsewhere.
  EXPECT_NEAR(*word(result.lines()[2], 'A'), to_degrees(target(0, -1, 0, 2).tilt.x()) + 1.0, 2e-5);
  const Filtered untold = of("G10 L2 P1 X0 Y0 Z0 A1\nG10 L2 P2 X1 Y0 Z0 A0\nG54" + kStart + "G55 G0 X1\n");
  EXPECT_THAT(untold.summary.assumed, testing::ElementsAre(HasSubstr("B is 0 in coordinate"), HasSubstr("C is 0 in")));
  WorkOffsets offsets;
  offsets.systems[0] = ProgramAxes{};
  offsets.systems[1] = ProgramAxes{0, 0, 0, 2, 0, 0};
  offsets.active = 1;
  const Filtered other = of(kStart + "G55 G0 A0\n", {.offsets = offsets});
  EXPECT_NEAR(*word(other.lines()[1], 'A'), to_degrees(target(0, 2, 0, 0).tilt.x()) - 2.0, 2e-5);
}

TEST_F(Tilting, TiltsThatAreNeverStatedAreZero) {
  const Filtered never = of("G0 X0 Y0 Z500\nG1 X5\n");
  EXPECT_TRUE(never.summary.complete());
  EXPECT_THAT(never.summary.assumed, SizeIs(3));
  expect_words(never.lines()[0], target(0, 0, 0, 0));
  const Filtered late = of("G0 X0 Y0 Z500 A0 C0\nG1 B5\n");
  EXPECT_TRUE(late.has("B is stated after motions for which 0 was assumed"));
  EXPECT_FALSE(late.summary.whole());
  const Pose start{{0, 0, 500}, 0.0, {0.0, to_radians(2.0), 0.0}};
  const Filtered told = of("G1 X5\nB5\n", {.start = start});
  EXPECT_TRUE(told.summary.complete());
  EXPECT_NEAR(*word(told.lines()[0], 'B'), to_degrees(target(5, 0, 2, 0).tilt.y()), 2e-5);
}

TEST_F(Tilting, TheWorkspaceHasTilts) { EXPECT_EQ(of(kStart + "G1 A9.9\nB-10\nC11\n").summary.outside, 1); }

/// X, Y and Z rest in the program; corrected they move, and then F counts along them. The time is the same.
TEST_F(Tilting, FeedsCountAnglesWherePlacesRest) {
  const Filtered result = of(kStart + "G1 A3 B-4 F100\n", {.chord = 0.001});
  EXPECT_TRUE(result.summary.complete());
  double minutes = 0.0, feed = 0.0;
  std::array<double, 3> held{};
  const std::vector<std::string> lines = result.lines();
  ASSERT_GT(lines.size(), 2U);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    std::array<double, 3> at = held;
    for (std::size_t axis = 0; axis < 3; ++axis) at.at(axis) = word(lines[k], kLetters[axis]).value_or(held.at(axis));
    feed = word(lines[k], 'F').value_or(feed);
    if (k > 0) minutes += std::hypot(at[0] - held[0], at[1] - held[1], at[2] - held[2]) / feed;
    held = at;
  }
  EXPECT_NEAR(minutes, std::hypot(3.0, 4.0) / 100.0, 0.02 * 0.05);
}

TEST_F(Tilting, JointLoadsAreThoseOfTheTilt) {
  const TargetCorrection free(robot, errors_of(robot));
  double fastest = 0.0;
  constexpr int kSteps = 400;
  const auto joints = [&](int k) { return *free.joints({{0, 0, 500}, 0.0, {to_radians(6.0 * k / kSteps), 0, 0}}); };
  for (int k = 0; k < kSteps; ++k) {
    fastest = std::max(fastest, kSteps * (joints(k + 1) - joints(k)).cwiseAbs().maxCoeff());
  }
  for (const double share : {0.95, 1.05}) {
    RobotDescription described = robot.description();
    described.joint_limits = {share * fastest, 1e9};
    const TargetCorrection limited(Robot(described), errors_of(robot));
    const Filtered result = filtered_gcode(kStart + "G1 A6 F360\n", limited);  // a second
    EXPECT_EQ(result.summary.over_limit, share < 1.0 ? 1 : 0);
  }
}

/// A controller adds lengths along its Z, wherever the plate points.
TEST_F(Tilting, AToolLengthOnATiltedPlateIsRefused) {
  const auto refusal = [&](const std::string& text, const GcodeOptions& options = {}) {
    try {
      of(text, options);
    } catch (const InputFileError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  const GcodeOptions tools{.tools = ToolTable{{1, {0, 0, 40}}, {2, {}}, {3, {5}}}};
  EXPECT_EQ(
      refusal("G43 H1\n" + kStart + "G1 X5\nG1 A2\n", tools),
      "part.ngc:4: expected motions, arcs, planes, units, offsets, tools and feeds, got a tool length (G43) while "
      "the plate tilts; let the post-processor compute the path of the plate, without G43");
  EXPECT_THAT(refusal("G43 H7\n" + kStart + "G1 B2\n"), HasSubstr("part.ngc:3: "));  // of which nothing is known
  EXPECT_THAT(refusal("G43.1 Z5\n" + kStart + "G1 B2\n"), HasSubstr("part.ngc:3: "));
  EXPECT_THAT(refusal("G43 H3\n" + kStart + "G1 C2\n", tools), HasSubstr("part.ngc:3: "));
  EXPECT_EQ(refusal("G43 H1\n" + kStart + "G1 X5 C3\n", tools), "taken");  // about the tool
  EXPECT_EQ(refusal("G43 H2\n" + kStart + "G1 A2\n", tools), "taken");
  EXPECT_EQ(refusal("G43 H1\n" + kStart + "G49\nG1 A2\n", tools), "taken");
}

// ---- a plate in a plane: what moves along Z is somebody else's

TEST(InAPlane, ZIsLeftAsItStands) {
  const Robot robot = test::robot_named("five-bar");
  const TargetCorrection correction(robot, errors_of(robot));
  const std::string program = "G0 Z5\nG0 X0 Y0\nG1 Z-1 F100\nG1 X0.5 Z-1.5\nG92 Z0\nG43 H1\nG1 X1 A30\nG28 Z\n";
  const Filtered result = filtered_gcode(program, correction, {.origin = {1, 2, 3}});
  EXPECT_TRUE(result.summary.complete());
  EXPECT_EQ(result.summary.corrected, 3);
  const std::vector<std::string> lines = result.lines();
  const Pose target = *correction.target({{1.5, 2, 0}});
  EXPECT_EQ(lines[0], "G0 Z5");
  EXPECT_EQ(lines[2], "G1 Z-1 F100");
  EXPECT_EQ(lines[3], fmt::format("G1 X{:.4f} Y{:.4f} Z-1.5", target.position.x() - 1, target.position.y() - 2));
  EXPECT_EQ(lines[4], "G92 Z0");
  EXPECT_THAT(lines[6], HasSubstr(" A30"));
  EXPECT_EQ(result.summary.farthest.front().wanted.position.z(), 0.0);
  EXPECT_TRUE(filtered_gcode("G0 X0 Y0\nG18 G2 X2 Z0 I1\n", correction).has("an arc in a plane"));
  EXPECT_TRUE(filtered_gcode("G0 X0 Y0\nG2 X2 Y0 Z3 I1\n", correction).has("other axes"));
}

TEST(InAPlane, AToolMayTurnAboutItself) {
  const Robot robot = robot_called("planar_belts");
  const TargetCorrection correction(robot, errors_of(robot));
  EXPECT_TRUE(filtered_gcode("G43 H1\nG0 X0 Y0 C5\n", correction).summary.complete());
}

TEST(InAPlane, ZInATableIsLeft) {
  const Robot robot = test::robot_named("five-bar");
  const TargetCorrection correction(robot, errors_of(robot));
  const Filtered result = filtered_table("z_mm,x_mm,y_mm,phi_deg\n7,1,2,0\n", correction);
  const Pose target = *correction.target({{1, 2, 0}});
  EXPECT_EQ(result.lines()[1], fmt::format("7,{:.4f},{:.4f},0", target.position.x(), target.position.y()));
  EXPECT_TRUE(filtered_table("x_mm,y_mm,phi_deg\n1,2,5\n", correction).has("out of reach"));
}

}  // namespace
}  // namespace paracal::io::any_robot_test
