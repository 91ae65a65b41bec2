// paracal demo: the files that its commands make, said line by line; all of them or none.

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <map>
#include <sstream>

#include "json_checks.hpp"
#include "paracal/io/toml.hpp"
#include "support/places.hpp"

namespace paracal::test::demo_test {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using testing::ElementsAre, testing::ElementsAreArray, testing::HasSubstr, testing::IsEmpty, testing::StartsWith;

const std::vector<std::string> kFixedDate{"SOURCE_DATE_EPOCH=0"};
const std::string kDemo = "demo made --robot linear_delta";  // the quickest

std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) files[entry.path().filename()] = read_text(entry.path());
  return files;
}

/// Lines that begin so, without that.
std::vector<std::string> lines_after(const std::string& start, const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with(start)) lines.push_back(line.substr(start.size()));
  }
  return lines;
}

class Demo : public testing::Test {
 protected:
  ProgramResult run(const std::string& command, std::vector<std::string> environment = kFixedDate) const {
    return run_program(words(command), {.folder = folder.path(), .environment = std::move(environment)});
  }

  /// commands.sh of one of the folder's folders, in there.
  void run_script(const std::string& made) const {
    create_directory(folder.path() / "bin");
    if (!exists(folder.path() / "bin/paracal")) {
      create_symlink(build_folder() / "bin/paracal", folder.path() / "bin/paracal");
    }
    const std::string line = fmt::format("cd {0}/{1} && PATH={0}/bin:$PATH SOURCE_DATE_EPOCH=0 sh -e commands.sh",
                                         folder.path().string(), made);
    ASSERT_EQ(std::system(line.c_str()), 0);
  }

  const TemporaryFolder folder;
};

TEST_F(Demo, IsWhatItsCommandsMake) {
  const ProgramResult result = run(kDemo);
  ASSERT_EQ(result.exit_code, kDone) << result.err;
  const auto made = files_of(folder.path() / "made");
  const std::vector<std::string> commands = lines_after("paracal ", made.at("commands.sh"));
  EXPECT_THAT(lines_after("  $ paracal ", result.out), ElementsAreArray(commands));

  create_directory(folder.path() / "again");
  folder.write("again/commands.sh", made.at("commands.sh"));
  run_script("again");
  EXPECT_EQ(files_of(folder.path() / "again"), made);
}

/// Of every kind, from a file of the user's own, whose name and folder the demo does not need any more.
TEST_F(Demo, TakesRobotFilesOfEveryKind) {
  create_directory(folder.path() / "my robots");
  for (const std::string& kind : io::robot_templates()) {
    const std::string text = run("robot --template " + kind).out;
    folder.write("my robots/my own.toml", text);
    const json object = json_of(run_program({"demo", kind, "--robot", "my robots/my own.toml", "--json"},
                                            {.folder = folder.path(), .environment = kFixedDate}));
    for (const json& step : object.at("steps")) EXPECT_EQ(step.at("exit_code"), 0) << kind << step.dump();
    const auto made = files_of(folder.path() / kind);
    EXPECT_EQ(made.at("robot.toml"), text);
    EXPECT_THAT(made.at("plan.csv"), StartsWith("# robot: robot.toml\n"));
    EXPECT_THAT(made.at("measured.csv"), StartsWith("# robot: robot.toml\n"));
    remove_all(folder.path() / "my robots/my own.toml");
    if (kind != "five-bar" && kind != "delta") continue;
    run_script(kind);
    EXPECT_EQ(files_of(folder.path() / kind), made) << kind;
  }
}

TEST_F(Demo, WritesItsOwnFolderAgain) {
  ASSERT_EQ(run(kDemo).exit_code, kDone);
  const auto first = files_of(folder.path() / "made");
  folder.write("made/report.html", "old");
  const ProgramResult again = run(kDemo);
  ASSERT_EQ(again.exit_code, kDone) << again.err;
  EXPECT_EQ(files_of(folder.path() / "made"), first);
  folder.write("mine.toml", run("robot --template five-bar").out);
  ASSERT_EQ(run("demo made --robot mine.toml").exit_code, kDone);
  ASSERT_EQ(run("demo made --robot made/robot.toml").exit_code, kDone);
  EXPECT_NE(files_of(folder.path() / "made").at("plan.csv"), first.at("plan.csv"));

  const auto refused = [&](const std::string& file) {
    const auto before = files_of(folder.path() / "made");
    const ProgramResult result = run(kDemo);
    EXPECT_EQ(result.exit_code, kWrongUsage);
    EXPECT_THAT(result.err, HasSubstr("expected an empty or a new folder, or one from an earlier demo, got made with " +
                                      file + "; name another folder"));
    EXPECT_EQ(files_of(folder.path() / "made"), before);
  };
  folder.write("made/notes.txt", "mine");
  refused("notes.txt");
  remove(folder.path() / "made/notes.txt");
  for (const auto& [name, text] : files_of(folder.path() / "made")) {
    if (name != "commands.sh") remove(folder.path() / "made" / name);
  }
  folder.write("made/commands.sh", "#!/bin/sh\nparacal poses\n");
  refused("commands.sh");
}

