// Manual pages and completions are made from the options: they say what --help says, and shells take them.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <regex>
#include <sstream>

#include "run_program.hpp"

namespace paracal::test::manual_test {
namespace {

using testing::Contains, testing::HasSubstr, testing::IsEmpty, testing::StartsWith;

/// What roff prints of a page, without its layout.
std::string plain(std::string text) {
  const auto replace = [&text](std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  };
  replace("\\-", "-");
  replace("\\(aq", "'");
  replace("\\(dq", "\"");
  replace("\\(ti", "~");
  replace("\\(ha", "^");
  replace("\\(ga", "`");
  replace("\\fB", "");
  replace("\\fR", "");
  replace("\\fI", "");
  replace("\\&", "");
  replace("\\:", "");
  replace("\\%", "");
  replace("\n.na\n", "\n");
  replace("\n.ad\n", "\n");
  replace("\n.nf\n", "\n");
  replace("\n.fi\n", "\n");
  return text;
}

std::string squeezed(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  const auto is_second = [](char one, char other) { return one == ' ' && other == ' '; };
  text.erase(std::unique(text.begin(), text.end(), is_second), text.end());
  return text;
}

/// The options and commands that --help lists, each with its text behind it: lines that are indented.
std::vector<std::string> entries_of(const std::string& help) {
  std::vector<std::string> entries;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("   ") && !entries.empty())
      entries.back() += line;
    else if (line.starts_with("  "))
      entries.push_back(line);
  }
  return entries;
}

const std::vector<std::string> kCommands = words(
    "demo robot inverse forward error-model poses identifiability simulate calibrate validate report sensitivity "
    "tolerance tolerance-allocate tolerance-analyze yield compensate export schema reproduce printer help");

class Manual : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    pages = new TemporaryFolder;
    ASSERT_EQ(run_program({"manual", pages->path()}).exit_code, kDone);
  }
  static void TearDownTestSuite() { delete pages; }

  /// What a command says beside the pages; of a shell, which is given a script.
  static std::string said_by(const std::string& command) {
    const std::string line = fmt::format("cd {} && ({}) > said 2>&1", pages->path().string(), command);
    EXPECT_EQ(std::system(line.c_str()), 0) << pages->read("said");
    return pages->read("said");
  }
  static std::string said_by(const std::string& shell, const std::string& script) {
    pages->write("script", script);
    return said_by(shell + " script");
  }

  static inline const TemporaryFolder* pages = nullptr;
};

TEST_F(Manual, HasAPageForEachCommand) {
  std::set<std::string> expected{"paracal.1", "paracal.bash", "_paracal", "paracal.fish"};
  for (const std::string& command : kCommands) expected.insert("paracal-" + command + ".1");
  std::set<std::string> names = pages->names();
  for (const char* of_shells : {"script", "said", "text"}) names.erase(of_shells);
  EXPECT_EQ(names, expected);
  for (const std::string& command : words(run_program({"--help"}).out)) EXPECT_NE(command, "manual");
}

TEST_F(Manual, EndsLinesBetweenChoicesAlone) {
  const std::string text = said_by("MANWIDTH=50 man -E UTF-8 -l paracal-export.1");
  for (const char* whole :
       {"--target c99|linuxcnc|st|genhexkins|json|gcode|csv", "--dialect linuxcnc|klipper|marlin|rrf|fanuc-like"}) {
    EXPECT_THAT(std::regex_replace(text, std::regex("[|]\\n *"), "|"), HasSubstr(whole));
  }
}

TEST_F(Manual, SaysWhatHelpSays) {
  for (std::string command : kCommands) {
    SCOPED_TRACE(command);
    const std::string page = squeezed(plain(pages->read("paracal-" + command + ".1")));
    EXPECT_THAT(page, HasSubstr(fmt::format("paracal-{} - ", command)));
    if (command.starts_with("tolerance-")) command[command.find('-')] = ' ';
    const ProgramResult help = run_program(words(command + " --help"));
    EXPECT_THAT(page, HasSubstr("- " + help.out.substr(0, help.out.find('\n')) + " "));
    const std::vector<std::string> entries = entries_of(help.out);
    EXPECT_GE(entries.size(), command == "tolerance" || command == "help" ? 3u : 6u);
    for (const std::string& entry : entries) {
      std::string text = squeezed(entry.substr(2));
      if (command == "tolerance" && !text.starts_with('-')) text = text.substr(text.find(' ') + 1);
      EXPECT_THAT(page, HasSubstr(text));
    }
  }
}

