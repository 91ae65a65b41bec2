// What lines of a program become: chords, pieces, declarations of a place; and what is said of them.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "filtered_program.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/forward.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/units.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"

namespace paracal::io::gcode_lines_test {
namespace {

using testing::Contains, testing::ElementsAre, testing::HasSubstr, testing::IsEmpty, testing::Not, testing::SizeIs,
    testing::StartsWith;

using test::Filtered, test::filtered_gcode, test::word;

class GcodeLines : public testing::Test {
 protected:
  Filtered of(const std::string& text, const GcodeOptions& options = {}) const {
    return filtered_gcode(text, correction, options);
  }
  Pose target(double x, double y, double z, double phi_deg = 0.0) const {
    return *correction.target({{x, y, z}, to_radians(phi_deg)});
  }

  const Robot robot = catalogue::find("rotary_delta");
  const TargetCorrection none{robot, {}};
  const TargetCorrection correction{robot, test::table4_machine(robot, 1)};
};

/// chords = sweep / (2 acos(1 - 0.9 chord / r)), rounded up.
TEST_F(GcodeLines, ArcsBecomeAsManyChordsAsTheirSagittaAsks) {
  const std::string circle = "G0 X50 Y0 Z-900\nG3 I-50 (a circle) F500 ; all of it\nG1 X0\n";
  for (const double chord : {0.001, 0.01, 1.0}) {
    const Filtered result = of(circle, {.chord = chord});
    const double count = std::ceil(2 * std::acos(-1.0) / (2 * std::acos(1 - 0.9 * chord / 50)));
    EXPECT_EQ(result.summary.added, static_cast<int>(count) - 1);
    EXPECT_EQ(result.summary.corrected, 3);
    EXPECT_TRUE(result.summary.complete());
  }
  const auto lines = of(circle).lines();
  EXPECT_THAT(lines[1], StartsWith("G1 X"));
  EXPECT_THAT(lines[1], testing::EndsWith(" (a circle) F500 ; all of it"));
  EXPECT_THAT(lines[1], Not(HasSubstr("I-")));
  EXPECT_THAT(lines[2], testing::MatchesRegex("G1 X[0-9.-]+ Y[0-9.-]+ Z[0-9.-]+"));
  const std::string& last = lines[lines.size() - 2];
  EXPECT_NEAR(*word(last, 'X'), target(50, 0, -900).position.x(), 1e-4);
  EXPECT_NEAR(*word(last, 'Y'), target(50, 0, -900).position.y(), 1e-4);
}

TEST_F(GcodeLines, AnArcThatNeedsNoCorrectionStays) {
  std::string all;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_folder() / "tests/filter/programs")) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    EXPECT_EQ(filtered_gcode(text, none, {.origin = {0, 0, -900}}).text, text) << entry.path();
    all += text;
  }
  EXPECT_GT(all.size(), 4000U);
}

/// An arc by its mode alone has no word to change: one is added; and what is passed through finds its mode again.
TEST_F(GcodeLines, ModesOfArcsAreStated) {
  const std::string start = "g0 x50 y0 z-900\ng3 x0 y50 r50\n";
  const Filtered modal = of(start + "x-50 y0 r50\nx0 y-50 r50\n");
  EXPECT_TRUE(modal.summary.complete());
  EXPECT_THAT(modal.text, Not(HasSubstr("\nx")));
  EXPECT_THAT(modal.text, Not(HasSubstr("g3")));
  const Filtered left = of(start + "x4000 y0 r2500\n");  // the mode of the controller is a line's
  EXPECT_TRUE(left.has("out of reach"));
  EXPECT_THAT(left.text, HasSubstr("\ng3 x4000 y0 r2500\n"));
  EXPECT_THAT(of(start + "g3 x4000 y0 r2500\n").text, HasSubstr("\ng3 x4000 y0 r2500\n"));
  EXPECT_THAT(of("g0 x50 y0 z-900\ng1 x0\nx4000\n").text, HasSubstr("\nx4000\n"));
}

/// Long lines are divided where the correction bends; not more than needed, not where it may not be.
TEST_F(GcodeLines, LongLinesAreDivided) {
  const std::string start = "G0 X-400 Y0 Z-900\n", line = "N7 G1 X400 F900 (long)\n";
  const Filtered fine = of(start + line), coarse = of(start + line, {.chord = 10.0});
  EXPECT_GT(fine.summary.added, 2);
  EXPECT_LT(fine.summary.added, 40);
  EXPECT_EQ(coarse.summary.added, 0);
  EXPECT_GT(of(start + line, {.chord = 0.001}).summary.added, 2 * fine.summary.added);
  const auto lines = fine.lines();
  EXPECT_THAT(lines[1], testing::MatchesRegex("N7 G1 X[0-9.-]+ Y.* F900 .long."));
  EXPECT_THAT(lines.back(), StartsWith("G1 X40"));
  EXPECT_THAT(of(start + "G0 X400\r\nG1 X0\r\n").text, HasSubstr("\r\nG0 X"));
  // The stop comes where it came: behind all of the way.
  const auto pause = of(start + "G1 X400 F900 M0\n").lines();
  EXPECT_THAT(pause.back(), testing::MatchesRegex("G1 X40.* M0"));
  EXPECT_THAT(pause[1], HasSubstr("F900"));
  EXPECT_THAT(pause.back(), Not(HasSubstr("F900")));

  for (const auto& [hindered, reason] : {std::pair{"G1 X400 A9\n", "other axes"}, {"G1 X400 E9\n", "M82"}}) {
    const Filtered result = of(start + hindered + "G1 X0\n");
    EXPECT_EQ(result.summary.corrected, 3) << hindered;  // at its end alone
    EXPECT_TRUE(result.has(reason)) << hindered;
    EXPECT_FALSE(result.summary.whole());
    EXPECT_TRUE(of(start + std::string(hindered), {.chord = 10.0}).summary.complete());
  }
}

