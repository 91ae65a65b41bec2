// Laws of the filters that correct the targets of a stream.

#include "paracal/filter/target_filter.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <numeric>
#include <random>
#include <sstream>

#include "filtered_program.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::io::target_filter_test {
namespace {

using testing::HasSubstr, testing::IsEmpty, testing::SizeIs;

using test::Filtered, test::filtered_gcode, test::filtered_table, test::lines_in;

/// X, Y, Z and C of a line, as far as they stand there; others from `held`.
std::array<double, 4> axes_in(std::string_view line, std::array<double, 4> held) {
  constexpr std::string_view kLetters = "XYZC";
  for (std::size_t axis = 0; axis < 4; ++axis) {
    const std::size_t at = line.find(kLetters[axis]);
    if (at != std::string_view::npos) held[axis] = std::strtod(line.data() + at + 1, nullptr);
  }
  return held;
}

Pose pose_in(const std::array<double, 4>& axes) { return {{axes[0], axes[1], axes[2]}, to_radians(axes[3])}; }

/// Ordinary programs: straight motions, some axes a line, every mode that does not hinder.
std::string random_program(const Robot& robot, test::Random& random, int lines) {
  std::string text = "%\n(a part)\nN10 G21 G90 G17 G94 ; modes\n";
  constexpr std::string_view kLetters = "XYZC";
  for (int k = 0; k < lines; ++k) {
    const Pose pose = random.pose(robot);
    const std::array values{0.5 * pose.position.x(), 0.5 * pose.position.y(), pose.position.z(),
                            to_degrees(pose.rotation)};
    text += k % 3 == 1 ? "" : fmt::format("N{} G{} ", 20 + k, k % 2);
    for (std::size_t axis = 0; axis < robot.limb_count(); ++axis) {
      if (k > 0 && random.uniform(0, 1) < 0.4) continue;
      fmt::format_to(std::back_inserter(text), "{}{:.{}f} ", kLetters[axis], values[axis], k % 7);
    }
    text += k % 5 == 0 ? "F5000 (fast)\r\n" : "\n";
  }
  return text + "M5\nG4 P0.5\nM2";
}

class TargetFilter : public test::EveryRobot {
 protected:
  test::Random random;
  TargetCorrection none{robot, {}};
  TargetCorrection correction{robot, random.realistic_errors(robot)};
};

TEST_P(TargetFilter, WithoutErrorsNothingChanges) {
  const std::string text = random_program(robot, random, 1000);
  const Filtered result = filtered_gcode(text, none);
  EXPECT_EQ(result.text, text);
  EXPECT_GT(result.summary.corrected, 800);  // some lines state no axis
  EXPECT_THAT(result.summary.passed, IsEmpty());
}

/// The controller computes with the nominal robot and keeps axes that a line does not state.
TEST_P(TargetFilter, TheNominalInverseOfCorrectedTargetsGivesTheJoints) {
  const std::string text = random_program(robot, random, 1000);
  const Filtered result = filtered_gcode(text, correction, {.chord = 0.0});  // no line is divided
  EXPECT_TRUE(result.summary.complete());
  const auto before = lines_in(text), after = lines_in(result.text);
  ASSERT_EQ(before.size(), after.size());
  std::array<double, 4> wanted{}, told{};
  double worst = 0.0;
  for (std::size_t k = 3; k < before.size(); ++k) {
    wanted = axes_in(before[k], wanted);
    told = axes_in(after[k], told);
    const std::optional<Joints> expected = correction.joints(pose_in(wanted));
    ASSERT_TRUE(expected);
    const InverseResult joints = inverse(robot.nominal(), pose_in(told));
    ASSERT_TRUE(joints.ok());
    worst = std::max(worst, (joints.joints - *expected).cwiseAbs().maxCoeff());
  }
  // Four decimals are half of 0.1 um a coordinate; arms of 375 mm and rods of 290 mm feel it in less than 1e-6 rad.
  EXPECT_LT(worst, 1e-6 * test::joint_scale(robot));
  EXPECT_GT(worst, 1e-9);
}

TEST_P(TargetFilter, ThreadsAndPiecesLeaveNoTrace) {
  const std::string text = random_program(robot, random, 40'000);  // more than is read at once
  std::istringstream stream(text);
  std::string one_thread;
  const TextSink sink = [&one_thread](std::string_view piece) { one_thread += piece; };
  EXPECT_TRUE(filter_gcode({"", stream}, sink, correction, {.chord = 1.0, .threads = 1}).complete());
  EXPECT_EQ(one_thread, filtered_gcode(text, correction, {.chord = 1.0}).text);
}

TEST_P(TargetFilter, TablesKeepAllButThePose) {
  const std::string text =
      "# note\r\npose, z_mm,x_mm ,y_mm,speed,phi_deg\n\"a, \"\"b\"\"\",-900.0 ,\t1,\"20.00\",fast, 0\n"
      "\nb,-900,1,20\nc,-900,1,far,slow,0\nd,-9e2,1,+20,,0";
  EXPECT_EQ(filtered_table(text, none).text, text);
  const Filtered result = filtered_table(text, correction);
  EXPECT_EQ(result.summary.corrected, 2);
  EXPECT_EQ(result.passed("fields"), 1);
  EXPECT_EQ(result.passed("number"), 1);
  const Pose target = *correction.target({{1, 20, -900}, 0.0});
  const std::string x = fmt::format("{:.4f}", target.position.x()), y = fmt::format("{:.4f}", target.position.y()),
                    z = fmt::format("{:.4f}", target.position.z()),
                    phi = robot.slide() ? fmt::format("{:.5f}", to_degrees(target.rotation)) : "0";
  EXPECT_EQ(result.text, "# note\r\npose, z_mm,x_mm ,y_mm,speed,phi_deg\n\"a, \"\"b\"\"\"," + z + " ,\t" + x + ",\"" +
                             y + "\",fast, " + phi + "\n\nb,-900,1,20\nc,-900,1,far,slow,0\nd," + z + "," + x + "," +
                             y + ",," + phi);
}

PARACAL_ON_EVERY_ROBOT(TargetFilter);
PARACAL_ON_UNUSUAL_ROBOTS(TargetFilter);

// ---- G-code, word by word; on the robot with a slide, whose lines have all four axes

class Gcode : public testing::Test {
 protected:
  Filtered filtered(const std::string& text, const GcodeOptions& frame = {}) const {
    return filtered_gcode(text, correction, frame);
  }
  /// After lines that correct everything.
  Filtered after_start(const std::string& text) const { return filtered(kStart + text); }

  /// The four words of a corrected target, with blanks between.
  std::string words(const Pose& wanted) const {
    const Pose target = *correction.target(wanted);
    const Eigen::Vector3d& r = target.position;
    return fmt::format("X{:.4f} Y{:.4f} Z{:.4f} C{:.5f}", r.x(), r.y(), r.z(), to_degrees(target.rotation));
  }

  const std::string kStart = "G0 X0 Y0 Z-888 C0\n";
  const Robot robot = catalogue::find("huang2016");
  const TargetCorrection none{robot, {}};
  const TargetCorrection correction{robot, test::table4_machine(robot, 1)};
};

TEST_F(Gcode, MissingAxesFollowTheLastOne) {
  EXPECT_EQ(after_start("G1 X10 F500 (go)\n").text.substr(words({{0, 0, -888}}).size() + 4),
            "G1 " + words({{10, 0, -888}}) + " F500 (go)\n");
  std::string tight = words({{10, 0, -888}});
  std::erase(tight, ' ');
  EXPECT_THAT(after_start("G1X10F500;go\n").text, HasSubstr("\nG1" + tight + "F500;go\n"));
  for (char& c : tight) c = static_cast<char>(std::tolower(c));
  EXPECT_THAT(after_start("g1x10f500\n").text, HasSubstr("\ng1" + tight + "f500\n"));
}

TEST_F(Gcode, InchesAndTheOriginAreFollowed) {
  const Pose target = *correction.target({{25.4, -50.8, -901.7}});
  const std::string expected =
      fmt::format("G20 G1 X{:.6f} Y{:.6f} Z{:.6f} C{:.5f}", target.position.x() / 25.4, target.position.y() / 25.4,
                  (target.position.z() + 901.7) / 25.4, to_degrees(target.rotation));
  EXPECT_EQ(filtered("G20 G1 X1 Y-2 Z0 C0", {.origin = {0, 0, -901.7}}).text, expected);
}

TEST_F(Gcode, DecimalsAreKeptAndNotLost) {
  const std::string text = filtered("G1 X1.123456 Y2 Z-900.1234567891 C0.1234567").text;
  const Pose target = *correction.target({{1.123456, 2, -900.1234567891}, to_radians(0.1234567)});
  EXPECT_EQ(text, fmt::format("G1 X{:.6f} Y{:.4f} Z{:.7f} C{:.7f}", target.position.x(), target.position.y(),
                              target.position.z(), to_degrees(target.rotation)));
}

TEST_F(Gcode, AStatedStartNeedsNoOtherAxis) {
  EXPECT_EQ(filtered("G1 X1\n").passed("is unknown"), 1);
  EXPECT_EQ(filtered("G1 X1\n", {.start = Pose{{0, 0, -900}, 0.0}}).text, "G1 " + words({{1, 0, -900}, 0.0}) + "\n");
}

/// Lines that are left, after a start that is known; and whether X is known again after "X0" in absolute modes.
struct Passed {
  const char* name;
  const char* lines;
  const char* reason;          ///< fragment; empty: nothing is counted
  const char* next;            ///< a line after it
  const char* reason_of_next;  ///< empty: it is corrected
};

class PassedGcode : public Gcode, public testing::WithParamInterface<Passed> {};

TEST_P(PassedGcode, IsLeftAndCounted) {
  const Passed& row = GetParam();
  const Filtered alone = after_start(std::string(row.lines) + "\n");
  EXPECT_TRUE(alone.text.ends_with("\n" + std::string(row.lines) + "\n")) << alone.text;
  EXPECT_EQ(alone.summary.corrected, 1);
  if (*row.reason == '\0') {
    EXPECT_THAT(alone.summary.passed, IsEmpty());
  } else {
    ASSERT_THAT(alone.summary.passed, SizeIs(1));
    EXPECT_THAT(std::string(alone.summary.passed[0].reason), HasSubstr(row.reason));
    EXPECT_GE(alone.summary.passed[0].first_line, 2);
  }
  const Filtered both = after_start(std::string(row.lines) + "\n" + row.next + "\n");
  EXPECT_EQ(both.summary.corrected, *row.reason_of_next == '\0' ? 2 : 1) << both.text;
  if (*row.reason_of_next != '\0') {
    EXPECT_GT(both.passed(row.reason_of_next), *row.reason_of_next == *row.reason ? 1 : 0);
  }
}

constexpr const char* kAll = "G1 X1 Y2 Z-900 C3";

INSTANTIATE_TEST_SUITE_P(
    Lines, PassedGcode,
    testing::Values(
        Passed{"incremental_alone", "G91", "", "G90 G1 X1", ""},
        Passed{"incremental_from_nowhere", "G28\nG91 G1 X1", "incremental", "G90 Y1", "X is unknown"},
        Passed{"arc_from_nowhere", "G28\nG2 X5 Y5 Z-900 I1 J2 C0", "from an unknown position", "G1 Z-900", ""},
        Passed{"arc_not_reached", "G2 X5 Y5 I1 J2", "does not reach", "G1 Z-900", ""},
        Passed{"arc_without_centre", "G2 X5 Y5", "without a centre", "G1 Z-900", ""},
        Passed{"arc_of_another_plane", "G2 X5 Y5 K5", "without a centre", "G1 Z-900", ""},
        Passed{"arc_with_a_centre_off_its_plane", "G2 X5 Y5 I2.5 J2.5 K5", "without a centre", "G1 Z-900", ""},
        Passed{"arc_with_both", "G2 X5 Y5 I5 R5", "a centre and a radius", "G1 Z-900", ""},
        Passed{"arc_half_a_turn", "G2 X5 Y5 R5 P1.5", "turns", "G1 Z-900", ""},
        Passed{"arc_in_no_plane", "G17.1 G2 X5 Y5 R5", "whose plane", "G1 Z-900", ""},
        Passed{"arc_too_fine", "G2 X5 Y5 R6 P1000", "pieces", "G1 Z-900", ""},
        Passed{"arc_with_another_axis", "G2 X5 Y5 A5 R6", "other axes", "G1 Z-900", ""},
        Passed{"arc_with_extrusion", "G2 X5 Y5 R6 E2", "M82", "G1 Z-900", ""},
        Passed{"arc_out_of_reach", "G2 X2000 Y0 R1000", "out of reach", "G1 X0 Z-900", ""},
        Passed{"machine_coordinates", "G53 G0 Z0", "another origin", "G0 X1", "is unknown"},
        Passed{"machine_coordinates_recover", "G53 G0 Z0", "another origin", "G0 Z-900", ""},
        Passed{"other_system", "G55", "", kAll, "another origin"},
        Passed{"other_system_and_back", "G55\nG54", "", kAll, "another origin"},
        Passed{"power_on_system_is_not_g54", "G54", "", kAll, "another origin"},
        Passed{"shift_of_a_lost_place", "G28\nG92 X0", "", kAll, "another origin"},
        Passed{"shift_local", "G52 X1 Y2", "", kAll, "another origin"},
        Passed{"shift_table", "G10 L2 P1 X5", "", kAll, "another origin"}, Passed{"retraction", "G10", "", "G1 X1", ""},
        Passed{"extruder_zero", "G92 E0", "", "G1 X1", ""}, Passed{"tool_length", "G43 H1", "", kAll, "another tool"},
        Passed{"tool_length_by_axes", "G43.1 Z5", "", "G1 X1 Z-905", ""},
        Passed{"no_tool_length", "G49", "", "G1 X1", ""}, Passed{"no_cutter_radius", "G40", "", "G1 X1", ""},
        Passed{"nothing_ends", "G15 G50 G69 G8", "", "G1 X1", ""},
        Passed{"probe", "G38.2 Z-910 F10", "probing", "G1 X1", "is unknown"},
        Passed{"homing", "G28", "", "G1 X1", "is unknown"}, Passed{"homing_flags", "G28 X Y", "", kAll, ""},
        Passed{"homing_over", "G28 Z-800", "homing", kAll, ""}, Passed{"dwell_in_x", "G4 X2.5", "", "Y1", ""},
        Passed{"m_code", "M600 X80", "M code", "G1 Y1", "is unknown"},
        Passed{"steps_per_mm", "M92 X80", "", "G1 Y1", ""}, Passed{"jerk", "M205 X8.00 Y8 Z0.4 E5", "", "G1 Y1", ""},
        Passed{"currents", "M906 X800 Y800", "", "X1", ""}, Passed{"object", "M486 Acube.stl", "", "X1", ""},
        Passed{"progress", "M73 P12 R34", "", "X1", ""},
        Passed{"modes_are_restored", "M73", "", kAll, "whose mode is unknown"},
        Passed{"klipper_setting", "SET_VELOCITY_LIMIT ACCEL=3000", "", "G1 X1", ""},
        Passed{"klipper_object", "exclude_object_start NAME=cube_1", "", "X1", ""},
        Passed{"klipper_shape", "EXCLUDE_OBJECT_DEFINE NAME=a CENTER=1,2 POLYGON=[[0,0],[1,0]]", "", "X1", ""},
        Passed{"klipper_alone", "RESPOND", "", "X1", ""},
        Passed{"klipper_macro", "SET_VELOCITY_LIMITS_OF_MINE", "a macro", kAll, "whose mode is unknown"},
        Passed{"klipper_motion", "PROBE_CALIBRATE", "a macro", kAll, "whose mode is unknown"},
        Passed{"m_code_beside", "M3 S1000", "", "X1", ""}, Passed{"tool_change", "T2 M6", "", "G1 X1", "is unknown"},
        Passed{"tool_change_of_a_prepared_tool", "M6", "", "G1 X1", "is unknown"},
        Passed{"tool_alone", "T2", "", "G1 X1", "is unknown"},
        Passed{"home_offsets", "M206 X5", "M code", kAll, "another origin"},
        Passed{"tool_offsets", "M218 T1 X5", "M code", kAll, "another origin"},
        Passed{"home_offsets_from_here", "M428", "", kAll, "another origin"},
        Passed{"end", "M30", "", kAll, "whose mode is unknown"},
        Passed{"block_delete", "/G1 X1", "block delete", kAll, "whose mode is unknown"},
        Passed{"block_delete_of_origin", "/G55\nG54 G90 G21", "", kAll, "another origin"},
        Passed{"block_delete_of_comment", "/ (nothing)", "", "G1 X1", ""},
        Passed{"twice", "G1 X1 X2", "not a G-code block", kAll, "whose mode is unknown"},
        Passed{"two_motions", "G0 G1 X1", "not a G-code block", kAll, "whose mode is unknown"},
        Passed{"pause_with_text", "M0 Turn ON spindle", "", "G1 X1", ""},
        Passed{"pause_with_numbers_and_text", "M1 S5 P2 change tool", "", "G1 X1", ""},
        Passed{"homing_of_mach3", "G28.1 Z5.00", "homing", "G1 X1", "is unknown"},
        Passed{"second_homing_of_mach3", "G1 G30.1 Z5.00", "homing", "G1 X1", "is unknown"},
        Passed{"stored_place", "G28.1\nG30.1", "", "G1 X1", ""},
        Passed{"checksum", "N5 G1 X1*71", "remove checksums", kAll, "whose mode is unknown"},
        Passed{"no_number", "G1 X-", "not a G-code block", kAll, "whose mode is unknown"},
        Passed{"split_number", "G1 X1. 2", "not a G-code block", kAll, "whose mode is unknown"},
        Passed{"open_comment", "G1 (X1", "not a G-code block", kAll, "whose mode is unknown"},
        Passed{"no_code", "hello, there!", "not a G-code block", kAll, "whose mode is unknown"},
        Passed{"message", "M117 it's X1 (!", "", "G1 X1", ""}, Passed{"comment", "; X1 Y2", "", "G1 X1", ""},
        Passed{"quoted", "M291 P\"X1 (Y2\" R\"it\" S1", "", "G1 X1", ""},
        Passed{"comment_with_expressions", "(#3 [1] O100 call G81)", "", "G1 X1", ""},
        Passed{"no_motion_mode", "G80", "", "X1", "whose mode is unknown"},
        Passed{"inch_and_mm_of_mach3", "G70\nG71", "", "X1", ""},
        Passed{"out_of_reach", "G1 X4000", "out of reach", "G1 X1", ""},
        Passed{"extruder", "G1 E5 F100", "", "G1 X1", ""}),
    [](const auto& one) { return std::string(one.param.name); });

/// What a filter may not rewrite refuses the program wherever it stands, with its line and what to do.
TEST_F(Gcode, WhatNoFilterMayRewriteRefusesTheProgram) {
  const std::string expand = "expand it in the post-processor, or use the LinuxCNC component (--target linuxcnc)",
                    computed = "let the post-processor compute the path",
                    before = "set the offset before the program runs";
  const auto refusal = [&](const std::string& line, GcodeDialect dialect = GcodeDialect::any) {
    try {
      filtered("G90 G21\n" + line + "\n", {.dialect = dialect});
    } catch (const InputFileError& error) {
      EXPECT_EQ(error.line(), 2) << line;
      return std::string(error.what());
    }
    return "taken: " + line;
  };
  for (const char* line : {"o100 call",
                           "O<name> sub",
                           "O1 if [#1 GT 2]",
                           "#1 = 5",
                           "G1 X#1",
                           "G1 X[1+2]",
                           "G1 X-[2]",
                           "G1 X{move.axes[0].machinePosition}",
                           "IF [#1 EQ 2] GOTO 10",
                           "WHILE [#1 LT 3] DO1",
                           "var a = 3",
                           "/G1 X#1",
                           "G81 X1 Z-2 R1",
                           "G83 X1 Z-2 R1 Q1",
                           "G73 X1 Z-2 R1 Q1",
                           "G89 X1",
                           "G71 P1 Q2",
                           "M98 P1000",
                           "M99",
                           "M97 P5",
                           "/M98 P1"}) {
    EXPECT_THAT(refusal(line), HasSubstr(expand)) << line;
  }
  for (const char* line : {"G41 D1", "G42", "G68 X0 Y0 R30", "G51 P2", "G51.1 X0", "G16", "G7", "G5 X5 Y5 I1 P1 Q1",
                           "G65 P100", "G44 H1", "G43.2 H2", "/G68 R3"}) {
    EXPECT_THAT(refusal(line), HasSubstr(computed)) << line;
  }
  for (const char* line : {"G10 L2 P1 X10 R90", "G10 L20 P1 X0", "G10 L10 P1 Z5", "G10 L11 P1 Z5", "G10 L1 P1 Z5",
                           "G10 L2 P10 X0", "G10 L2 P1.5 X0", "G10 L2 X0", "G10 P1 X5", "G91 G10 L2 P1 X5"}) {
    EXPECT_THAT(refusal(line), HasSubstr(before)) << line;
  }
  EXPECT_THAT(refusal("G187 P1"), HasSubstr("--harmless"));
  EXPECT_THAT(refusal("G43 H0"), HasSubstr("--tools"));
  EXPECT_THAT(refusal("G0 X5 H2"), HasSubstr("G43"));
  EXPECT_TRUE(filtered(kStart + "G187 P1\nG1 X1\n", {.harmless = {"G187"}}).summary.complete());
  for (const auto& [line, language] : {std::pair{"&ACCESS RVP", "KUKA's KRL"},
                                       {"DEF part( )", "KUKA's KRL"},
                                       {"PTP {A1 0}", "KUKA's KRL"},
                                       {"LIN {X 1}", "KUKA's KRL"},
                                       {"MODULE Part", "ABB's RAPID"},
                                       {"  MoveL p10,v100,z1,tool0;", "ABB's RAPID"},
                                       {"0 BEGIN PGM PART MM", "Heidenhain's plain language"},
                                       {"3 TOOL CALL 1 Z S2000", "Heidenhain's plain language"}}) {
    EXPECT_THAT(refusal(line), HasSubstr(std::string("expected G-code, got ") + language)) << line;
  }
}

/// Words whose number a motion, a feed or a dwell needs; letters alone of other codes are theirs.
TEST_F(Gcode, WordsWithoutANumberAreRefused) {
  const auto refusal = [&](const std::string& line) {
    try {
      return filtered(kStart + line + "\n").summary.complete() ? "taken: " + line : "left: " + line;
    } catch (const InputFileError& error) {
      EXPECT_EQ(error.line(), 2) << line;
      return std::string(error.what());
    }
  };
  for (const auto& [line, letter] : {std::pair{"G1 X1 Fnan", "F"},
                                     {"G1 X1 Finf", "F"},
                                     {"G1 X3 F1e1000", "F"},
                                     {"G1 X4 F", "F"},
                                     {"F", "F"},
                                     {"g1 x1 f1E3", "F"},
                                     {"G1 X", "X"},
                                     {"G1 Xnan Y1", "X"},
                                     {"G0 X1 C", "C"},
                                     {"X", "X"},
                                     {"G2 X5 I", "I"},
                                     {"G3 X5 R", "R"},
                                     {"G1 X1 S", "S"},
                                     {"M3 S", "S"},
                                     {"G4 Pnan", "P"},
                                     {"G4 P", "P"},
                                     {"G4 X", "X"},
                                     {"/G1 X1 F", "F"},
                                     {"G38.2 Z", "Z"},
                                     {"G1 X\"5\"", "X"}}) {
    EXPECT_THAT(refusal(line), HasSubstr(std::string("got ") + letter + " without a finite number")) << line;
  }
  for (const char* good : {"G1 X1 F1", "G1X1E5F100\nG1X2F100E6", "M204 P T", "M106 S", "G4 P1", "G92 E0", "M18 X Y"}) {
    EXPECT_EQ(refusal(good), std::string("taken: ") + good);
  }
  EXPECT_EQ(refusal("G28 X"), "taken: G28 X");
}

/// Beside codes without motion axis words may be a motion or the code's, except where LinuxCNC's manual says so.
TEST_F(Gcode, AxisWordsBesideCodesWithoutMotionBelongToTheCode) {
  for (const char* line : {"G92.1 X0", "G92.2 X1", "G92.3 Z1", "G50 X0 Z0", "G50.1 X0", "/G92.1 X5"}) {
    EXPECT_THAT([&] { filtered(kStart + line + "\n"); },
                testing::ThrowsMessage<InputFileError>(HasSubstr("got axis words beside a code without motion")))
        << line;
  }
  const Filtered moved = filtered(kStart + "G1 X5\nG28.1 X7\nX9\n", {.dialect = GcodeDialect::linuxcnc});
  EXPECT_EQ(moved.summary.corrected, 4);
  for (const char* modal : {"G54 X5", "G4 P0.5 X5", "G90 X5", "G17 X5", "G40 X5", "G61 X5", "G94 X5"}) {
    EXPECT_EQ(filtered("G54\n" + kStart + "G1 X1\n" + modal + "\n").summary.corrected, 3) << modal;
  }
}

/// LinuxCNC keeps numbers of G43.1 across G20 and G21, not lengths.
TEST_F(Gcode, AToolLengthIsStatedInItsUnit) {
  const auto corrected = [&](const std::string& lines) {
    return filtered(kStart + lines, {.dialect = GcodeDialect::linuxcnc}).summary.corrected;
  };
  const std::string set = "G43.1 X3 Z5\nG1 X10\n";
  for (const char* other : {"G20\nG43.1 Z-0.25\n", "G20 G43.1 X0.5\n", "G20\nG21\nG20 G43.1 X1\n"}) {
    EXPECT_THAT([&] { corrected(set + other); },
                testing::ThrowsMessage<InputFileError>(HasSubstr("keeps an axis from before a change of unit")))
        << other;
  }
  EXPECT_EQ(corrected(set + "G43.1 Z-0.25\nG1 X5\n"), 3);
  EXPECT_EQ(corrected(set + "G20\nG21\nG43.1 Z-0.25\nG1 X5\n"), 3);
  EXPECT_EQ(corrected(set + "G20\nG43.1 X0.1 Z-0.25\nG1 X0.5\n"), 3);
  EXPECT_EQ(corrected(set + "G49\nG20\nG43.1 Z-0.25\nG1 X0.5\n"), 3);
}

TEST_F(Gcode, ANameIsNoSubprogram) {
  EXPECT_TRUE(filtered("%\nO1001 (part)\n" + kStart + "G1 X1\n%\n").summary.complete());
  EXPECT_TRUE(filtered("N1 O1001\n" + kStart).summary.complete());
  EXPECT_THROW(filtered(kStart + "O1002\n"), InputFileError);
}

/// What is left between corrected targets is told apart from approach and retreat.
TEST_F(Gcode, WhatIsLeftBetweenTargetsIsNotWhole) {
  const auto summary_of = [&](const std::string& text) { return filtered_gcode(text, correction).summary; };
  const std::string target = "G1 X1 Y2 Z-900 C3\n", arc = "G2 X5 Y5\n", home = "G28\nG1 Z-880\n";
  const FilterSummary around = summary_of(home + target + target + home);
  EXPECT_FALSE(around.complete());
  EXPECT_TRUE(around.whole());
  const FilterSummary between =
      summary_of(home + target + arc + "G1 Z-901\n" + arc + arc + target + "G28\nG91 G1 Z5\n");
  EXPECT_FALSE(between.whole());
  ASSERT_THAT(between.passed, SizeIs(3));
  EXPECT_THAT(std::string(between.passed[0].reason), testing::StartsWith("X is unknown: state it"));
  EXPECT_EQ(between.passed[0].between, 0);
  EXPECT_THAT(std::string(between.passed[1].reason), HasSubstr("without a centre"));
  EXPECT_EQ(between.passed[1].count, 3);
  EXPECT_EQ(between.passed[1].between, 3);
  EXPECT_EQ(between.passed[1].first_between, 4);
  EXPECT_EQ(between.passed[2].between, 0);
  EXPECT_EQ(summary_of(target + "G1 X3 M204\n").corrected, 2);  // a motion stays one beside a setting
  // A target out of reach is left, too; many lines are read in pieces.
  EXPECT_TRUE(summary_of(target + "G0 X4000\n").whole());
  EXPECT_FALSE(summary_of(target + "G0 X4000\n" + target).whole());
  std::string many = target;
  for (int k = 0; k < 30000; ++k) many += fmt::format("G1 X{} Y0 Z-900 C0 (long enough to be read apart)\n", k % 50);
  EXPECT_TRUE(summary_of(home + many + home).whole());
  const FilterSummary apart = summary_of(many + arc + many);
  ASSERT_THAT(apart.passed, SizeIs(1));
  EXPECT_EQ(apart.passed[0].between, 1);
  EXPECT_EQ(apart.passed[0].first_between, 30002);
}

/// Before the first corrected target and after the last a program may come and go, not work.
TEST_F(Gcode, WorkIsNoRetreat) {
  const auto is_whole = [&](const std::string& before, const std::string& after) {
    const FilterSummary summary = filtered_gcode(before + "G0 X1 Y2 Z-900 C3\n" + after, correction).summary;
    EXPECT_EQ(summary.corrected, 1) << before << after;
    EXPECT_FALSE(summary.complete()) << before << after;
    return summary.whole();
  };
  const std::string lost = "T1 M6\n";  // then no axis is known
  for (const char* harmless : {"G0 X5 Y5", "G1 Z-800", "G1 Z-800 E-2", "G28 X0 Y0 Z-800", "G38.2 Z-950 F10",
                               "END_PRINT", "M600 X80", "/G0 X5"}) {
    EXPECT_TRUE(is_whole("", lost + harmless + "\n")) << harmless;
    EXPECT_TRUE(is_whole(std::string(harmless) + "\nG90 G21 G80\n", "")) << harmless;
  }
  for (const char* work : {"G1 X5", "G1 Y5 F100", "G1 C5", "G0 X5 E3", "X5 Y5", "G2 I5", "G2 Z-910 I5", "G33 Z-910 K1",
                           "/G1 X5", "/G2 I5", "/X5", "G1 X5 X6", "G1 X5 Y6*1", "hello, there!"}) {
    EXPECT_FALSE(is_whole("", lost + "G80\n" + work + "\n")) << work;
    EXPECT_FALSE(is_whole("G80\n" + std::string(work) + "\nG90 G21 G80 G91.1 G94\n", "")) << work;
  }
  // What leads to the work counts with it.
  const FilterSummary led = filtered_gcode(kStart + "M6\nG0 X5\nG1 Z-890\nG1 Y6\nG0 Z-800\n", correction).summary;
  ASSERT_THAT(led.passed, SizeIs(2));
  EXPECT_EQ(led.passed[0].between + led.passed[1].between, 2);  // not the rapid
  EXPECT_EQ(led.passed[0].first_between + led.passed[1].first_between, 4 + 5);
}

/// Whatever made an axis unknown, the answer names the axis and says what to do.
TEST_F(Gcode, AnUnknownAxisIsNamed) {
  const auto reason_behind = [&](const std::string& lines) {
    const Filtered result = after_start(lines + "\nG1 X5 Z-900 C0\n");
    return result.summary.passed.empty() ? std::string() : std::string(result.summary.passed.back().reason);
  };
  for (const char* cause : {"T1", "M6", "G28", "MY_MACRO\nG90 G21", "M600 Y5", "M84"}) {
    EXPECT_THAT(reason_behind(cause), testing::StartsWith("Y is unknown: state it")) << cause;
  }
  EXPECT_THAT(reason_behind("G92.3"), testing::StartsWith("another origin"));
  EXPECT_THAT(std::string(filtered("G1 X5\n").summary.passed.at(0).reason), HasSubstr("--start=X,Y,Z"));
  EXPECT_THAT(std::string(filtered("G0 Z-900\nG43 H1\nG1 X5 Y0 C0\n").summary.passed.back().reason),
              testing::AllOf(testing::StartsWith("Z is unknown"), HasSubstr("--tools")));
}

/// Motors are switched off with the letters of axes at the end of a print.
TEST_F(Gcode, MotorsThatAreOffHoldNoPlace) {
  for (const char* off : {"M84 X Y E", "M18 X", "M84"}) {
    EXPECT_TRUE(after_start(std::string(off) + "\n").summary.complete()) << off;
    EXPECT_EQ(after_start(std::string(off) + "\nG1 X1\n").summary.corrected, 1) << off;
  }
  EXPECT_EQ(after_start("M17 X Y\nG1 X1\n").summary.corrected, 2);
}

/// A start is told in the coordinates of the program, which begin in the system that it names before its first motion.
TEST_F(Gcode, AStartIsOfTheSystemThatTheProgramNames) {
  const GcodeOptions frame{.start = Pose{{0, 0, -900}, 0.0}};
  EXPECT_TRUE(filtered("G55\nG1 X1\n", frame).summary.complete());
  EXPECT_EQ(filtered("G55\nG54\nG1 X1\n", frame).passed("is unknown"), 1);
  EXPECT_EQ(filtered("G1 X1\nG55\nG1 X2\n", frame).passed("another origin"), 1);
  EXPECT_EQ(filtered("G55\n" + kStart + "G55\nG1 X1\n").summary.corrected, 2);  // the same again changes nothing
}

/// Without lengths the origin is that of the first tool, and another tool's is not known; X and Y are.
TEST_F(Gcode, ToolsHaveTheLengthsOfTheirTable) {
  EXPECT_EQ(filtered("G43 H1\n" + kStart + "G49\n" + kStart).passed("another tool"), 1);
  EXPECT_EQ(filtered("G49\n" + kStart + "G49\nG1 X1\n").summary.corrected, 2);
  const Filtered given = filtered("G0 X0 Y0 C0\nT1 M6\nG43 H1\nG0 X0 Y0 C0\nZ-900\nG49\nG43 H1\nX1\n");
  EXPECT_EQ(given.summary.corrected, 2);
  EXPECT_TRUE(given.summary.whole());
  EXPECT_THAT(given.summary.assumed, testing::Contains(HasSubstr("give lengths with --tools")));
  EXPECT_EQ(filtered("T1 M6\nG43\n" + kStart + "T2 M6\nG43\n" + kStart).passed("another tool"), 1);
  const GcodeOptions two{.tools = ToolTable{{1, {0, 0, 50, 0}}, {2, {1, 0, 30, 0}}}};
  const Filtered both = filtered("T1 M6\nG43\nG0 X0 Y0 Z-950 C0\nT2 M6\nG43 H2\nG0 X0 Y0 Z-950 C0\nG49\nZ-940\n", two);
  EXPECT_TRUE(both.summary.complete());
  ASSERT_THAT(both.lines(), SizeIs(8));
  const auto z_of = [](const Pose& told, double shift) { return testing::DoubleNear(told.position.z() - shift, 1e-4); };
  EXPECT_THAT(*test::word(both.lines()[2], 'Z'), z_of(*correction.target({{0, 0, -900}, 0.0}), 50));
  EXPECT_THAT(*test::word(both.lines()[5], 'Z'), z_of(*correction.target({{1, 0, -920}, 0.0}), 30));
  EXPECT_THAT(*test::word(both.lines()[7], 'Z'), z_of(*correction.target({{1, 0, -940}, 0.0}), 0));
  EXPECT_THAT(both.summary.assumed, testing::Contains(HasSubstr("a tool of length 0")));
  EXPECT_THAT([&] { filtered("G43 H3\n" + kStart, two); },
              testing::ThrowsMessage<InputFileError>(HasSubstr("that --tools does not list")));

  const ToolTable tools = read_tool_table({"tool.tbl", "; mine\nT1 P1 X0 Y0 Z+50.2 D6 ;mill\n\nT12 P3 Z-3 C1\n"});
  EXPECT_EQ(tools, (ToolTable{{1, {0, 0, 50.2, 0}}, {12, {0, 0, -3, 0, 0, 1}}}));
  for (const char* bad : {"P1 Z5\n", "T1 Z\n", "T1.5 Z5\n", "tool 1\n", "T1 Z5\nT1 Z6\n", "; none\n", "T1 G5\n"}) {
    EXPECT_THROW(read_tool_table({"tool.tbl", bad}), InputFileError) << bad;
  }
}

/// Speed and acceleration against differences of the joints that a controller takes along the block, many times finer:
/// a limit a tenth below them is exceeded, one a tenth above is not.
TEST_F(Gcode, JointLoadsAreThoseAlongTheBlock) {
  constexpr int kSteps = 400;
  const double seconds = std::hypot(300.0, 300.0) / 400.0, per_step = kSteps / seconds;
  std::vector<Joints> joints;
  for (int k = 0; k <= kSteps; ++k) {
    const double t = static_cast<double>(k) / kSteps;
    joints.push_back(*correction.joints({{-150 + 300 * t, 150 - 300 * t, -888}, to_radians(30 * t)}));
  }
  double speed = 0.0, acceleration = 0.0;
  for (std::size_t k = 1; k < kSteps; ++k) {
    speed = std::max(speed, (joints[k + 1] - joints[k]).cwiseAbs().maxCoeff() * per_step);
    const Joints change = joints[k + 1] - 2.0 * joints[k] + joints[k - 1];
    acceleration = std::max(acceleration, change.cwiseAbs().maxCoeff() * per_step * per_step);
  }
  const auto over = [&](double of_speed, double of_acceleration) {
    RobotDescription described = robot.description();
    described.joint_limits = {of_speed * speed, of_acceleration * acceleration};
    const TargetCorrection limited{Robot(described), test::table4_machine(robot, 1)};
    const std::string program = "G0 X-150 Y150 Z-888 C0\nG1 X150 Y-150 C30 F24000\nG0 X0\nG93 G1 Y0 F60\n";
    return filtered_gcode(program, limited).summary;
  };
  for (const FilterSummary& slow : {over(0.9, 10.0), over(10.0, 0.85)}) {
    EXPECT_EQ(slow.over_limit, 1);  // no rapid; G93 takes a second
    EXPECT_EQ(slow.first_over_limit, 2);
  }
  EXPECT_EQ(over(1.1, 1.15).over_limit, 0);
}

TEST_F(Gcode, HarmlessWordsAreOneALine) {
  EXPECT_THAT(read_harmless_words({"words.txt", "# ours\nsnap # a photo\n\nM905\nG187\n"}),
              testing::ElementsAre("SNAP", "M905", "G187"));
  for (const char* bad : {"SNAP NOW\n", "G1\n", "G92\n", "G68\n"}) {
    EXPECT_THROW(read_harmless_words({"words.txt", bad}), InputFileError) << bad;
  }
}

TEST_F(Gcode, TheFirstSystemIsTheOrigins) {
  EXPECT_TRUE(filtered("G55 G92 X0 Y0 Z0\n" + kStart + "G1 X1\n").summary.complete());
  EXPECT_EQ(filtered("G54\n" + kStart + "G55\n" + kStart + "G54\n" + kStart).summary.corrected, 2);
}

/// After a line out of reach the controller holds what that line said, not what it was corrected to before.
TEST_F(Gcode, ALineOutOfReachIsToldAsItStands) {
  const std::string home = words({{0, 0, -888}});
  const std::string x = home.substr(0, home.find(' '));
  EXPECT_EQ(after_start("G1 X4000\nG1 X0\n").text, "G0 " + home + "\nG1 X4000\nG1 " + x + "\n");
  EXPECT_EQ(after_start("G91 G1 X4000\nG1 X-4000\n").text, "G0 " + home + "\nG91 G1 X4000\nG1 X-4000\n");
}

/// A file that never ends is refused, as tables are.
TEST_F(Gcode, LinesHaveALength) {
  const std::string longest = "(" + std::string(64 * 1024 - 3, 'x') + ")\n";
  EXPECT_EQ(filtered(kStart + longest + kAll + "\n").summary.lines, 3);
  EXPECT_THAT([&] { filtered(kStart + "(" + longest + kAll + "\n"); },
              testing::ThrowsMessage<InputFileError>(HasSubstr(":2: expected lines of at most 64 KiB, got a longer")));
}

// ---- anything at all

/// Bytes as they may come, with words of G-code and of tables among them.
std::string random_bytes(std::mt19937& engine, std::size_t size) {
  constexpr std::array<std::string_view, 24> kWords{"G1 ",
                                                    "X1.5",
                                                    "Y-2 ",
                                                    "Z-900",
                                                    "C3",
                                                    "\n",
                                                    "\r\n",
                                                    "G90",
                                                    "G21",
                                                    "(",
                                                    ")",
                                                    ";",
                                                    "*12",
                                                    "#1",
                                                    "[",
                                                    "]",
                                                    ",",
                                                    "\"",
                                                    "x_mm",
                                                    "y_mm,",
                                                    "z_mm",
                                                    "phi_deg",
                                                    "\nG1 X1 Y2 Z-900 C0\n",
                                                    "G91"};
  std::string text;
  while (text.size() < size) {
    if (engine() % 4 == 0) {
      text += static_cast<char>(engine());
    } else {
      text += kWords[engine() % kWords.size()];
    }
  }
  return text;
}

/// A line without the digits and signs of its numbers.
std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+'; });
  return text;
}

TEST_F(Gcode, RandomBytesPassThrough) {
  std::mt19937 engine(7);
  int refused = 0;
  for (int k = 0; k < 2000; ++k) {
    const std::string text = random_bytes(engine, engine() % 300);
    Filtered result;
    try {
      EXPECT_EQ(filtered_gcode(text, none).text, text);
      result = filtered(text);
    } catch (const InputFileError& error) {
      EXPECT_GT(error.line(), 0);
      ++refused;
      continue;
    }
    EXPECT_EQ(std::ranges::count(result.text, '\n'), std::ranges::count(text, '\n'));
    const std::int64_t lines = std::ranges::count(text, '\n') + (text.empty() || text.ends_with('\n') ? 0 : 1);
    EXPECT_EQ(result.summary.lines, lines);
    EXPECT_TRUE(result.summary.corrected > 0 || result.text == text) << text;
  }
  EXPECT_LT(refused, 1500);
}

TEST_F(Gcode, RandomTablesPassThrough) {
  std::mt19937 engine(8);
  for (int k = 0; k < 2000; ++k) {
    const std::string text = "x_mm,y_mm,z_mm,phi_deg,name\n1,2,-900,3,a\n" + random_bytes(engine, engine() % 300);
    EXPECT_EQ(filtered_table(text, none).text, text);
    const Filtered result = filtered_table(text, correction);
    EXPECT_GE(result.summary.corrected, 1);
    EXPECT_EQ(std::ranges::count(result.text, '\n'), std::ranges::count(text, '\n'));
    EXPECT_EQ(without_numbers(result.text), without_numbers(text));
  }
}

TEST_F(Gcode, NumbersThatNoProgramHasAreRefusedWithTheirLine) {
  const auto refused = [&](const std::string& line, const std::string& message) {
    EXPECT_THAT([&] { filtered("G21 G90\n" + line + "\n"); },
                testing::ThrowsMessage<InputFileError>(testing::StartsWith("part.ngc:2: " + message)));
  };
  refused("G1 X10 F-5", "expected F from 0 to 1e+07 (no drive is outside), got -5");
  refused("G1 X100000000 F500", "expected X from -1e+07 to 1e+07, got 1e+08");
  refused("G1 X1 C-100000000", "expected C from -1e+07 to 1e+07, got -1e+08");
  for (const char* good : {"G1 X1 F0", "N100000000 G1 X1 F500", "M950 F-1"}) {
    EXPECT_NO_THROW(filtered("G21 G90\n" + std::string(good) + "\n")) << good;
  }
}

// ---- tables

TEST_F(Gcode, TablesWithoutAPoseAreRefused) {
  const auto refused = [&](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { filtered_table(text, correction); }, testing::ThrowsMessage<InputFileError>(HasSubstr(message)));
  };
  refused("# only a comment\n", "targets.csv: expected a header line");
  refused("# c\nx_mm,y_mm,phi_deg\n", "targets.csv:2: expected a column \"z_mm\"");
  refused("x_mm,y_mm,z_mm\n1,2,3\n", "targets.csv:1: expected a column \"phi_deg\"");
  refused("x_mm,y_mm,z_mm,phi_deg,x_mm\n", "\"x_mm\" twice");
  refused("x_mm,\"y_mm\n", "targets.csv:1: expected closed quotation marks");
}

TEST_F(Gcode, TheCommandedColumnsCount) {
  const std::string text = "x_mm,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg\n7,1,2,-900,0\n";
  std::string row = words({{1, 2, -900}, 0.0});
  std::erase_if(row, [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; });
  std::ranges::replace(row, ' ', ',');
  EXPECT_EQ(filtered_table(text, correction).text, text.substr(0, text.find('\n')) + "\n7," + row + "\n");
}

}  // namespace
}  // namespace paracal::io::target_filter_test
