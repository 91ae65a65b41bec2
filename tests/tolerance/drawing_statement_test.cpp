// What drawings say, as half-widths and back.

#include "paracal/tolerance/drawing_statement.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <rapidcheck/gtest.h>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string>

#include "paracal/error.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/robots.hpp"

namespace paracal::drawing_statement_test {
namespace {

using testing::AllOf, testing::HasSubstr, testing::IsEmpty, testing::StartsWith, testing::ThrowsMessage;

DrawnFeature feature(Source source, const Robot& robot = catalogue::huang2016()) {
  return drawn_feature(source, robot.limbs());
}

double half_width(const std::string& statement, Source source, const Robot& robot = catalogue::huang2016()) {
  return half_width_of(statement, feature(source, robot));
}

std::string text_of(double half_width, Source source, const Robot& robot = catalogue::huang2016()) {
  return on_a_drawing(half_width, feature(source, robot)).text;
}

/// A Delta of which one limb has a longer rod on purpose.
Robot unlike() {
  RobotDescription description = catalogue::rotary_delta().description();
  test::redimension(description, [&](SharedDimensions& shared) { shared.rod = 998.0; });
  test::redimension(description, [&](SharedDimensions& shared) {
    shared.differences(1, "rod_mean") = 5.0;
  });  // 1003 mm: of the next range of sizes
  return Robot(description);
}

Robot of_kind(const std::string& kind) { return io::read_robot(io::robot_template(kind)); }

TEST(DrawingStatement, AGradeIsHalfItsWidthAboutTheNominalSize) {
  EXPECT_DOUBLE_EQ(half_width("IT8", "arm_length"), 0.089 / 2);  // 375 mm
  EXPECT_DOUBLE_EQ(half_width("375 IT8", "arm_length"), 0.089 / 2);
  EXPECT_DOUBLE_EQ(half_width("IT7", "rod_mean"), 0.090 / 2);  // 950 mm
}

TEST(DrawingStatement, LimitsAreOfTheRobotsSize) {
  for (const char* same :
       {"375 +- 0.04", "375+-0.04", "375 ± 0.04", "375±0.04", "375.0 +/- 4e-2", "  375  +-  0.04 "}) {
    EXPECT_EQ(half_width(same, "arm_length"), 0.04) << same;
  }
  EXPECT_EQ(half_width("375 +- 0", "arm_length"), 0.0);
}

/// Two parts within the same limits differ by twice their half-width at most.
TEST(DrawingStatement, ADifferenceOfTwoPartsIsTwiceAsWide) {
  EXPECT_DOUBLE_EQ(half_width("950 +- 0.01", "rod_difference"), 0.02);
  EXPECT_DOUBLE_EQ(half_width("IT5", "rod_difference"), 0.040);
  EXPECT_DOUBLE_EQ(half_width("IT6", "width_difference"), 0.022);  // 100 mm
}

/// A line of length L that is turned by T reaches L sin T across: as much as the zone is wide.
TEST(DrawingStatement, AnOrientationsZoneMayBeCrossedFromEdgeToEdge) {
  const double turn = half_width("parallelism 0.02/100", "alpha2");
  EXPECT_NEAR(100.0 * std::sin(turn), 0.02, 1e-15);
  EXPECT_NEAR(turn, 0.0002, 1e-11);
  EXPECT_EQ(half_width("parallelism dia 0.02/100", "alpha2"), turn);
  EXPECT_EQ(half_width("parallelism Ø0.02 / 100", "alpha2"), turn);
  EXPECT_EQ(half_width("perpendicularity 0.02/100", "beta2"), turn);
  EXPECT_EQ(half_width("angularity 0.02/100", "beta0"), turn);
  EXPECT_NEAR(half_width("parallelism 0.02/100 + 0.03/60", "alpha03"), turn + std::asin(0.0005), 1e-15);
}

TEST(DrawingStatement, APositionsZoneIsHalfAsFarAlongEachAxis) {
  for (const Source source : {Source("e_x"), Source("e_y"), Source("e_z")}) {
    EXPECT_DOUBLE_EQ(half_width("position dia 0.05", source), 0.025);
    EXPECT_DOUBLE_EQ(half_width("position ⌀0.05", source), 0.025);
    EXPECT_DOUBLE_EQ(half_width("position 0.05", source), 0.025);
    EXPECT_DOUBLE_EQ(half_width("position dia 0.05 + dia 0.03", source), 0.04);
  }
}

TEST(DrawingStatement, AZoneAloneIsATurn) {
  EXPECT_EQ(turn_within("0.1/100"), std::asin(0.001));
  for (const char* text :
       {"", "0.1", "0.1/", "/100", "100/0.1", "1/1", "0/100", "0.1/100/2", "0.1/100 + 0.1/100", "IT8"}) {
    EXPECT_EQ(turn_within(text), std::nullopt) << text;
  }
}

void expect_refused(const std::string& statement, Source source, std::initializer_list<std::string> parts,
                    const Robot& robot = catalogue::huang2016()) {
  for (const std::string& part : parts) {
    EXPECT_THAT([&] { half_width(statement, source, robot); },
                ThrowsMessage<InvalidArgument>(
                    AllOf(StartsWith("expected a number"), HasSubstr("got \"" + statement + "\""), HasSubstr(part))));
  }
}

TEST(DrawingStatement, OtherThanTheRobotsSizeIsRefused) {
  expect_refused("376 +- 0.04", "arm_length", {"\"375 +- H\"", "the robot's size is 375 mm"});
  expect_refused("376 IT8", "arm_length", {"the robot's size is 375 mm"});
}

TEST(DrawingStatement, WhatIsNoStatementIsRefused) {
  for (const char* text :
       {"", "H7", "375 js8", "it8", "IT19", "tight", "+- 0.04", "375", "375 + 0.05", "375 +0.05 -0.02", "375 +- -0.04",
        "375 +- inf", "375 +- 0,04", "IT8 IT7", "375 +- 0.04 mm"}) {
    expect_refused(text, "arm_length", {"\"IT8\" or \"375 +- H\" (bore distance of the arm)"});
  }
  for (const char* text : {"", "parallelism", "parallelism 0.02", "parallelism 0.02/", "parallelism 0.02/0",
                           "parallelism 0/100", "parallelism -0.02/100", "parallelism 0.02/100 +", "0.02/100", "IT8",
                           "parallelism 100/100", "parallelism 0.02/100 A", "Parallelism 0.02/100"}) {
    expect_refused(text, "alpha2", {"\"parallelism T/L\" (bar at the elbow to the motor axis"});
  }
  for (const char* text : {"", "position", "position dia", "position 0", "position dia -1", "dia 0.05", "0.05",
                           "position 0.05/100", "position dia 0.05 dia 0.05", "IT8"}) {
    expect_refused(text, "e_y", {"\"position dia T\" (base joint)"});
  }
}

TEST(DrawingStatement, WhyItCannotBeIsSaid) {
  expect_refused("H7", "arm_length", {"of a fit"});
  expect_refused("perpendicularity 0.02/100", "alpha2", {"this does not limit the rotation"});
  expect_refused("angularity 0.02/100", "alpha2", {"angularity does not apply"});
  expect_refused("parallelism 0.02/100", "beta0", {"this does not limit the rotation"});
  expect_refused("IT0", "rod_mean", {"ISO 286-1 has no IT0 at 950 mm"});
  expect_refused("IT8 IT7", "arm_length", {"remove \"IT7\""});
  expect_refused("IT8", "theta_offset", {"an encoder's zero is set on the machine"});
  expect_refused("IT8", "theta_offset", {"an endstop is set on the machine"}, catalogue::linear_delta());
  expect_refused("IT8", "gain", {"lead"}, of_kind("hexapod"));
  expect_refused("IT8", "gain", {"lead"}, catalogue::linear_delta());
}

/// What has no length has limits, but no grade.
TEST(DrawingStatement, ALengthOfNothingHasNoGrade) {
  const DrawnFeature drawn{.kind = DrawnFeature::Kind::size, .name = "offset", .sizes = {0.0}};
  EXPECT_THAT([&] { half_width_of("IT8", drawn); },
              testing::ThrowsMessage<InvalidArgument>(testing::HasSubstr("ISO 286-1 has no IT8 at 0 mm")));
  EXPECT_EQ(half_width_of("0 +- 0.1", drawn), 0.1);
  EXPECT_EQ(on_a_drawing(0.1, drawn).text, "offset 0 +- 0.1");
}

TEST(DrawingStatement, UnlikeLimbsHaveGradesOfTheirOwnSizes) {
  const Robot robot = unlike();
  EXPECT_DOUBLE_EQ(half_width("IT7", "rod_mean", robot), 0.105 / 2);  // 1003 mm, the wider one
  expect_refused("998 +- 0.04", "rod_mean", {"998 to 1003 mm", "the limbs differ"}, robot);
  const DrawingStatement said = on_a_drawing(0.105 / 2, feature("rod_mean", robot));
  EXPECT_EQ(said.statement, "IT7");
  EXPECT_EQ(said.text, "joint distance of each rod +- 0.0525 (IT7)");
  EXPECT_EQ(on_a_drawing(0.1 / 2, feature("rod_mean", robot)).grade, StandardGrade::IT6);
  EXPECT_THAT(on_a_drawing(1e-4, feature("rod_mean", robot)).statement, IsEmpty());
  EXPECT_EQ(half_width("400 +- 0.04", "arm_length", robot), 0.04);
}

TEST(DrawingStatement, SizesAreThatOfEachLimbAsItIsMeantToBe) {
  RobotDescription description = catalogue::rotary_delta().description();
  test::redimension(description, [&](SharedDimensions& shared) { shared.differences(1, "rod_mean") = -5.0; });
  test::redimension(description, [&](SharedDimensions& shared) { shared.differences(2, "arm_length") = 2.0; });
  const Robot robot(description);
  EXPECT_THAT(feature("arm_length", robot).sizes, testing::ElementsAre(400.0, 402.0));
  EXPECT_THAT(feature("rod_mean", robot).sizes, testing::ElementsAre(945.0, 950.0));
  EXPECT_THAT(feature("rod_difference", robot).sizes, testing::ElementsAre(945.0, 950.0));
  EXPECT_THAT(feature("width_difference", robot).sizes, testing::ElementsAre(100.0));
}

/// A grade that one of the sizes does not have is none of theirs.
TEST(DrawingStatement, AGradeIsOneOfEverySize) {
  const DrawnFeature drawn{.kind = DrawnFeature::Kind::size, .name = "rod", .sizes = {1.0, 400.0}};
  const DrawingStatement said = on_a_drawing(1.0, drawn);
  EXPECT_EQ(said.statement, "IT13");
  EXPECT_DOUBLE_EQ(half_width_of(said.statement, drawn), 0.89 / 2);
}

TEST(DrawingStatement, WhatIsExactIsNotOnADrawing) {
  const Robot robot = catalogue::linear_delta();
  Tolerances tolerances = *robot.tolerances();
  EXPECT_TRUE(on_a_drawing(tolerances, "rod_mean", robot));
  tolerances["rod_mean"] = 0.0;
  EXPECT_FALSE(on_a_drawing(tolerances, "rod_mean", robot));
}

TEST(DrawingStatement, HugeTurnsHaveAZoneThatReadsBack) {
  for (const double turn : {1.0, std::numbers::pi / 2, 3.0}) {
    const DrawnFeature drawn = feature("alpha2");
    EXPECT_LE(half_width_of(on_a_drawing(turn, drawn).statement, drawn), 1.0) << turn;
  }
}

/// Every error of every kind of limb: a feature, and ways to state it.
TEST(DrawingStatement, LimbsWithOneRodHaveFeatures) {
  const Robot strut = of_kind("hexapod"), arm = of_kind("6-rss"), rail = of_kind("6-pss");
  EXPECT_DOUBLE_EQ(half_width("position dia 2", "base_z", strut), 1.0);
  EXPECT_DOUBLE_EQ(half_width("position dia 2", "plate_z", strut), 1.0);
  EXPECT_DOUBLE_EQ(half_width("110 +- 0.1", "arm_length", arm), 0.1);
  EXPECT_DOUBLE_EQ(half_width("280 +- 0.1", "rod_length", arm), 0.1);
  EXPECT_DOUBLE_EQ(half_width("perpendicularity 0.1/100", "alpha0", arm), std::asin(0.001));
  EXPECT_DOUBLE_EQ(half_width("angularity 0.1/100", "beta0", rail), std::asin(0.001));
  EXPECT_DOUBLE_EQ(half_width("position 0.1", "normal", rail), 0.05);
  EXPECT_DOUBLE_EQ(half_width("position 0.1", "across", rail), 0.05);
  EXPECT_DOUBLE_EQ(half_width("position 0.1", "plate_x", rail), 0.05);
  expect_refused("IT8", "zero", {"zero"}, arm);
  EXPECT_DOUBLE_EQ(half_width("IT9", "zero", strut),
                   *standard_tolerance(StandardGrade::IT9, strut.limbs()[0].length) / 2);
}

TEST(DrawingStatement, RailsAreSquareToTheirBase) {
  const Robot robot = catalogue::linear_delta();
  EXPECT_EQ(text_of(0.001, "alpha0", robot), "rail: perpendicularity 0.0999/100 to the base plane, seen radially");
  EXPECT_EQ(text_of(0.001, "beta0", robot), "rail: perpendicularity 0.0999/100 to the base plane, seen from the side");
  EXPECT_EQ(text_of(0.001, "alpha2", robot), "bar on the carriage: perpendicularity 0.0499/50 to the rail");
  EXPECT_EQ(text_of(0.1, "e_x", robot), "foot of the rail: position dia 0.2");
}

TEST(DrawingStatement, AHalfWidthInWords) {
  EXPECT_EQ(text_of(0.0446, "arm_length"), "bore distance of the arm 375 +- 0.0446 (IT8)");
  EXPECT_EQ(text_of(0.0444, "arm_length"), "bore distance of the arm 375 +- 0.0444 (IT7)");
  EXPECT_EQ(text_of(0.0223, "rod_difference"), "joint distance of both rods 950 +- 0.0111 (IT3, finer than IT5)");
  EXPECT_EQ(text_of(0.001, "rod_difference"), "joint distance of both rods 950 +- 0.0005 (finer than any grade)");
  EXPECT_EQ(text_of(0.245e-3, "alpha2"),
            "bar at the elbow: parallelism 0.0244/100 to the motor axis, seen along the arm");
  EXPECT_EQ(text_of(0.0125, "arm_length"), "bore distance of the arm 375 +- 0.0125 (IT5)");
  EXPECT_EQ(text_of(0.0124, "arm_length"), "bore distance of the arm 375 +- 0.0124 (IT4, finer than IT5)");
  EXPECT_EQ(text_of(0.1, "e_z"), "base joint: position dia 0.2");
  EXPECT_EQ(text_of(0.1, "theta_offset"), "an encoder's zero is set on the machine");
  EXPECT_THAT(on_a_drawing(0.1, feature("theta_offset")).statement, IsEmpty());
}

/// The bars are as long as the parallelogram is wide; how long other features are the robot does not say.
TEST(DrawingStatement, TheLengthIsTheParallelogramsWidthWhereItIsABars) {
  RobotDescription description = catalogue::huang2016().description();
  test::redimension(description, [&](SharedDimensions& shared) { shared.parallelogram_width = 60.0; });
  const Robot robot(description);
  EXPECT_EQ(text_of(1e-3, "beta2", robot), "bar at the elbow: perpendicularity 0.0599/60 to the arm");
  EXPECT_EQ(text_of(1e-3, "beta03", robot),
            "bar at the plate: perpendicularity 0.0599/60 to the limb's radial direction");
  EXPECT_EQ(text_of(1e-3, "alpha0", robot), "motor axis: parallelism 0.0999/100 to the base plane");
}

const std::vector<Robot>& robots() {
  static const std::vector<Robot> all{catalogue::huang2016(), catalogue::linear_delta(), unlike(),
                                      of_kind("hexapod"),     of_kind("6-rss"),          of_kind("6-pss")};
  return all;
}

/// What is printed reads back, is never wider, and narrower by less than a half of its last digit's unit lets it be.
RC_GTEST_PROP(DrawingStatement, ReadsBackNeverWider, ()) {
  const Robot& robot = robots()[*rc::gen::inRange<std::size_t>(0, robots().size())];
  const std::span<const Source> sources = sources_of(robot.actuator());
  const DrawnFeature drawn = feature(sources[*rc::gen::inRange<std::size_t>(0, sources.size())], robot);
  const double asked = std::pow(10.0, *rc::gen::inRange(-4000, 0) / 1000.0);
  const DrawingStatement said = on_a_drawing(asked, drawn);
  RC_ASSERT(!said.text.empty());
  RC_ASSERT(said.statement.empty() ==
            (drawn.kind == DrawnFeature::Kind::none || (drawn.sizes.size() > 1 && !said.grade.has_value())));
  if (said.statement.empty()) return;
  const double read = half_width_of(said.statement, drawn);
  RC_ASSERT(read <= asked * (1.0 + 2e-12));
  if (drawn.sizes.size() <= 1) RC_ASSERT(read >= 0.98 * asked);
}

/// A half-width that came from a statement comes out as that statement.
RC_GTEST_PROP(DrawingStatement, ThreeDigitsComeBack, ()) {
  const int digits = *rc::gen::inRange(100, 1000), power = *rc::gen::inRange(3, 7);
  const std::string number = fmt::format("{:.12g}", digits * std::pow(10.0, -power));
  const auto back = [](const std::string& text, Source source) {
    const DrawnFeature drawn = feature(source);
    return on_a_drawing(half_width_of(text, drawn), drawn).statement;
  };
  for (const auto& [text, source] :
       std::initializer_list<std::pair<std::string, Source>>{{"375 +- " + number, Source("arm_length")},
                                                             {"950 +- " + number, Source("rod_difference")},
                                                             {"parallelism " + number + "/100", Source("alpha2")},
                                                             {"position dia " + number, Source("e_x")}}) {
    RC_ASSERT(back(text, source) == text);
  }
}

/// The grade beside a half-width is within it, and the next coarser one is not.
RC_GTEST_PROP(DrawingStatement, TheGradeIsTheCoarsestWithin, ()) {
  const double asked = std::pow(10.0, *rc::gen::inRange(-3000, 500) / 1000.0);
  for (const Source source :
       {Source("arm_length"), Source("rod_mean"), Source("rod_difference"), Source("width_difference")}) {
    const DrawnFeature drawn = feature(source);
    const std::optional<StandardGrade> grade = on_a_drawing(asked, drawn).grade;
    if (grade) RC_ASSERT(half_width_of(name(*grade), drawn) <= asked * (1.0 + 2e-12));
    if (grade == StandardGrade::IT18) continue;
    const double size = drawn.sizes.front();
    const auto next = grade ? static_cast<StandardGrade>(static_cast<int>(*grade) + 1)
                            : (size > 500.0 ? StandardGrade::IT1 : StandardGrade::IT01);
    RC_ASSERT(half_width_of(name(next), drawn) > asked);
  }
}

}  // namespace
}  // namespace paracal::drawing_statement_test