/// A line from a place that is not known in all axes may come from anywhere.
TEST_F(GcodeLines, WhatComesFromNowhereIsNotDivided) {
  EXPECT_EQ(of("G0 X-400 Y0\nG1 X400 Z-900\n").summary.added, 0);
  EXPECT_GT(of("G0 X-400 Y0 Z-900\nG1 X400 Z-900\n").summary.added, 0);
}

/// As many pieces as the chord asks for, not many more: where they are halved the plate leaves the line too far.
TEST_F(GcodeLines, PiecesAreNotFinerThanNeeded) {
  const std::string line = "G0 X-400 Y100 Z-900\nG1 X400 Y-50 Z-850\n";
  for (const double chord : {0.002, 0.01, 0.05}) {
    const auto pieces = of(line, {.chord = chord}).summary.added + 1;
    const auto bend = [&](double from, double to) {
      const auto off = [&](double t) {
        const Eigen::Vector3d place(-400 + 800 * t, 100 - 150 * t, -900 + 50 * t);
        return Eigen::Vector3d(correction.target({place, 0.0})->position - place);
      };
      return (off(0.5 * (from + to)) - 0.5 * (off(from) + off(to))).norm();
    };
    const auto farthest = [&](double count) {
      double most = 0.0;
      for (double k = 0; k < count; ++k) most = std::max(most, bend(k / count, (k + 1) / count));
      return most;
    };
    EXPECT_LE(farthest(static_cast<double>(pieces)), chord * 1.01);
    EXPECT_GT(farthest(std::floor(0.6 * static_cast<double>(pieces))), chord);
  }
}

/// A centre that was rounded leaves two radii: the way changes evenly from one to the other.
TEST_F(GcodeLines, TheRadiusOfAnArcChangesEvenly) {
  const auto lines = of("G0 X50 Y0 Z-900\nG3 X-50.04 Y0 I-50 J0\n").lines();
  const double count = static_cast<double>(lines.size()) - 1;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const double t = static_cast<double>(k) / count, radius = 50 + 0.04 * t, angle = t * std::acos(-1.0);
    const Eigen::Vector3d wanted = target(radius * std::cos(angle), radius * std::sin(angle), -900).position;
    EXPECT_NEAR(*word(lines[k], 'X'), wanted.x(), 1e-4);
    EXPECT_NEAR(*word(lines[k], 'Y'), wanted.y(), 1e-4);
  }
}

/// A line whose ends are in reach and whose middle is not.
TEST_F(GcodeLines, APieceOutOfReachLeavesTheWholeLine) {
  const Filtered result = of("G0 X500 Y0 Z-900\nG3 X-500 Y0 R-1500 F100\nG1 X0 Y0\n");
  EXPECT_TRUE(correction.target({{-500, 0, -900}, 0.0}));
  EXPECT_EQ(result.summary.corrected, 2);
  EXPECT_TRUE(result.has("out of reach"));
  EXPECT_FALSE(result.summary.whole());
  EXPECT_THAT(result.text, HasSubstr("\nG3 X-500 Y0 R-1500 F100\n"));
}

/// What is extruded a mm of the way that was programmed stays; so does all of it.
TEST_F(GcodeLines, ExtrusionFollowsThePieces) {
  for (const bool relative : {false, true}) {
    const std::string program = std::string(relative ? "M83\n" : "M82\nG92 E10\n") + "G0 X-300 Y0 Z-900\nG1 X300 E" +
                                (relative ? "30.5" : "40.5") + " F900\nG3 X0 Y300 R300 E" +
                                (relative ? "20.25\n" : "60.75\n");
    const Filtered result = of(program);
    EXPECT_TRUE(result.summary.complete());
    double extruded = relative ? 0.0 : 10.0;
    std::vector<double> of_line, of_arc;
    for (const std::string& line : result.lines()) {
      if (!line.starts_with("G1")) continue;
      const double e = *word(line, 'E'), step = relative ? e : e - extruded;
      extruded += step;
      (of_arc.empty() && word(line, 'Y').value_or(0.0) < 1.0 ? of_line : of_arc).push_back(step);
    }
    EXPECT_NEAR(extruded, relative ? 50.75 : 60.75, 1e-4);
    ASSERT_GT(of_line.size(), 1U);
    ASSERT_GT(of_arc.size(), 30U);
    for (const double step : of_line) EXPECT_NEAR(step, 30.5 / static_cast<double>(of_line.size()), 2e-5);
    for (const double step : of_arc) EXPECT_NEAR(step, 20.25 / static_cast<double>(of_arc.size()), 2e-5);
  }
}

