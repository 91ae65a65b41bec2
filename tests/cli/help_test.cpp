// What the program says of itself: help, topics, wrong usage, colours.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <regex>
#include <sstream>

#include "run_program.hpp"
#include "support/places.hpp"
#include "terminal.hpp"

namespace paracal::test::help_test {
namespace {

using testing::AllOf, testing::HasSubstr, testing::IsEmpty, testing::Not, testing::StartsWith;

TEST(Help, GroupsOptionsByPurpose) {
  const std::string help = run_program(words("calibrate --help")).out;
  for (const char* heading : {"Measurements", "Tables (CSV)", "Uncertainty of the instrument", "Temperature", "Frames",
                              "Controller", "Limits", "Fit", "Results", "Common", "Examples"}) {
    EXPECT_THAT(help, HasSubstr(fmt::format("\n\n{}", heading)));
  }
  EXPECT_THAT(help, AllOf(HasSubstr("  --limit-mm MM "), HasSubstr("--stage rough|fine|auto"),
                          HasSubstr("--measurements FILE ..."), HasSubstr("(default: auto)")));
  EXPECT_THAT(help, Not(testing::AnyOf(HasSubstr("TEXT"), HasSubstr("FLOAT"), HasSubstr("--printer"))));
}

TEST(Help, ShowsWhatACommandRequires) {
  EXPECT_THAT(run_program(words("validate --help")).out,
              HasSubstr("Usage: paracal validate --calibration FILE --measurements FILE ... [OPTIONS]\n"));
  EXPECT_THAT(run_program(words("printer --help")).out, HasSubstr("Usage: paracal printer CONFIGURATION [OPTIONS]\n"));
}

TEST(Help, KeepsWithinTheLine) {
  for (const std::string command : {"", "export ", "tolerance allocate ", "poses "}) {
    std::istringstream lines(run_program(words(command + "--help")).out);
    const std::regex breaks("  .{28,}|.*paracal .*");  // a name of its own line, a command line
    for (std::string line; std::getline(lines, line);) {
      EXPECT_TRUE(line.size() <= 80 || std::regex_match(line, breaks)) << line;
    }
  }
}

TEST(Help, ExplainsCommandsAndTopics) {
  EXPECT_EQ(run_program(words("help tolerance analyze")).out, run_program(words("tolerance analyze --help")).out);
  EXPECT_EQ(run_program(words("help")).out, run_program(words("--help")).out);
  EXPECT_THAT(run_program(words("help terms")).out, HasSubstr("expanded uncertainty (k = 2)"));
  EXPECT_THAT(run_program(words("help files")).out, HasSubstr("# robot: NAME"));
  EXPECT_THAT(run_program(words("help units")).out, HasSubstr("Lengths are in mm"));
  const ProgramResult unknown = run_program(words("help term"));
  EXPECT_EQ(unknown.exit_code, kWrongUsage);
  EXPECT_EQ(unknown.err,
            "paracal: help: expected a command or a topic (files, terms, units), got term (did you mean terms?)\n");
}

TEST(Usage, IsExplainedInOurWords) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"validate --calibration c.json", "expected --measurements FILE ..., got none; see paracal validate --help"},
      {"calibrate --measurements", "--measurements: expected FILE ..., got no value"},
      {"calibrate --limit-mm wide", "--limit-mm: expected a number, got wide"},
      {"calibrate --apply", "--apply: expected --printer with it, got none"},
      {"robot --printer a.cfg --robot b", "expected --robot or --printer, got both"},
      {"poses --candidates 5", "--candidates: expected --optimal with it, got none"},
      {"poses --seed 1 --seed 2", "--seed: expected it once, got it 2 times"},
      {"poses --optimal 9 --tracker 1,2", "--tracker: expected 3 values (X,Y,Z), got 2"},
      {"error-model --pose 1,2", "--pose: expected 3 to 6 values (X,Y,Z[,PHI]), got 2"},
      {"robot --json=maybe", "--json: expected no value, got one"},
      {"tolerance", "expected one of its commands, got none; see paracal tolerance --help"},
      {"reproduce", "expected PAPER, got none"},
      {"", "expected a command, got none; see paracal --help"}};
  for (const auto& [command, message] : cases) {
    const ProgramResult result = run_program(words(command));
    EXPECT_EQ(result.exit_code, kWrongUsage) << command;
    EXPECT_THAT(result.err, StartsWith("paracal: " + message));
    EXPECT_THAT(result.out, IsEmpty());
  }
}

TEST(PlainPrinterCommand, DoesWhatCalibrateDoesWithAPrinter) {
  const std::string file = source_folder() / "samples/printer.cfg",
                    readings = source_folder() / "samples/bed_distances.csv";
  const ProgramResult result =
      run_program({"printer", file, "--readings", readings, "--json"}, {.environment = {"SOURCE_DATE_EPOCH=0"}});
  const ProgramResult same = run_program({"calibrate", "--printer", file, "--readings", readings, "--json"},
                                         {.environment = {"SOURCE_DATE_EPOCH=0"}});
  EXPECT_EQ(result.exit_code, same.exit_code) << result.err;
  EXPECT_THAT(result.out, HasSubstr("\"printer\""));
  EXPECT_EQ(result.out, same.out);
}

/// What a terminal shows of a command.
std::string shown(const std::string& command, const std::vector<std::string>& environment) {
  const Terminal terminal;
  (void)run_program(
      words(command),
      {.environment = environment, .standard_output = terminal.path(), .standard_error = terminal.path()});
  return terminal.written();
}

TEST(Colours, AreForTerminalsThatWantThem) {
  const std::string colour = "TERM=xterm", bold_usage = "\x1b[1mUsage:\x1b[0m";
  EXPECT_THAT(shown("tolerance --help", {colour, "NO_COLOR="}), HasSubstr(bold_usage));
  EXPECT_THAT(shown("inverse", {colour, "NO_COLOR="}), StartsWith("\x1b[1m\x1b[31mparacal:\x1b[0m expected --poses"));
  for (const std::vector<std::string>& plain :
       {std::vector{colour, std::string("NO_COLOR=1")}, std::vector{std::string("TERM=dumb")}}) {
    EXPECT_THAT(shown("tolerance --help", plain), AllOf(HasSubstr("Usage:"), Not(HasSubstr("\x1b"))));
    EXPECT_THAT(shown("inverse", plain), Not(HasSubstr("\x1b")));
  }
  EXPECT_THAT(run_program(words("tolerance --help"), {.environment = {colour}}).out, Not(HasSubstr("\x1b")));
}

TEST(Colours, OfACalibrationMarkItsVerdict) {
  const std::string data = source_folder() / "data/huang2016/";
  const std::string text =
      shown("calibrate --robot huang2016 --measurements " + data + "distances.csv --poses " + data + "poses.csv",
            {"TERM=xterm"});
  EXPECT_THAT(text, HasSubstr("\x1b[1m\x1b[32mcalibration of huang2016: accepted\x1b[0m"));
  const TemporaryFolder folder;
  folder.make({"poses --stage rough --out plan.csv", "simulate --poses plan.csv --frame random --out points.csv",
               "calibrate --measurements points.csv --out calibration.json"});
  const std::string rejected = shown("validate --calibration " + (folder.path() / "calibration.json").string() +
                                         " --measurements " + (folder.path() / "points.csv").string() + " --limit-mm 1",
                                     {"TERM=xterm"});
  EXPECT_THAT(rejected, StartsWith("\x1b[1m\x1b[31mvalidation: not accepted\x1b[0m"));
}

}  // namespace
}  // namespace paracal::test::help_test
