// Tolerance design as a designer goes through it: sensitivities, an allocation that is written to a file, an analysis
// of that file; and what each command refuses.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "broken_input.hpp"
#include "json_checks.hpp"

namespace paracal::test::tolerance_commands_test {
namespace {

using nlohmann::json;
using testing::AllOf, testing::HasSubstr, testing::IsEmpty, testing::Not, testing::SizeIs;

const std::vector<std::string> kTiltKeys{
    "rod_difference_over_c", "width_difference_over_c", "alpha03", "beta03", "alpha2", "beta2"};

const std::string kProblem =
    "[[requirement]]\n"
    "quantity = \"tilt\"\n"
    "limit_rad = 0.001\n"
    "[[requirement]]\n"
    "quantity = \"position-compensated\"\n"
    "limit_mm = 0.4\n"
    "criterion = \"worst-case\"\n"
    "[cost.rod_difference_mm]\n"
    "B = 0.02\n"
    "lower = 0.002\n"
    "upper = 0.2\n"
    "[cost.alpha2_deg]\n"
    "law = \"grades\"\n"
    "grade = [{ name = \"milled\", tolerance = 0.02, cost = 3 }, { name = \"ground\", tolerance = 0.005, cost = 8 }]\n"
    "[cost.alpha03_deg]\n"
    "law = \"exponential\"\n"
    "B = 5.0\n"
    "C = 0.01\n"
    "lower = 0.002\n"
    "upper = 0.1\n";

class ToleranceCommands : public testing::Test {
 protected:
  json json_from(const std::string& command, int exit_code = kDone) const {
    return json_of(folder.run(command + " --json"), exit_code);
  }
  /// What one run prints for people, and the same as JSON, which its page holds.
  std::pair<std::string, json> both_from(const std::string& command) const {
    const ProgramResult result = folder.run(command + " --report page.html");
    EXPECT_EQ(result.exit_code, kDone) << command << ": " << result.err;
    const json results = data_in(folder.read("page.html")).at("results");
    return {result.out, results.begin().value()};
  }