/// G90 and G91 speak of the extruder for some firmwares and not for others: M82, M83 must.
TEST_F(GcodeLines, WhetherExtrusionIsAbsoluteMustBeKnown) {
  const std::string motion = "G0 X-300 Y0 Z-900\nG1 X300 E5\n";
  EXPECT_TRUE(of("G92 E0\n" + motion).summary.complete());
  EXPECT_TRUE(of("G90\nG92 E0\n" + motion).summary.complete());
  EXPECT_TRUE(of("G91\nG90\nG92 E0\n" + motion).has("M82"));
  EXPECT_TRUE(of("G91\nG90\nM83\n" + motion).summary.complete());
  EXPECT_TRUE(of("M83\nG90\n" + motion).has("M82"));
  EXPECT_TRUE(of(motion).has("M82"));  // from where?
  EXPECT_TRUE(of("G1 E3 F200\n" + motion).summary.complete());
}

/// What the owner of a printer knows of his macros.
TEST_F(GcodeLines, MacrosThatMoveNothingCanBeNamed) {
  const std::string program = "G0 X0 Y0 Z-900\n_Take_Frame2 LAYER=3\nG1 X5\nPAUSE\nG1 Y5\n";
  EXPECT_TRUE(of(program).has("a macro (give --harmless NAME"));
  const Filtered one = of(program, {.harmless = {"_take_frame2"}});
  EXPECT_EQ(one.summary.corrected, 2);
  EXPECT_TRUE(of(program, {.harmless = {"_TAKE_FRAME2", "Pause"}}).summary.complete());
  EXPECT_TRUE(of(program, {.harmless = {"_TAKE_FRAME"}}).has("a macro"));
}

TEST_F(GcodeLines, IncrementalMotionsAreStepsBetweenTargets) {
  const auto lines = of("G0 X0 Y0 Z-900\nG91\nG1 X10\nG1 Y-5 Z1\n").lines();
  const Eigen::Vector3d one = target(0, 0, -900).position, two = target(10, 0, -900).position,
                        three = target(10, -5, -899).position;
  EXPECT_NEAR(*word(lines[2], 'X'), two.x() - one.x(), 1.01e-4);
  EXPECT_NEAR(*word(lines[3], 'Y'), three.y() - two.y(), 1.01e-4);
  EXPECT_NEAR(*word(lines[3], 'Z'), three.z() - two.z(), 1.01e-4);
}

/// The controller stands where it was told, not where the program thinks: by that much it is called otherwise.
TEST_F(GcodeLines, APlaceThatIsCalledAnewKeepsTheCorrection) {
  const auto lines = of("G0 X20 Y0 Z-900\nG92 X5 E0\nG1 X0 Y0\n").lines();
  const double moved = target(20, 0, -900).position.x() - 20;
  EXPECT_NEAR(*word(lines[1], 'X'), 5 + moved, 1.01e-4);
  EXPECT_THAT(lines[1], testing::EndsWith(" E0"));
  EXPECT_NEAR(*word(lines[2], 'X'), target(15, 0, -900).position.x() - 15, 1.01e-4);
}

TEST_F(GcodeLines, WhatIsSaidOfTheTargets) {
  const FilterSummary summary = of("G0 X0 Y0 Z-900\nG1 X600\nG1 X0 Z-700\nG1 X100 Z-900\n").summary;
  EXPECT_EQ(summary.outside, 2);
  EXPECT_EQ(summary.first_outside, 2);
  ASSERT_THAT(summary.farthest, SizeIs(4));
  for (std::size_t k = 0; k < 4; ++k) {
    const CorrectedTarget& one = summary.farthest[k];
    EXPECT_LE(one.distance(), summary.farthest[k == 0 ? 0 : k - 1].distance());
    EXPECT_NEAR(one.distance(), (correction.target(one.wanted)->position - one.wanted.position).norm(), 1e-9);
  }
  EXPECT_THAT(summary.assumed, IsEmpty());
  std::string many;
  for (int k = 0; k < 30; ++k) many += fmt::format("G1 X{} Y0 Z-900\n", 10 * k);
  EXPECT_THAT(of(many).summary.farthest, SizeIs(10));
}

/// A machine whose plate turns, and a program that does not know it.
TEST(GcodeRotation, ThatIsNeverStatedIsZeroAndSaid) {
  const Robot robot = catalogue::find("huang2016");
  const TargetCorrection correction(robot, test::table4_machine(robot, 1));
  const std::string motion = "G1 X10 Y0 Z-900\nG1 X20\n";
  const Filtered never = filtered_gcode(motion, correction),
                 stated = filtered_gcode("G1 X0 Y0 Z-900 C0\n" + motion, correction);
  EXPECT_EQ(never.summary.corrected, 2);
  EXPECT_THAT(never.summary.assumed, ElementsAre(HasSubstr("C")));
  EXPECT_THAT(stated.summary.assumed, IsEmpty());
  EXPECT_THAT(stated.text, testing::EndsWith(never.text.substr(never.text.rfind("G1"))));
  const Filtered late = filtered_gcode(motion + "G1 C5\n" + motion, correction);
  EXPECT_FALSE(late.summary.whole());
  EXPECT_TRUE(late.has("C is stated after"));
  EXPECT_TRUE(filtered_gcode("G0 C5\n" + motion, correction).summary.whole());
  EXPECT_FALSE(filtered_gcode("G0 C5\n" + motion, correction).has("C is stated after"));
  EXPECT_TRUE(filtered_gcode(motion + "G1 C5\n", correction, {.start = Pose{{0, 0, -900}, 0.0}}).summary.complete());
}