TEST_F(Demo, SaysWhatTheFilesSay) {
  const ProgramResult result = run("demo");
  ASSERT_EQ(result.exit_code, kDone) << result.err;
  const auto made = files_of(folder.path() / "paracal-demo");
  EXPECT_THAT(made.at("plan.csv"), StartsWith("# robot: huang2016\n"));
  const std::string all = made.at("calibration.txt") + made.at("validation.txt");
  const std::vector<std::string> shown = lines_after("    ", result.out);
  EXPECT_GE(shown.size(), 8u);
  for (const std::string& line : shown) EXPECT_THAT(all, HasSubstr(line + "\n"));
  for (const char* telling : {"calibration of huang2016: accepted", "validation: accepted"}) {
    EXPECT_THAT(shown, testing::Contains(telling));
  }
  EXPECT_THAT(result.out, HasSubstr("within the tolerances and measure it: noise 0.017 mm, three visits per pose.\n"));
  EXPECT_THAT(result.out, HasSubstr(fmt::format("\n{} files are in paracal-demo; open report.html there.\n"
                                                "To repeat the commands: cd paracal-demo && sh commands.sh\n",
                                                made.size())));
  EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(Demo, PrintsJson) {
  create_directory(folder.path() / "my demo");
  const json object =
      json_of(run_program({"demo", "my demo", "--robot", "rotary_delta", "--json"}, {.folder = folder.path()}));
  EXPECT_TRUE(has_keys(object, "folder steps files"));
  EXPECT_EQ(object.at("folder"), "my demo");
  const auto made = files_of(folder.path() / "my demo");
  std::vector<std::string> names;
  for (const auto& [name, text] : made) names.push_back(name);
  EXPECT_EQ(object.at("files"), names);
  for (const json& step : object.at("steps")) {
    EXPECT_TRUE(has_keys(step, "what command exit_code text"));
    EXPECT_EQ(step.at("exit_code"), 0);
    EXPECT_THAT(made.at("commands.sh"), HasSubstr(fmt::format("# {}\n{}\n", step.at("what").get<std::string>(),
                                                              step.at("command").get<std::string>())));
  }
}

TEST_F(Demo, QuotesItsFolder) {
  const ProgramResult result = run_program({"demo", "it's mine", "--robot", "linear_delta"}, {.folder = folder.path()});
  EXPECT_THAT(result.out, HasSubstr("cd 'it'\\''s mine' && sh commands.sh\n"));
}

TEST_F(Demo, RefusesFoldersThatAreNotEmpty) {
  folder.write("plan.csv", "mine");
  const auto refused = [&](const std::string& command, const std::string& message) {
    const ProgramResult result = run(command);
    EXPECT_EQ(result.exit_code, kWrongUsage) << command;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_THAT(folder.names(), ElementsAre("plan.csv"));
  };
  refused("demo .", "expected an empty or a new folder, or one from an earlier demo, got . with plan.csv");
  refused("demo plan.csv", "expected a folder, got a file: plan.csv");
  refused("demo one/two", "one/two: expected an existing parent folder, got none: ");
  refused("demo made --robot nobody", "got \"nobody\" (a robot file ends in .toml)");
  EXPECT_EQ(folder.read("plan.csv"), "mine");
}

TEST_F(Demo, LeavesNothingInScratch) {
  const TemporaryFolder scratch;
  const std::string temporary = "TMPDIR=" + scratch.path().string();
  EXPECT_EQ(run(kDemo, {temporary}).exit_code, kDone);
  EXPECT_THAT(scratch.names(), IsEmpty());
  EXPECT_EQ(run("demo other", {"TMPDIR=/nowhere"}).exit_code, kWrongUsage);
  EXPECT_THAT(folder.names(), ElementsAre("made"));
}

TEST_F(Demo, EndsBySignalsWithoutTraces) {
  const TemporaryFolder scratch;
  for (const int signal : {SIGINT, SIGTERM}) {
    RunningProgram running({"demo", "made"},
                           {.folder = folder.path(), .environment = {"TMPDIR=" + scratch.path().string()}});
    for (int k = 0; k < 5000 && scratch.names().empty(); ++k) usleep(1000);
    running.send(signal);
    EXPECT_EQ(running.result().exit_code, -signal);
    EXPECT_THAT(scratch.names(), IsEmpty());
    EXPECT_THAT(folder.names(), IsEmpty());
  }
}

#ifndef PARACAL_SANITIZED
TEST_F(Demo, LeavesAllFilesOrNoFolder) {
  ASSERT_EQ(run(kDemo).exit_code, kDone);
  const auto expected = files_of(folder.path() / "made");
  int refused = 0;
  for (const char* fault :
       {"mkdir 1 28", "write 2 28", "write 12 28", "write 30 28", "open 40 13", "rename 2 28", "rename 8 28"}) {
    remove_all(folder.path() / "made");
    const ProgramResult result =
        run(kDemo, {"SOURCE_DATE_EPOCH=0", preloaded_faults(), std::string("PARACAL_FAULT=") + fault});
    refused += result.exit_code != kDone;
    if (result.exit_code == kDone) {
      EXPECT_EQ(files_of(folder.path() / "made"), expected) << fault;
    } else {
      EXPECT_THAT(folder.names(), IsEmpty()) << fault << result.err;
    }
  }
  EXPECT_GE(refused, 3);
}
#endif

}  // namespace
}  // namespace paracal::test::demo_test