  const TemporaryFolder folder;
};

TEST_F(ToleranceCommands, SensitivityKeys) {
  const json found = json_from("sensitivity");
  for (const std::string& key : kTiltKeys) {
    EXPECT_GT(found.at("global").at(key).get<double>(), 0.1) << key;
    EXPECT_GE(found.at("global_error").at(key).get<double>(), 0.0) << key;
    EXPECT_GE(found.at("largest").at(key).get<double>(), found.at("global").at(key).get<double>()) << key;
  }
  double sum = 0.0;
  for (const json& one : found.at("contributors")) sum += one.at("share").get<double>();
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST_F(ToleranceCommands, SensitivityAtAPoseAndItsMap) {
  const json found = json_from("sensitivity --quantity position-compensated --pose 0,0,-888,0 --map map.csv");
  EXPECT_EQ(found.at("local").at("theta_offset").get<double>(), 0.0);
  EXPECT_GT(found.at("local").at("alpha2").get<double>(), 0.0);
  const std::string map = folder.read("map.csv");
  EXPECT_EQ(std::ranges::count(map, '\n'), 1 + 5 * (1 + 20 * 72));
  EXPECT_THAT(map, HasSubstr("x_mm,y_mm,z_mm,phi_deg,radius_mm,three_sigma_position_compensated_mm\n"));
}

TEST_F(ToleranceCommands, AllocateGivesTable2) {
  const json found = json_from("tolerance allocate");
  const std::vector<double> table2{0.22e-3, 0.90e-3, 0.26e-3, 0.52e-3, 0.25e-3, 0.84e-3};
  for (std::size_t k = 0; k < kTiltKeys.size(); ++k) {
    EXPECT_NEAR(found.at("tolerances").at(kTiltKeys[k]).get<double>() / table2[k], 1.0, 0.06) << kTiltKeys[k];
  }
  EXPECT_EQ(found.at("max_tilt_3sigma").get<double>(), 1e-3);
  EXPECT_GT(found.at("cost").get<double>(), 0.0);
}

/// What allocate writes, analyze reads: with the true maximum the root of the sum of squares is the limit.
TEST_F(ToleranceCommands, AnAllocationKeepsItsLimit) {
  ASSERT_EQ(folder.run("tolerance allocate --bound true-maximum --max-tilt 0.002 --toml chosen.toml").exit_code, kDone);
  const json found = json_from("tolerance analyze --failure-error 0.5 --tolerances chosen.toml --max-tilt 0.002");
  EXPECT_NEAR(found.at("rss_3sigma").get<double>(), 2e-3, 1e-6);
  EXPECT_GT(found.at("worst_case").get<double>(), 2e-3);
  EXPECT_NEAR(found.at("monte_carlo_3sigma").get<double>(), 2e-3, 0.05e-3);
  EXPECT_LE(found.at("yield").at("low").get<double>(), found.at("yield").at("value").get<double>());
  EXPECT_THAT(found.at("contributors"), Not(IsEmpty()));
}

TEST_F(ToleranceCommands, TheLimitOnTiltJudgesTilt) {
  const auto judged = [&](const std::string& limit) {
    return json_from("tolerance analyze --sigma-error 0.2 --failure-error 0.5 --max-tilt " + limit);
  };
  const json usual = judged("0.001");
  ASSERT_THAT(usual.at("requirements"), SizeIs(1));
  EXPECT_EQ(usual.at("requirements")[0].at("quantity"), "tilt");
  EXPECT_EQ(usual.at("requirements")[0].at("limit"), 1e-3);
  const double largest = usual.at("requirements")[0].at("worst_case");
  EXPECT_EQ(judged(json(largest).dump()).at("yield").at("value"), 1.0);
  EXPECT_EQ(judged("1e-6").at("yield").at("value"), 0.0);
}

/// An angle in rad, in deg, or as drawings state it: the same limit, and one of them at a time.
TEST_F(ToleranceCommands, ALimitOnTiltIsInRadDegOrMmOverALength) {
  const auto limit = [&](const std::string& options) {
    return json_from("tolerance analyze --sigma-error 0.2 --failure-error 0.5" + options)
        .at("requirements")[0]
        .at("limit")
        .get<double>();
  };
  const auto allocated = [&](const std::string& options) {
    return json_from("tolerance allocate" + options).at("max_tilt_3sigma").get<double>();
  };
  for (const auto& asked : {std::function(limit), std::function(allocated)}) {
    EXPECT_EQ(asked(""), 0.001);
    EXPECT_EQ(asked(" --max-tilt 0.002"), 0.002);
    EXPECT_NEAR(asked(" --max-tilt-deg 0.1"), 0.1 * std::numbers::pi / 180.0, 1e-15);
    EXPECT_NEAR(asked(" --max-tilt-mm 0.2/100"), std::asin(0.002), 1e-15);
  }
  const json tight = json_from("tolerance allocate --max-tilt-deg 0.1 --least-mm 0.02/100");
  EXPECT_EQ(tight.at("tolerances"), json_from("tolerance allocate --max-tilt-deg 0.1 --least-deg " +
                                              json(std::asin(0.0002) * 180.0 / std::numbers::pi).dump())
                                        .at("tolerances"));
  folder.write("problem.toml", kProblem);
  for (const char* two :
       {"allocate --max-tilt 0.001 --max-tilt-deg 0.1", "allocate --max-tilt-deg 0.1 --max-tilt-mm 0.1/100",
        "allocate --least 0.001 --least-mm 0.1/100", "analyze --max-tilt 0.001 --max-tilt-mm 0.1/100",
        "analyze --problem problem.toml --max-tilt-deg 0.1", "allocate --problem problem.toml --max-tilt-mm 0.1/100",
        "allocate --problem problem.toml --least-deg 0.1"}) {
    const ProgramResult refused = folder.run(std::string("tolerance ") + two);
    EXPECT_EQ(refused.exit_code, kWrongUsage) << two;
    EXPECT_THAT(refused.err, AllOf(HasSubstr("expected --"), HasSubstr("got both"))) << two;
  }
  for (const char* zone : {"0.1", "0.1/0", "100/0.1", "x/100"}) {
    const ProgramResult refused = folder.run(std::string("tolerance analyze --max-tilt-mm ") + zone);
    EXPECT_EQ(refused.exit_code, kWrongUsage) << zone;
    EXPECT_THAT(refused.err, AllOf(HasSubstr("--max-tilt-mm"), HasSubstr("0.1/100"), HasSubstr(zone)));
  }
}

TEST_F(ToleranceCommands, ALimitOnTheTiltOfABatchIsInRadDegOrMmOverALength) {
  const auto limit = [&](const std::string& options) {
    return json_from("yield --machines 1 " + options).at("batch").at("limits").at("tilt_rad").get<double>();
  };
  EXPECT_EQ(limit("--max-tilt-rad 0.002"), 0.002);
  EXPECT_NEAR(limit("--max-tilt-deg 0.1"), 0.1 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_NEAR(limit("--max-tilt-mm 0.2/100"), std::asin(0.002), 1e-15);
  EXPECT_EQ(folder.run("yield --machines 1 --max-tilt-rad 0.01 --max-tilt-deg 0.1").exit_code, kWrongUsage);
}

/// Of one command, in the text, that the same limit in rad gives in rad.
TEST_F(ToleranceCommands, ALimitIsAnsweredInItsUnit) {
  const auto text = [&](const std::string& command) { return folder.run(command).out; };
  const std::string in_deg = text("tolerance allocate --max-tilt-deg 0.0572957795");
  EXPECT_THAT(in_deg, AllOf(HasSubstr(" 3 sigma), deg\n"), HasSubstr("alpha2                       0.014\n"),
                            HasSubstr("tilt (statistical): 0.05143 of 0.0573 deg at"), Not(HasSubstr("mrad")),
                            Not(HasSubstr(" rad "))));
  const std::string over_a_length = text("tolerance allocate --max-tilt-mm 0.2/200");
  EXPECT_THAT(over_a_length,
              AllOf(HasSubstr(" 3 sigma), mm over 200 mm\n"), HasSubstr("alpha2                       0.049\n"),
                    HasSubstr("tilt (statistical): 0.1795 of 0.2 mm over 200 mm at")));
  EXPECT_THAT(text("tolerance allocate --max-tilt 0.001"),
              AllOf(HasSubstr("), mrad\n"), HasSubstr("alpha2                      0.245\n"),
                    HasSubstr("tilt (statistical): 0.0008976 of 0.001 rad at")));
  const std::string few = " --sigma-error 0.2 --failure-error 0.5";
  EXPECT_THAT(text("tolerance analyze --max-tilt-deg 0.05" + few), HasSubstr("\ntilt, deg: limit 0.05\n"));
  EXPECT_THAT(text("yield --machines 1 --max-tilt-mm 1/100"), HasSubstr("\n  tilt, mm over 100 mm"));
  folder.write("problem.toml", replaced(kProblem, "limit_rad = 0.001", "limit_deg = 0.05"));
  EXPECT_THAT(text("tolerance allocate --problem problem.toml"),
              AllOf(HasSubstr(" of 0.05 deg at"), HasSubstr(" of 0.4 mm at")));
  EXPECT_THAT(text("tolerance analyze --problem problem.toml" + few), HasSubstr("\ntilt, deg: limit 0.05\n"));
}

/// Two digits, never wider; what was stated stays as it was.
TEST_F(ToleranceCommands, ChosenTolerancesArePrintedAsADrawingStatesThem) {
  folder.write("stated.toml", "alpha0_deg = \"parallelism 0.02/100\"\ne_mm = 0.1234567\nothers = \"generous\"\n");
  const std::string printed =
      folder.run("tolerance allocate --bound true-maximum --tolerances stated.toml --toml chosen.toml").out;
  EXPECT_THAT(printed, AllOf(HasSubstr("\ne_mm = 0.1234567 "), HasSubstr("parallelism 0.02/100 to the base plane"),
                             HasSubstr("\nalpha2_deg = 0.015 ")));
  folder.write("printed.toml", printed.substr(printed.find("[tolerances]")));
  const json half_widths = json_from("sensitivity --tolerances chosen.toml").at("half_widths"),
             rounded = json_from("sensitivity --tolerances printed.toml").at("half_widths");
  int smaller = 0;
  for (const auto& [key, value] : half_widths.items()) {
    if (!value.is_number()) continue;
    EXPECT_LE(rounded.at(key).get<double>(), value.get<double>()) << key;
    EXPECT_GT(rounded.at(key).get<double>(), 0.9 * value.get<double>()) << key;
    smaller += rounded.at(key) != value;
  }
  EXPECT_EQ(smaller, 6);
}

TEST_F(ToleranceCommands, AProblemOfSeveralRequirements) {
  folder.write("problem.toml", kProblem);
  const json found = json_from("tolerance allocate --problem problem.toml --toml chosen.toml");
  EXPECT_EQ(found.at("status"), "optimal");
  ASSERT_THAT(found.at("requirements"), SizeIs(2));
  EXPECT_LE(found.at("requirements")[0].at("worst_rad").get<double>(), 1e-3 * (1 + 2e-6));
  EXPECT_LE(found.at("requirements")[1].at("worst_mm").get<double>(), 0.4 * (1 + 2e-6));
  const double alpha2 = found.at("half_widths").at("alpha2_deg").get<double>();
  EXPECT_TRUE(alpha2 == 0.02 || alpha2 == 0.005) << alpha2;
  const json analysis =
      json_from("tolerance analyze --failure-error 0.5 --tolerances chosen.toml --problem problem.toml");
  EXPECT_THAT(analysis.at("requirements"), SizeIs(2));
}

/// What an allocation is on a drawing, put into a table, gives tolerances that are nowhere wider; its own file gives
/// the same.
TEST_F(ToleranceCommands, WhatIsSaidOfADrawingReadsBackNeverWider) {
  folder.write("problem.toml", kProblem);
  for (const char* command : {"tolerance allocate", "tolerance allocate --problem problem.toml"}) {
    const json chosen = json_from(command + std::string(" --toml chosen.toml"));
    std::string table;
    for (const auto& [key, value] : chosen.at("half_widths").items()) {
      if (!value.is_number()) continue;
      const json& statement = chosen.at("drawing").at(key).at("statement");
      EXPECT_EQ(statement.is_null(), key == "theta_offset_deg") << key;
      table += key + " = " + (statement.is_null() ? value : statement).dump() + "\n";
    }
    folder.write("drawn.toml", table);
    const auto half_widths = [&](const std::string& file) {
      return json_from("tolerance analyze --sigma-error 0.2 --failure-error 0.5 --tolerances " + file)
          .at("half_widths");
    };
    const json drawn = half_widths("drawn.toml");
    for (const auto& [key, value] : drawn.items()) {
      if (!value.is_number()) continue;
      const double allowed = chosen.at("half_widths").at(key);
      EXPECT_LE(value.get<double>(), allowed * (1.0 + 1e-11)) << key;
      EXPECT_GE(value.get<double>(), 0.98 * allowed) << key;
    }
    EXPECT_EQ(half_widths("chosen.toml"), chosen.at("half_widths"));
  }
}

TEST_F(ToleranceCommands, EachHalfWidthStandsBesideWhatItIsOnADrawing) {
  const std::string rods = "# joint distance of both rods 950 +- 0.011 (IT3, finer than IT5)\n";
  const std::string bar = "# bar at the elbow: parallelism 0.0249/100 to the motor axis, seen along the arm\n";
  for (const char* command : {"sensitivity", "tolerance analyze --sigma-error 0.2 --failure-error 0.5"}) {
    const auto [text, found] = both_from(command);
    EXPECT_THAT(text, AllOf(HasSubstr("rod_difference_mm = 0.022 "), HasSubstr(rods), HasSubstr(bar))) << command;
    const json& drawing = found.at("drawing").at("rod_difference_mm");
    EXPECT_EQ(drawing.at("statement"), "950 +- 0.011") << command;
    EXPECT_EQ(drawing.at("grade"), "IT3") << command;
    EXPECT_EQ("# " + drawing.at("text").get<std::string>() + "\n", rods) << command;
  }
  const ProgramResult allocated = folder.run("tolerance allocate --toml chosen.toml");
  EXPECT_THAT(allocated.out, HasSubstr("# bore distance of the arm 375 +- 0.8 (IT14)\n"));
  EXPECT_THAT(folder.read("chosen.toml"), HasSubstr("# bore distance of the arm 375 +- 0.8 (IT14)\n"));
}

TEST_F(ToleranceCommands, WhatCannotBeMadeIsAVerdict) {
  const ProgramResult result = folder.run("tolerance allocate --least 0.0002 --least-is sigma");
  EXPECT_EQ(result.exit_code, kVerdictIsNo);
  EXPECT_THAT(result.out, HasSubstr("infeasible"));
  EXPECT_EQ(folder.run("tolerance analyze --failure-error 0.5 --min-yield 0.9999999").exit_code, kVerdictIsNo);
}

/// A yield that no count of machines could prove.
TEST_F(ToleranceCommands, RareFailuresDecideTheYield) {
  const auto [text, found] = both_from("tolerance analyze --max-tilt 0.0016 --min-yield 0.999999999");
  const json& failure = found.at("failure");
  EXPECT_EQ(failure.at("status"), "settled");
  EXPECT_LT(failure.at("linear").at("value").get<double>(), 1e-9);
  EXPECT_EQ(found.at("yield").at("value").get<double>(), 1.0 - failure.at("exact").at("value").get<double>());
  EXPECT_EQ(found.at("yield").at("low").get<double>(), 1.0 - failure.at("exact").at("high").get<double>());
  EXPECT_EQ(found.at("requirements")[0].at("failure"), failure);
  EXPECT_THAT(text, AllOf(HasSubstr("yield 99.9999999"), HasSubstr("exact model, "), HasSubstr("second estimate")));
}

TEST_F(ToleranceCommands, EachOfSeveralLimitsHasItsOwnFailures) {
  folder.write("problem.toml",
               "[[requirement]]\nquantity = \"tilt\"\nlimit_rad = 0.0009\n"
               "[[requirement]]\nquantity = \"position\"\nlimit_mm = 30\n");
  const auto [text, found] = both_from("tolerance analyze --failure-error 0.1 --problem problem.toml");
  double sum = 0.0;
  for (const json& one : found.at("requirements")) sum += one.at("failure").at("exact").at("value").get<double>();
  const double any = found.at("failure").at("exact").at("value");
  EXPECT_NEAR(any, sum, 0.2 * sum);  // both at once are rare, and all three are known to 10 %
  EXPECT_THAT(text, HasSubstr("  failure rate  "));
}

TEST_F(ToleranceCommands, AllocationByYieldKeepsItsShare) {
  const std::string costs =
      "[cost.rod_difference_mm]\nB = 0.02\nlower = 0.002\nupper = 0.2\n[cost.alpha2_deg]\nB = 0.01\nlower = "
      "0.001\nupper = 0.2\n";
  const std::string limit = "[[requirement]]\nquantity = \"tilt\"\nlimit_rad = 0.0014\ncriterion = \"yield\"\n";
  folder.write("problem.toml", "max_failures = 1e-4\n" + limit + costs);
  const auto [text, found] =
      both_from("tolerance allocate --robot rotary_delta --problem problem.toml --toml chosen.toml");
  EXPECT_EQ(found.at("status"), "optimal");
  EXPECT_EQ(found.at("requirements")[0].at("criterion"), "yield");
  EXPECT_LE(found.at("failure").at("exact").at("high").get<double>(), 1e-4);
  EXPECT_GT(found.at("failure_price").get<double>(), 0.0);
  EXPECT_THAT(text, AllOf(HasSubstr("  failure rate  "), HasSubstr("twice the failure rate would save")));
  const json analysis = json_from("tolerance analyze --robot rotary_delta --tolerances chosen.toml --max-tilt 0.0014");
  // The upper end of one interval is the share or a little below; other machines know it to a twentieth, too.
  const double share = analysis.at("failure").at("exact").at("value");
  EXPECT_LT(share, 1.05e-4);
  EXPECT_GT(share, 0.7e-4);
  const auto refused = [&](const std::string& file, const std::string& message) {
    folder.write("problem.toml", file);
    const ProgramResult result = folder.run("tolerance allocate --robot rotary_delta --problem problem.toml");
    EXPECT_EQ(result.exit_code, kBadInputFile);
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  refused(limit + costs, "expected max_failures");
  refused("max_failures = 0.7\n" + limit + costs,
          "problem.toml:1: expected max_failures above 0 and below 0.5, got 0.7");
  refused("max_failures = 1e-4\n" + limit.substr(0, limit.find("criterion")) + costs, "criterion = \"yield\"");
}

TEST_F(ToleranceCommands, WhatDrawingsRuleOutIsSaid) {
  folder.write("drawn.toml", "others = \"exact\"\ndistribution = \"uniform\"\nalpha2_deg = 0.001\n");
  const auto [text, found] =
      both_from("tolerance analyze --tolerances drawn.toml --sigma-error 0.1 --failure-error 0.5");
  EXPECT_EQ(found.at("failure").at("status"), "impossible");
  EXPECT_EQ(found.at("yield").at("value"), 1.0);
  EXPECT_THAT(text, HasSubstr("no machine within its tolerances can fail"));
}

TEST_F(ToleranceCommands, ThreadsDoNotChangeTheResult) {
  const std::string command =
      "tolerance analyze --model exact --sigma-error 0.2 --failure-error 0.5 --sobol 32 --json --threads ";
  const ProgramResult one = folder.run(command + "1"), two = folder.run(command + "2");
  ASSERT_EQ(one.exit_code, kDone) << one.err;
  EXPECT_EQ(one.out, two.out);
  EXPECT_THAT(one.err, IsEmpty());
}

TEST_F(ToleranceCommands, MeasuredPartsReplaceTheDistribution) {
  folder.write("parts.toml", "others = \"exact\"\nalpha2_deg = 0.02\n[measured]\nalpha2_deg = [0.01, 0.012, 0.011]\n");
  const json shifted = json_from("tolerance analyze --tolerances parts.toml --sigma-error 0.1 --failure-error 0.5");
  folder.write("parts.toml", "others = \"exact\"\nalpha2_deg = 0.02\n");
  const json drawn = json_from("tolerance analyze --tolerances parts.toml --sigma-error 0.1 --failure-error 0.5");
  EXPECT_LT(shifted.at("rss_3sigma").get<double>(), drawn.at("rss_3sigma").get<double>());
  EXPECT_EQ(shifted.at("worst_case"), drawn.at("worst_case"));
}

/// What was assumed stands in every result that depends on it.
TEST_F(ToleranceCommands, WhatIsAssumedIsSaid) {
  const std::string robot = " --robot rotary_delta";
  const auto done = [&](const std::string& command) {
    const ProgramResult result = folder.run(command + robot);
    EXPECT_EQ(result.exit_code, kDone) << command << ": " << result.err;
    return result.out;
  };
  done("poses --stage fine --out poses.csv");
  done("simulate --poses poses.csv --truth truth.toml --out points.csv");
  for (const char* command : {"sensitivity", "tolerance analyze --sigma-error 0.2 --failure-error 0.5",
                              "tolerance allocate", "yield --machines 1", "identifiability --poses poses.csv"}) {
    EXPECT_THAT(done(command), HasSubstr("\n  assumed: default tolerances")) << command;
  }
  for (const char* command : {"poses --optimal 5 --candidates 20", "simulate --poses poses.csv"}) {
    EXPECT_THAT(done(command), HasSubstr("# assumed: default tolerances")) << command;
  }
  for (const char* command : {"sensitivity", "tolerance analyze --sigma-error 0.2 --failure-error 0.5",
                              "tolerance allocate", "yield --machines 1", "identifiability --poses poses.csv",
                              "poses --optimal 5 --candidates 20", "simulate --poses poses.csv"}) {
    const json assumed = json_from(command + robot).at("assumed");
    ASSERT_EQ(assumed.size(), 1u) << command;
    EXPECT_THAT(assumed[0].get<std::string>(), HasSubstr("theta_offset 1.5 deg")) << command;
  }
  EXPECT_THAT(json_from("simulate --poses poses.csv --errors truth.toml" + robot).at("assumed"), IsEmpty());
}

/// What an allocation chose is not assumed any more; what it left is, in the file that it writes, too.
TEST_F(ToleranceCommands, AnAllocationStatesWhatItChose) {
  const json chosen = json_from("tolerance allocate --robot rotary_delta --toml chosen.toml").at("assumed");
  EXPECT_THAT(chosen.at(0).get<std::string>(), AllOf(HasSubstr("theta_offset"), Not(HasSubstr("alpha2"))));
  const json analysed = json_from(
      "tolerance analyze --robot rotary_delta --tolerances chosen.toml --sigma-error 0.2 --failure-error 0.5");
  EXPECT_EQ(analysed.at("assumed"), chosen);
}

TEST_F(ToleranceCommands, ARigidPlateHasNoRotation) {
  const ProgramResult result = folder.run("sensitivity --robot rotary_delta --quantity rotation");
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(result.err, HasSubstr("slide"));
  EXPECT_EQ(folder.run("tolerance allocate --robot rotary_delta").exit_code, kDone);
}

BrokenInput problem(const std::string& name, const std::string& old, const std::string& by,
                    std::vector<std::string> message) {
  return {name,
          {{"problem.toml", replaced(kProblem, old, by)}},
          "tolerance allocate --problem problem.toml",
          kBadInputFile,
          std::move(message)};
}

INSTANTIATE_TEST_SUITE_P(
    Problem, BrokenInputTest,
    testing::Values(
        problem("no_problem", kProblem, "", {"problem.toml", "[[requirement]]"}),
        problem("unknown_quantity", "\"tilt\"", "\"speed\"", {"problem.toml:2", "speed", "tilt"}),
        problem("limit_negative", "limit_rad = 0.001", "limit_rad = -1", {"problem.toml", "limit_rad", "above 0"}),
        problem("limit_of_another_unit", "limit_mm = 0.4", "limit_rad = 0.4", {"problem.toml", "limit_mm"}),
        problem("unknown_criterion", "\"worst-case\"", "\"perhaps\"", {"problem.toml:7", "statistical", "perhaps"}),
        problem("unknown_law", "\"exponential\"", "\"linear\"", {"problem.toml", "exponential", "linear"}),
        problem("cost_missing", "B = 0.02\n", "", {"problem.toml", "cost.rod_difference_mm.B"}),
        problem("cost_negative", "B = 5.0", "B = -5.0", {"problem.toml", "above 0"}),
        problem("bounds_swapped", "upper = 0.1\n", "upper = 0.001\n", {"problem.toml", "upper"}),
        problem("grade_without_cost", ", cost = 8", "", {"problem.toml", "cost"}),
        problem("unit_forgotten_in_cost", "cost.rod_difference_mm", "cost.rod_difference",
                {"problem.toml", "rod_difference"}),
        BrokenInput{"no_costs",
                    {{"problem.toml", "[[requirement]]\nquantity = \"tilt\"\nlimit_rad = 0.001\n"}},
                    "tolerance allocate --problem problem.toml",
                    kBadInputFile,
                    {"problem.toml", "cost"}},
        BrokenInput{"measured_is_text",
                    {{"parts.toml", "[measured]\nalpha2_deg = \"wide\"\n"}},
                    "tolerance analyze --tolerances parts.toml",
                    kBadInputFile,
                    {"parts.toml:2", "numbers"}},
        BrokenInput{"measured_of_nothing",
                    {{"parts.toml", "[measured]\nalpha9_deg = [1.0]\n"}},
                    "tolerance analyze --tolerances parts.toml",
                    kBadInputFile,
                    {"parts.toml:2", "alpha9_deg"}}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    ToleranceUsage, BrokenInputTest,
    testing::Values(
        BrokenInput{"tilt_zero", {}, "tolerance allocate --max-tilt 0", kWrongUsage, {"--max-tilt"}},
        BrokenInput{"analyze_nothing",
                    {{"zero.toml", "others = \"exact\"\nalpha03_deg = 0\n"}},
                    "tolerance analyze --tolerances zero.toml",
                    kBadInputFile,
                    {"zero.toml", "at least one tolerance above 0"}},
        BrokenInput{"sensitivity_to_nothing",
                    {{"zero.toml", "others = \"exact\"\n"}},
                    "sensitivity --tolerances zero.toml",
                    kBadInputFile,
                    {"zero.toml", "at least one tolerance above 0"}},
        BrokenInput{"tilt_nan", {}, "tolerance analyze --max-tilt nan", kWrongUsage, {"--max-tilt"}},
        BrokenInput{"unknown_bound", {}, "tolerance allocate --bound largest", kWrongUsage, {"--bound"}},
        BrokenInput{"neither_half", {}, "tolerance", kWrongUsage, {}},
        BrokenInput{"unknown_half", {}, "tolerance guess", kWrongUsage, {}},
        BrokenInput{"sensitivity_of_nothing", {}, "sensitivity --quantity speed", kWrongUsage, {"speed"}},
        BrokenInput{"sensitivity_out_of_reach", {}, "sensitivity --pose 5000,0,-888,0", kMathematicsSaysNo, {"reach"}},
        BrokenInput{"confidence_one", {}, "tolerance analyze --confidence 1", kWrongUsage, {"--confidence"}},
        BrokenInput{"sigma_error_zero", {}, "tolerance analyze --sigma-error 0", kWrongUsage, {"--sigma-error"}},
        BrokenInput{"few_sobol_samples", {}, "tolerance analyze --sobol 2", kWrongUsage, {"--sobol"}}),
    name_of);

}  // namespace
}  // namespace paracal::test::tolerance_commands_test