/// The places that the lines of an output state, each axis as it was told last; mm and rad.
std::vector<Pose> told_in(const Filtered& result) {
  std::vector<Pose> poses;
  Pose held;
  for (const std::string& line : result.lines()) {
    const Eigen::Vector3d& r = held.position;
    held = {{word(line, 'X').value_or(r.x()), word(line, 'Y').value_or(r.y()), word(line, 'Z').value_or(r.z())},
            to_radians(word(line, 'C').value_or(to_degrees(held.rotation)))};
    poses.push_back(held);
  }
  return poses;
}

/// While C turns on an arc or on the spot the correction bends, too: the plate's place stays within the chord of the
/// way, and its rotation by as much at 100 mm from its axis.
TEST(GcodeRotation, BendsWhatItTurnsWith) {
  const Robot robot = catalogue::find("huang2016");
  SourceErrors errors = test::table4_machine(robot, 1);
  for (std::size_t limb = 0; limb < 4; ++limb) errors(limb, "theta_offset") = limb % 2 == 0 ? 0.02 : -0.015;
  const TargetCorrection correction(robot, errors);
  const Machine machine = build(robot, errors);
  for (const auto& [radius, sweep] : {std::pair{5.0, 3.0}, {100.0, 0.02}, {0.0, 0.0}}) {
    const auto wanted_at = [&, radius = radius, sweep = sweep](double t) {
      return Eigen::Vector3d(300 + radius * (std::cos(sweep * t) - 1), radius * std::sin(sweep * t), -900);
    };
    const std::string turning =
        radius > 0.0 ? fmt::format("G3 X{:.9f} Y{:.9f} C170 I-{}\n", wanted_at(1).x(), wanted_at(1).y(), radius)
                     : std::string("G1 C170\n");
    for (const double chord : {0.002, 0.02}) {
      const Filtered result = filtered_gcode("G0 X300 Y0 Z-900 C-100\n" + turning, correction, {.chord = chord});
      ASSERT_TRUE(result.summary.complete());
      const std::vector<Pose> told = told_in(result);
      const double pieces = static_cast<double>(told.size()) - 1;
      for (std::size_t k = 1; k < told.size(); ++k) {
        for (const double part : {0.25, 0.5, 0.75}) {
          const Pose asked{told[k - 1].position + part * (told[k].position - told[k - 1].position),
                           told[k - 1].rotation + part * (told[k].rotation - told[k - 1].rotation)};
          const ForwardResult reached = forward(machine, inverse(robot.nominal(), asked).joints);
          ASSERT_TRUE(reached.ok());
          const double t = (static_cast<double>(k) - 1 + part) / pieces;
          EXPECT_LE((reached.plate.position - wanted_at(t)).norm(), chord + 2e-4) << radius << " " << pieces;
          const double rotation = machine.rotation_of(reached.plate.slide);
          EXPECT_LE(100 * std::abs(rotation - to_radians(-100 + 270 * t)), chord + 2e-4) << radius << " " << pieces;
        }
      }
    }
  }
}

/// C of a plate that does not turn is an axis of its own, as A is: pieces of a line would turn it at once.
TEST_F(GcodeLines, AnotherAxisIsNotTurnedAhead) {
  const std::string start = "G0 X0 Y0 Z-900 C0\nF600\n";
  for (const char* axis : {"A", "B", "C", "U", "V", "W"}) {
    const Filtered line = of(start + "G1 X300 " + axis + "90\nG1 X280\n"),
                   arc = of(start + "G3 X-80 I-40 " + axis + "180\nG1 X0 Y0 Z-900\n");
    for (const Filtered& result : {line, arc}) {
      EXPECT_EQ(result.passed("a line to divide that also moves other axes"), 1) << axis;
      EXPECT_FALSE(result.summary.whole());
      EXPECT_EQ(result.summary.added, 0);
    }
    EXPECT_TRUE(of(start + "G1 X1 " + axis + "90\nG92 " + axis + "0\nX2\n").summary.complete()) << axis;
  }
}

/// LinuxCNC's order: modes, tool, plane, unit, system, distance, then G10 and G92, then the motion; wherever they
/// stand.
TEST_F(GcodeLines, CodesOfALineHaveAnOrder) {
  const std::string start = "G21 G90\nG10 L2 P1 X0 Y0 Z0\nG10 L2 P2 X10 Y0 Z0\nG54 G0 X0 Y0 Z-900\n";
  const GcodeOptions linuxcnc{.dialect = GcodeDialect::linuxcnc};
  const auto told = [&](const std::string& lines, const GcodeOptions& options, double x, double unit, double shift) {
    const Filtered result = of(start + lines, options);
    EXPECT_TRUE(result.summary.complete()) << lines;
    EXPECT_NEAR(*word(result.lines().back(), 'X') * unit + shift, target(x, 0, -900).position.x(), 1e-4) << lines;
  };
  told("G10 L2 P1 X1 G20\nG1 X1\n", linuxcnc, 50.8, 25.4, 25.4);
  told("G10 L2 P1 X1 G20\nG1 X1\n", {.dialect = GcodeDialect::reprapfirmware}, 26.4, 25.4, 1.0);  // as written
  told("G10 L2 P0 X5 G55\nG1 X20\n", linuxcnc, 25, 1.0, 5.0);
  told("G92 X1 G20\nG1 X2\n", linuxcnc, 25.4, 25.4, -25.4);
  told("G92 X1 G55\nG1 X2\n", linuxcnc, 1.0, 1.0, -1.0);
  told("G4 P0.1 X7\n", linuxcnc, 7, 1.0, 0.0);
  told("G1 X5 Y0 Z-900 M72 G90 G21\nX9\n", linuxcnc, 9, 1.0, 0.0);  // modes are restored before
  EXPECT_EQ(of(start + "G4 X7\nG1 Y3\n").summary.corrected, 2);
  EXPECT_EQ(of(start + "M6 G1 X7\n").summary.corrected, 1);  // from where the tool was changed
  EXPECT_EQ(of(start + "G1 X7 T1\n").summary.corrected, 1);
  told("G92 X1\nG92.1 X7\n", linuxcnc, 7, 1.0, 0.0);
  EXPECT_EQ(of("G0 X0 Y0\nG43.1 Z0.5\nG1 X5\n").summary.corrected, 0);
}