TEST_F(Manual, OfTheProgramListsTheCommands) {
  const std::string page = squeezed(plain(pages->read("paracal.1")));
  EXPECT_THAT(page, HasSubstr("paracal - estimates and compensates the geometric errors of parallel robots"));
  EXPECT_THAT(page, HasSubstr(".SH EXIT STATUS Exit codes: 0 done; 1 done, criteria not met;"));
  EXPECT_THAT(page, HasSubstr(".SS Compensate a machine .TP paracal-compensate(1) compute corrected joint angles"));
  EXPECT_THAT(pages->read("paracal-tolerance-analyze.1"), HasSubstr(".SH SEE ALSO\n\\fBparacal\\-tolerance\\fR(1)\n"));
}

TEST_F(Manual, IsGoodRoff) {
  for (const std::string& name : pages->names()) {
    if (!name.ends_with(".1")) continue;
    EXPECT_EQ(said_by("man --warnings -E UTF-8 -l " + name + " > text"), "") << name;
  }
}

/// @param typed  the words so far, the last one to be completed.
std::string bash_line(const std::string& typed) {
  return fmt::format(
      "source ./paracal.bash\nCOMP_WORDS=({})\nCOMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))\n_paracal\n"
      "echo \"${{COMPREPLY[@]}}\"\n",
      typed);
}

TEST_F(Manual, CompletesInBash) {
  EXPECT_EQ(said_by("bash", bash_line("paracal po")), "poses\n");
  EXPECT_EQ(said_by("bash", bash_line("paracal tolerance ''")), "allocate analyze -h --help\n");
  EXPECT_EQ(said_by("bash", bash_line("paracal poses --stage ''")), "rough fine\n");
  EXPECT_EQ(said_by("bash", bash_line("paracal poses --optimal 20 --crit")), "--criterion\n");
  EXPECT_EQ(said_by("bash", bash_line("paracal tolerance allocate --bo")), "--bound\n");
  EXPECT_EQ(said_by("bash", bash_line("paracal yield --robot rot")), "rotary_delta\n");
  EXPECT_EQ(said_by("bash", bash_line("paracal inverse --poses ''")), "\n");  // files, by readline
  EXPECT_EQ(said_by("bash", bash_line("paracal reproduce h")), "huang2016\n");
}

TEST_F(Manual, CompletesInFish) {
  const auto completed = [](const std::string& typed) {
    std::vector<std::string> found;
    std::istringstream lines(said_by("env HOME=. fish -N", "source ./paracal.fish\ncomplete -C '" + typed + "'\n"));
    for (std::string line; std::getline(lines, line);) found.push_back(line.substr(0, line.find('\t')));
    return found;
  };
  EXPECT_THAT(completed("paracal po"), testing::ElementsAre("poses"));
  EXPECT_THAT(completed("paracal tolerance a"), testing::ElementsAre("allocate", "analyze"));
  EXPECT_THAT(completed("paracal poses --stage "), testing::ElementsAre("fine", "rough"));
  EXPECT_THAT(completed("paracal tolerance allocate --bo"), testing::ElementsAre("--bound"));
  EXPECT_THAT(completed("paracal yield --robot rot"), Contains("rotary_delta"));
}

// Its completions want a terminal: what can be told without is that zsh takes them, with the names in their places.
TEST_F(Manual, IsTakenByZsh) {
  EXPECT_EQ(said_by("zsh -f -n _paracal"), "");
  const std::string script = pages->read("_paracal");
  EXPECT_THAT(script, StartsWith("#compdef paracal\n"));
  EXPECT_THAT(script, HasSubstr("'--stage[stage of the calibration; adds points until O2 changes little (default\\: "
                                "fine)]:value:(rough fine)'"));
  EXPECT_THAT(script, HasSubstr("_paracal_tolerance_allocate() {"));
}

TEST_F(Manual, WantsAFolder) {
  const ProgramResult result = run_program({"manual", "/nowhere"});
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.err, HasSubstr("/nowhere"));
  EXPECT_THAT(result.out, IsEmpty());
}

}  // namespace
}  // namespace paracal::test::manual_test