/// T is a tool where it is one, and G10 without L an offset: the number of corrected targets behind a line, by dialect.
TEST_F(GcodeLines, ToolsAreToldFromNumbersOfCodes) {
  const auto keeps_place = [&](const std::string& line, GcodeDialect dialect) {
    return of("G0 X0 Y0 Z-900.\n" + line + "\nG1 X1.\n", {.dialect = dialect}).summary.complete();
  };
  constexpr std::array kAll{GcodeDialect::any,    GcodeDialect::linuxcnc,       GcodeDialect::klipper,
                            GcodeDialect::marlin, GcodeDialect::reprapfirmware, GcodeDialect::fanuc_like};
  for (const GcodeDialect dialect : kAll) {
    const bool prepares = dialect == GcodeDialect::linuxcnc || dialect == GcodeDialect::fanuc_like;
    for (const char* number : {"M204 P1000 T2000", "M104 T0 S190", "N4 M109 S200 T1", "M204P500T500"}) {
      EXPECT_TRUE(keeps_place(number, dialect)) << number << static_cast<int>(dialect);
    }
    for (const char* tool : {"T1", "N5 T0", "T1 M204 P5"}) {
      EXPECT_EQ(keeps_place(tool, dialect), prepares) << tool << static_cast<int>(dialect);
    }
    EXPECT_FALSE(keeps_place("T1 M6", dialect));
    EXPECT_FALSE(keeps_place("M6 T1", dialect));
    EXPECT_THROW(keeps_place("G10 L1 P1 Z5", dialect), InputFileError);
  }
  EXPECT_FALSE(keeps_place("M3 S1000 T2", GcodeDialect::any));
  EXPECT_TRUE(keeps_place("M106 S255 T2", GcodeDialect::any));
  EXPECT_TRUE(keeps_place("M3 S1000 T2", GcodeDialect::marlin));
  EXPECT_TRUE(keeps_place("G10 P0 S205 T1", GcodeDialect::any));

  const auto keeping = [&](const std::string& line) {  // refused: x
    std::string result;
    for (const GcodeDialect dialect : kAll) {
      try {
        result += keeps_place(line, dialect) ? 'y' : 'n';
      } catch (const InputFileError&) {
        result += 'x';
      }
    }
    return result;
  };
  EXPECT_EQ(keeping("G10 P0 R140 S205"), "yxyyyx");
  EXPECT_EQ(keeping("G10 P0 R140"), "xxyyyx");  // the offset of a tool for some
  EXPECT_EQ(keeping("G10 P1 X5 S205"), "xxyynx");
  EXPECT_EQ(keeping("G10"), "yxyyyx");
}

/// Macros of printers begin and end a print. What they leave is taken for absolute and mm, and that is said, unless the
/// program states it; E, F and places it must state.
TEST_F(GcodeLines, MacrosOfPrintersAreApproachAndRetreat) {
  using enum GcodeDialect;
  const std::string print = "M83\nG1 Z-900 F600\nG1 X0 Y0\nG1 X300 E3\n";
  for (const auto& [macro, dialect] : {std::pair{"START_PRINT BED=60", klipper},
                                       {"M98 P\"start.g\"", reprapfirmware},
                                       {"M810", marlin},
                                       {"M32 \"start.g\"", reprapfirmware}}) {
    const std::string line = macro + std::string("\n");
    const Filtered result = of(line + print + line, {.dialect = dialect});
    EXPECT_TRUE(result.summary.whole()) << macro;
    EXPECT_EQ(result.summary.corrected, 2) << macro;
    EXPECT_EQ(result.passed("a macro (give --harmless"), 2) << macro;
    EXPECT_THAT(result.summary.assumed, Contains(HasSubstr("after macros, coordinates are absolute and in mm")))
        << macro;
    EXPECT_THAT(of(line + "G90\n" + print, {.dialect = dialect}).summary.assumed, Not(Contains(HasSubstr("macros"))))
        << macro;
    EXPECT_FALSE(of(print + line + print, {.dialect = dialect}).summary.whole()) << macro;  // between targets
    EXPECT_TRUE(of("G91\n" + line + print, {.dialect = dialect}).has("whose mode is unknown")) << macro;
  }
  EXPECT_TRUE(of("START\n" + print).has("whose mode is unknown"));  // of no printer nothing is known
  EXPECT_THROW(of("M98 P\"start.g\"\n" + print), InputFileError);
}

/// P of an output or a path mode stays where an arc becomes lines; it states turns all the same, as LinuxCNC has it. E
/// of an output is not shared among pieces.
TEST_F(GcodeLines, WordsOfOtherCodesStay) {
  const std::string start = "G0 X40 Y0 Z-900\nF500\n";
  for (const char* other :
       {"M62 P1", "M63 P1", "M64 P1", "M65 P1", "M66 P1 L0", "M101 P1", "M52 P1", "G64 P1", "G4 P1"}) {
    const Filtered result = of(start + "G2 X-40 R40 " + other + "\nG1 X0\n");
    EXPECT_TRUE(result.summary.complete()) << other;
    EXPECT_THAT(result.lines()[2], testing::EndsWith(std::string(" ") + other));
    EXPECT_THAT(result.lines()[3], Not(HasSubstr("P")));
  }
  EXPECT_THAT(of(start + "G2 X-40 R40 M3 P1\nG1 X0\n").text, Not(HasSubstr("P1")));
  const Filtered once = of(start + "G2 X-40 R40 M62 P1\n"), twice = of(start + "G2 X-40 R40 M62 P2\n");
  EXPECT_NEAR(static_cast<double>(twice.summary.added) / static_cast<double>(once.summary.added), 3.0, 0.05);
  const Filtered half = of(start + "G2 X-40 R40 G64 P0.5\n");
  EXPECT_EQ(half.passed("turns"), 1);
  const Filtered output = of(start + "G1 X300 M67 E0 Q2\nG1 X0 M68 E1 Q3\n");
  EXPECT_TRUE(output.summary.complete());
  EXPECT_GT(output.summary.added, 0);
  EXPECT_THAT(output.lines()[2], HasSubstr(" M67 E0 Q2"));
  EXPECT_THAT(output.lines()[3], Not(HasSubstr("E")));
}

/// Words of firmwares by which a straight motion is none to a place.
TEST_F(GcodeLines, SpecialMotionsOfFirmwaresAreNoTargets) {
  const GcodeOptions rrf{.dialect = GcodeDialect::reprapfirmware}, marlin{.dialect = GcodeDialect::marlin};
  const std::string start = "G0 X0 Y0 Z-900\n";
  for (const char* motors :
       {"G1 H1 X5", "G1 H2 X5", "G0 H3 X5", "G1 X5 H4", "G1 H1 Z5", "G1 S1 X5", "G1 S2 X5", "G1 S3 X5"}) {
    const Filtered result = of(start + motors + "\nG1 Y1\n", rrf);
    EXPECT_EQ(result.passed("single motors"), 1) << motors;
    EXPECT_EQ(result.summary.corrected, 1) << motors;
    EXPECT_THAT(result.text, HasSubstr("\n" + std::string(motors) + "\n"));
    EXPECT_TRUE(of(start + motors + "\n", rrf).summary.whole()) << motors;  // as homing
    EXPECT_EQ(of(start + motors + "\n" + start, rrf).summary.corrected, 2) << motors;
  }
  for (const char* plain : {"G1 H0 X5", "G1 S0 X5", "G1 S255 X5"}) {
    EXPECT_TRUE(of(start + plain + "\n", rrf).summary.complete()) << plain;
  }
  EXPECT_TRUE(of(start + "G1 S1 X5\n", marlin).summary.complete());
  EXPECT_TRUE(of("G43 H1 G0 X0 Y0 Z-900\n").summary.complete());
  EXPECT_TRUE(of("G43 H1 G0 X0 Y0 Z-900\n", rrf).summary.complete());

  for (const char* restored : {"G1 R1 X5", "G0 R2 X0 Y0 Z5", "G1 X5 R0"}) {
    const Filtered result = of(start + restored + "\nG1 Z-899\n", rrf);
    EXPECT_EQ(result.passed("relative to a saved position"), 1) << restored;
    EXPECT_EQ(result.summary.corrected, 1) << restored;
  }
  EXPECT_EQ(of(start + "G0 R2 X1\nG1 X5\n", rrf).summary.corrected, 2);  // only of the axes that it names
}

/// P of an arc: turns for LinuxCNC, turns beside the arc for Marlin, not known for others or where filament is
/// extruded.
TEST_F(GcodeLines, TurnsAreTheDialects) {
  const auto lines = [&](const std::string& words, GcodeDialect dialect) {
    return of("M83\nG0 X40. Y0 Z-900.\nG3 X0 Y40. I-40. J0 " + words + "\n", {.dialect = dialect}).summary;
  };
  constexpr auto kAny = GcodeDialect::any, kLinuxcnc = GcodeDialect::linuxcnc, kMarlin = GcodeDialect::marlin;
  const auto quarters = [&](const std::string& words, GcodeDialect dialect) {
    return static_cast<double>(lines(words, dialect).added + 1) / static_cast<double>(lines("", kAny).added + 1);
  };
  EXPECT_NEAR(quarters("P1", kLinuxcnc), 1.0, 1e-12);
  EXPECT_NEAR(quarters("P2", kAny), 5.0, 0.2);
  EXPECT_NEAR(quarters("P1 E9", kMarlin), 5.0, 0.2);
  EXPECT_NEAR(quarters("P0 E9", kMarlin), 1.0, 1e-12);
  EXPECT_TRUE(lines("P1 E9", kMarlin).complete());
  EXPECT_TRUE(lines("P1", kAny).complete());
  EXPECT_FALSE(lines("P1 E9", kAny).complete());
  EXPECT_TRUE(lines("P1 E9", kLinuxcnc).complete());
  for (const auto dialect : {GcodeDialect::klipper, GcodeDialect::reprapfirmware, GcodeDialect::fanuc_like}) {
    const FilterSummary summary = lines("P1", dialect);
    ASSERT_THAT(summary.passed, SizeIs(1));
    EXPECT_THAT(std::string(summary.passed[0].reason), HasSubstr("an arc with P"));
  }
}

/// After something unknown nobody can say in which mode the controller would have been, and is not.
TEST_F(GcodeLines, WhatReliesOnARewrittenModeIsNoRetreat) {
  const std::string start = "G0 X50 Y0 Z-900\nG3 X0 Y50 R50\n";
  const Filtered relies = of(start + "MY_MACRO\nG90 G21 Z-870\n");
  EXPECT_TRUE(relies.has("after a rewritten line"));
  EXPECT_FALSE(relies.summary.whole());
  EXPECT_TRUE(of(start + "MY_MACRO\nG90 G21 G1 Z-870\nZ-860\n").summary.whole());
  EXPECT_TRUE(of(start + "MY_MACRO\nG80\nZ-870\n").summary.whole());
  EXPECT_TRUE(of("G0 X0 Y0 Z-880\nMY_MACRO\nG90 G21 Z-870\n").summary.whole());
}

/// What systems are to each other is known from the program or from LinuxCNC's file, or their targets stay.
TEST_F(GcodeLines, SystemsAreToEachOtherWhatIsKnownOfThem) {
  const std::string known = "G10 L2 P1 X0 Y0 Z0\nG10 L2 P2 X30 Y-20 Z10\n";
  const std::string program = "G54 G0 X0 Y0 Z-900\nG55 G1 X10\n";
  const Filtered both = of(known + program);
  EXPECT_TRUE(both.summary.complete());
  const Eigen::Vector3d wanted = target(40, 0, -900).position;
  const std::string last = both.lines().back();
  EXPECT_NEAR(*word(last, 'X'), wanted.x() - 30, 1e-4);
  EXPECT_NEAR(*word(last, 'Y'), wanted.y() + 20, 1e-4);
  EXPECT_NEAR(*word(last, 'Z'), wanted.z() - 10, 1e-4);
  for (const char* other : {"", "G10 L2 P2 X30 Y-20 Z10\n", "G10 L2 P1 X0 Y0 Z0\nG10 L2 P2 X30 Y-20\n"}) {
    EXPECT_TRUE(of(other + program + "Y0 Z-900\n").has("another origin")) << other;
  }
  EXPECT_TRUE(of("G10 L2 P1 X0 Y0 Z0\nG10 L2 P2 X30 Y-20 Z10 R0\n" + program).summary.complete());
  EXPECT_TRUE(of(known + "/G10 L2 P2 X5\nG21 G90\n" + program + "G0 Y0 Z-900\n").has("another origin"));
}

TEST_F(GcodeLines, WorkOffsetsComeFromLinuxcncsFile) {
  const auto file = [](const std::string& text) { return TextFile{"linuxcnc.var", text}; };
  std::string text = "5210\t0.000000\n5220\t2.000000\r\n";
  for (const int base : {5220, 5240}) {
    for (int k = 1; k <= 10; ++k) text += fmt::format("{}\t{:.6f}\n", base + k, k == 10 || base == 5220 ? 0.0 : k);
  }
  const WorkOffsets offsets = read_work_offsets(file(text));
  EXPECT_EQ(offsets.active, 2U);
  EXPECT_FALSE(offsets.is_shifted);
  EXPECT_EQ(offsets.systems[0], ProgramAxes{});
  EXPECT_EQ(offsets.systems[1], (ProgramAxes{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
  EXPECT_FALSE(offsets.systems[2]);
  std::string turned = text;
  turned.replace(turned.find("5250\t0"), 6, "5250\t9");
  EXPECT_FALSE(read_work_offsets(file(turned)).systems[1]);
  EXPECT_TRUE(read_work_offsets(file("5221 0\n")).is_shifted);
  EXPECT_FALSE(read_work_offsets(file("5221 0\n")).systems[0]);

  const GcodeOptions options{.offsets = offsets};
  const Filtered one = of("G0 X0 Y0 Z-900\nG54 G1 X10\nG53 G0 Z-890\n", options);
  EXPECT_TRUE(one.summary.complete());
  EXPECT_NEAR(*word(one.lines()[1], 'X'), target(9, 0, -900).position.x() + 1, 1e-4);
  EXPECT_NEAR(*word(one.lines()[2], 'Z'), target(9, 0, -893).position.z() + 3, 1e-4);
  EXPECT_TRUE(of("G0 X0 Y0 Z-900\nG53 G0 Z-890\nG0 Z-900\n").has("another origin"));
  EXPECT_TRUE(of("G92.1\nG0 X0 Y0 Z-900\nG53 G0 Z-890\nG0 Z-900\n", options).summary.complete());
  EXPECT_TRUE(of("G0 X0 Y0 Z-900\nG91 G53 G0 Z-890\nG90 G0 Z-900\n", options).has("another origin"));

  WorkOffsets shifted = offsets;
  shifted.is_shifted = true;  // by how much is not said
  EXPECT_TRUE(of("G0 X0 Y0 Z-900\nG53 G0 Z-890\nG0 Z-900\n", {.offsets = shifted}).has("another origin"));
  // The place stays where it is when its system moves.
  const Filtered moved = of("G10 L2 P2 Z-2\nG1 X5\n", {.start = Pose{{0, 0, -900}, 0.0}, .offsets = offsets});
  EXPECT_TRUE(moved.summary.complete());
  EXPECT_NEAR(*word(moved.lines()[1], 'Z'), target(5, 0, -895).position.z(), 1e-4);

  const auto complaint = [&](const std::string& bad) {
    try {
      read_work_offsets(file(bad));
    } catch (const InputFileError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_EQ(complaint("5221 0\n5222 zero\n"),
            "linuxcnc.var:2: expected the number and the value of a parameter, got 5222 zero");
  EXPECT_THAT(complaint("5221\n"), StartsWith("linuxcnc.var:1: expected the number and the value of a parameter"));
  EXPECT_THAT(complaint("5221.5 3\n"), StartsWith("linuxcnc.var:1: expected the number and the value of a parameter"));
  EXPECT_THAT(complaint("5221 0\n5221 1\n"), StartsWith("linuxcnc.var:2: expected each parameter once"));
  EXPECT_THAT(complaint("5161 0\n"), HasSubstr("from 5221"));
  EXPECT_THAT(complaint("5221 0\n5220 12\n"), HasSubstr("from 1 to 9, got 12"));
}

struct OfDialect {
  const char* program;
  const char* reason;  ///< why it is left where it is
  std::vector<GcodeDialect> left_by;
};

/// What controllers do not agree on is known where it is known who reads the program.
TEST_F(GcodeLines, DialectsDecideWhatControllersReadDifferently) {
  using enum GcodeDialect;
  const std::string motion = "G0 X-300 Y0 Z-900\nG1 X300 E5\n", place = "G0 X0 Y0 Z-900\n";
  const std::vector<OfDialect> rows{
      {"M83\nG90\n", "M82", {any, linuxcnc, fanuc_like, marlin}},  // absolute for Marlin, and from where?
      {"M83\nG91\nG90\n", "M82", {any, linuxcnc, fanuc_like, marlin}},
      {"M82\nG92 E0\nG91\nG90\n", "M82", {any, linuxcnc, fanuc_like}},
  };
  const auto dialects = {any, linuxcnc, klipper, marlin, reprapfirmware, fanuc_like};
  for (const OfDialect& row : rows) {
    for (const GcodeDialect dialect : dialects) {
      std::string program = row.program + motion;
      if (dialect == fanuc_like) program = row.program + std::string("G0 X-300. Y0 Z-900.\nG1 X300. E5\n");
      EXPECT_EQ(of(program, {.dialect = dialect}).has(row.reason), std::ranges::count(row.left_by, dialect) > 0)
          << row.program << static_cast<int>(dialect);
    }
  }
  const std::string steps = "M82\nG92 E0\nG0 X-300 Y0 Z-900\nG91\nG1 X600 E5\n";
  for (const GcodeDialect dialect : {klipper, marlin, reprapfirmware}) {  // steps of E or places
    const auto lines = of(steps + "G1 Y1 E5\n", {.dialect = dialect}).lines();
    const std::size_t last = lines.size() - 2;
    EXPECT_NEAR(*word(lines[last], 'E'), dialect == reprapfirmware ? 5.0 : 5.0 / static_cast<double>(last - 3), 1e-4);
  }
  for (const GcodeDialect dialect : {linuxcnc, fanuc_like}) {
    EXPECT_TRUE(of("G0 X0 Y0 Z-900.\nT2\nX5.\n", {.dialect = dialect}).summary.complete());
    EXPECT_FALSE(of("G0 X0 Y0 Z-900.\nT2 M6\nX5.\n", {.dialect = dialect}).summary.complete());
  }
  EXPECT_FALSE(of(place + "T2\nX5\n", {.dialect = klipper}).summary.complete());
  const std::string zero = "G10 L2 P1 X0 Y0 Z0\nG54 G0 X0 Y0 Z-900\nG10 L2 P0 X5\nG1 X0\nZ-900\n";
  for (const GcodeDialect dialect : {any, klipper, marlin})
    EXPECT_THROW(of(zero, {.dialect = dialect}), InputFileError);
  for (const GcodeDialect dialect : {linuxcnc, reprapfirmware}) {
    EXPECT_TRUE(of(zero, {.dialect = dialect}).summary.complete());
  }
}

TEST_F(GcodeLines, LengthsWithoutPointsMayBeCounts) {
  const GcodeOptions fanuc{.dialect = GcodeDialect::fanuc_like};
  EXPECT_TRUE(of("G0 X0 Y0 Z-900.\nM19 R90\nG1 X5.0 F100 S500\nG2 X7. I1.\nG92 X5.\n", fanuc).summary.complete());
  for (const char* line : {"G1 X5\n", "G2 X7. I1\n", "G2 X7. R1\n", "G92 X5\n", "/G0 Y-3\n"}) {
    EXPECT_THAT([&] { of("G0 X0 Y0 Z-900.\nG1 X5.0\n" + std::string(line), fanuc); },
                testing::ThrowsMessage<InputFileError>(HasSubstr(":3: expected a decimal point in ")))
        << line;
  }
  EXPECT_TRUE(of("G0 X0 Y0 Z-900\n").summary.complete());
}

}  // namespace
}  // namespace paracal::io::gcode_lines_test
