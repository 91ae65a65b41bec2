// Ordinary faults: outputs that would destroy inputs, disks that are full, processes that are killed, readings that
// cannot be read to their end, calibrations that cannot be. Nothing is lost, nothing half-written, nothing believed.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "json_checks.hpp"
#include "printer/klipper_sets.hpp"

namespace paracal::test::faults_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kProgram = "G28\nG1 X0 Y0 Z-900\nG1 X100 Y50 Z-950\n";
constexpr const char* kErrors =
    "[[limb]]\ntheta_offset_deg = 0.2\n[[limb]]\n[[limb]]\n[[limb]]\ntheta_offset_deg = -0.1\n";

/// A folder with a plan, readings, a part program, errors, and a calibration of the readings.
class Faults : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("part.gcode", kProgram);
    folder.write("errors.toml", kErrors);
    folder.make({"poses --stage fine --out plan.csv",
                 "simulate --poses plan.csv --noise-mm 0.01 --frame random --out points.csv",
                 "calibrate --measurements points.csv --out calibration.json"});
    for (const std::string& name : folder.names()) before.emplace_back(name, folder.read(name));
  }

  /// Every file is as it was, and there is no other.
  void expect_untouched(const std::string& after) const {
    std::vector<std::pair<std::string, std::string>> now;
    for (const std::string& name : folder.names()) now.emplace_back(name, folder.read(name));
    EXPECT_TRUE(now == before) << after;
  }

  TemporaryFolder folder;
  std::vector<std::pair<std::string, std::string>> before;
};

struct Overwriting {
  std::string command, option;
};

TEST_F(Faults, AnOutputIsNoInput) {
  for (const Overwriting& one : std::vector<Overwriting>{
           {"calibrate --measurements points.csv --out points.csv", "--measurements"},
           {"calibrate --measurements points.csv --report points.csv", "--measurements"},
           {"calibrate --measurements points.csv --out ./points.csv", "--measurements"},
           {"validate --calibration calibration.json --measurements points.csv --out calibration.json",
            "--calibration"},
           {"inverse --poses plan.csv --errors errors.toml --out errors.toml", "--errors"},
           {"simulate --poses plan.csv --truth plan.csv", "--poses"},
           {"export --target gcode --calibration calibration.json --input part.gcode --out part.gcode", "--input"},
           {"report --calibration calibration.json --measurements points.csv --out points.csv", "--measurements"}}) {
    const ProgramResult result = folder.run(one.command);
    EXPECT_EQ(result.exit_code, kWrongUsage) << one.command;
    EXPECT_THAT(result.err, AllOf(HasSubstr("expected a separate file"), HasSubstr(one.option))) << one.command;
    EXPECT_THAT(result.out, IsEmpty()) << one.command;
    expect_untouched(one.command);
  }
}

TEST_F(Faults, AnOutputHasAName) {
  for (const char* option : {"--out", "--truth"}) {
    const ProgramResult result =
        run_program({"simulate", "--robot", "huang2016", "--poses", "plan.csv", option, ""}, {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, kWrongUsage);
    EXPECT_EQ(result.err, std::string("paracal: ") + option + ": expected a file, got \"\"\n");
  }
}

TEST_F(Faults, OtherNamesOfAnInputAreThatInput) {
  std::filesystem::create_hard_link(folder.path() / "points.csv", folder.path() / "hard.csv");
  std::filesystem::create_symlink("points.csv", folder.path() / "soft.csv");
  for (const std::string name : {"hard.csv", "soft.csv"}) {
    EXPECT_EQ(folder.run("calibrate --measurements points.csv --out " + name).exit_code, kWrongUsage) << name;
    EXPECT_TRUE(folder.read("points.csv") == folder.read(name));
    std::filesystem::remove(folder.path() / name);
  }
  expect_untouched("other names");
}

TEST_F(Faults, TwoOutputsAreTwoFiles) {
  const ProgramResult result = folder.run("calibrate --measurements points.csv --out new.json --report ./new.json");
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.err, AllOf(HasSubstr("--out"), HasSubstr("--report")));
  expect_untouched("two outputs");
}

/// Not after an hour's work: this batch would take days.
TEST_F(Faults, OutputsAreLookedAtFirst) {
  std::filesystem::create_directory(folder.path() / "folder");
  for (const std::string file : {"nowhere/out.txt", "folder", "points.csv/out.txt"}) {
    const ProgramResult result = folder.run("yield --machines 100000000 --out " + file);
    EXPECT_EQ(result.exit_code, kWrongUsage) << file;
    EXPECT_THAT(result.err, AllOf(HasSubstr("--out"), HasSubstr(file)));
  }
}

/// A word is no file for all that: no other option of these names one.
TEST_F(Faults, AnOutputMayHaveTheNameOfAChoice) {
  EXPECT_EQ(folder.run("poses --stage rough --out rough").exit_code, kDone);
  EXPECT_EQ(folder.names().count("rough"), 1u);
}

TEST_F(Faults, StandardInputAndOutputAreNoOutputs) {
  const auto filter = words("export --target gcode --robot huang2016 --calibration calibration.json --out part.gcode");
  EXPECT_EQ(run_program(filter, {.folder = folder.path(), .standard_input = folder.path() / "part.gcode"}).exit_code,
            kWrongUsage);
  expect_untouched("standard input");
  const auto summary = words("calibrate --robot huang2016 --measurements points.csv --out out.txt");
  EXPECT_EQ(run_program(summary, {.folder = folder.path(), .standard_output = folder.path() / "out.txt"}).exit_code,
            kWrongUsage);
}

/// Files that no option names, but another file does.
TEST_F(Faults, FilesThatAreNamedInFilesAreInputs) {
  const std::vector<KlipperSet> sets = klipper_sets();
  const std::string whole = std::ranges::find(sets, "K18", &KlipperSet::id)->config;
  const std::size_t block = whole.find("\n#*# <");  // which counts in the file alone that includes others
  const std::string included = whole.substr(0, block);
  folder.write("printer.cfg", "[include delta.cfg]\n" + whole.substr(block));
  folder.write("delta.cfg", included);
  const ProgramResult printer = folder.run("calibrate --printer printer.cfg --out delta.cfg");
  EXPECT_EQ(printer.exit_code, kWrongUsage);
  EXPECT_THAT(printer.err, HasSubstr("delta.cfg, which is also read"));
  EXPECT_EQ(folder.read("delta.cfg"), included);

  const std::string robot = folder.run("robot").out;
  folder.write("mine.toml", robot);
  folder.write("named.csv", "# robot: mine.toml\npose,x_mm,y_mm,z_mm\nhome,0,0,-888\n");
  EXPECT_EQ(folder.run(words("inverse --poses named.csv")).exit_code, kDone);
  const ProgramResult inverse = folder.run(words("inverse --poses named.csv --out mine.toml"));
  EXPECT_EQ(inverse.exit_code, kWrongUsage);
  EXPECT_THAT(inverse.err, HasSubstr("mine.toml, which is also read"));
  EXPECT_EQ(folder.read("mine.toml"), robot);
}

/// What a full disk behind standard output leaves: the earlier results.
TEST_F(Faults, AResultThatCannotBeShownReplacesNothing) {
  folder.write("old.json", "earlier");
  folder.write("old.html", "earlier page");
  const ProgramResult result =
      run_program(words("calibrate --robot huang2016 --measurements points.csv --out old.json --report old.html"),
                  {.folder = folder.path(), .standard_output = "/dev/full"});
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.err, HasSubstr("standard output"));
  EXPECT_EQ(folder.read("old.json"), "earlier");
  EXPECT_EQ(folder.read("old.html"), "earlier page");
}

/// Nor does one of two outputs that cannot be written leave the other.
TEST_F(Faults, OutputsComeTogetherOrNotAtAll) {
  EXPECT_EQ(folder.run("calibrate --measurements points.csv --out new.json --report nowhere/new.html").exit_code,
            kWrongUsage);
  expect_untouched("page into a missing folder");
}

TEST_F(Faults, AKilledProcessLeavesNothing) {
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  for (const int signal : {SIGKILL, SIGTERM, SIGINT, SIGHUP}) {
    RunningProgram running(words("export --target gcode --robot huang2016 --calibration calibration.json --input pipe "
                                 "--out out.gcode"),
                           {.folder = folder.path()});
    const int writer = open((folder.path() / "pipe").c_str(), O_RDWR);  // would wait for a reader that has failed
    std::string text;
    for (int k = 0; k < 60'000; ++k) text += "G1 X100 Y50 Z-950\n";
    ASSERT_GT(write(writer, text.data(), text.size()), 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    running.send(signal);
    EXPECT_EQ(running.result().exit_code, -signal);
    close(writer);
    std::set<std::string> expected{"pipe"};
    for (const auto& [name, content] : before) expected.insert(name);
    EXPECT_EQ(folder.names(), expected) << signal;
  }
}

TEST_F(Faults, ALinkToNothingIsFollowed) {
  std::filesystem::create_symlink("target.toml", folder.path() / "link.toml");
  EXPECT_EQ(folder.run("robot --out link.toml").exit_code, kDone);
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link.toml"));
  EXPECT_TRUE(folder.read("target.toml") == folder.run("robot").out);
}

/// What a link points to is replaced, and keeps its mode; the link stays, and the folders hold nothing else.
TEST_F(Faults, ALinkStaysALink) {
  const std::string robot = folder.run("robot").out;
  std::filesystem::create_directory(folder.path() / "other");
  const std::filesystem::path target = folder.write("other/target.toml", "earlier");
  std::filesystem::permissions(target, std::filesystem::perms(0640));
  std::filesystem::create_symlink("target.toml", folder.path() / "other" / "near.toml");
  std::filesystem::create_symlink("other/near.toml", folder.path() / "far.toml");
  const std::set<std::string> names = folder.names();
  for (const std::string link : {"other/near.toml", "far.toml"}) {
    folder.write("other/target.toml", "earlier");
    EXPECT_EQ(folder.run("robot --out " + link).exit_code, kDone);
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / link));
    EXPECT_FALSE(std::filesystem::is_symlink(target));
    EXPECT_TRUE(folder.read("other/target.toml") == robot) << link;
    EXPECT_EQ(std::filesystem::status(target).permissions(), std::filesystem::perms(0640));
    EXPECT_EQ(folder.names(), names);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path() / "other"), {}), 2);
  }
}

TEST_F(Faults, LinksThatPointAtEachOtherAreRefused) {
  std::filesystem::create_symlink("two.toml", folder.path() / "one.toml");
  std::filesystem::create_symlink("one.toml", folder.path() / "two.toml");
  const ProgramResult result = folder.run("robot --out one.toml");
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.err, AllOf(HasSubstr("one.toml"), HasSubstr("cannot be written"), HasSubstr("links")));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "one.toml"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "two.toml"));
}

TEST_F(Faults, NamesMayBeAsLongAsNamesCanBe) {
  const std::string robot = folder.run("robot").out;
  for (const std::size_t length : {241U, 250U, 254U, 255U}) {
    const std::string name(length, 'r'), page = "p" + std::string(length - 1, 'r');
    EXPECT_EQ(folder.run("robot --out " + name).exit_code, kDone) << length;
    EXPECT_TRUE(folder.read(name) == robot);
    EXPECT_EQ(folder.run("calibrate --measurements points.csv --out " + name + " --report " + page).exit_code, kDone);
    EXPECT_EQ(folder.run("yield --machines 2 --chunk 1 --checkpoint b" + page.substr(1)).exit_code, kDone);
    for (const std::string& made : {name, page, "b" + page.substr(1)}) {
      EXPECT_EQ(std::filesystem::remove_all(folder.path() / made) > 0, true) << length;
    }
    expect_untouched("names of " + std::to_string(length));
  }
  const std::string name(256, 'r');
  for (const std::string command : {"robot --out ", "calibrate --measurements points.csv --report ",
                                    "yield --machines 2 --chunk 1 --checkpoint "}) {
    const ProgramResult result = folder.run(command + name);
    EXPECT_EQ(result.exit_code, kWrongUsage) << command;
    EXPECT_THAT(result.err, AllOf(HasSubstr("cannot be written"), HasSubstr("name too long"))) << command;
    expect_untouched(command);
  }
}

/// Else a result would be opened as what is closed, and get the summary.
TEST_F(Faults, ClosedStandardStreamsAreNoResults) {
  const auto run = [&](const std::string& streams) {
    return run_program(words("calibrate --robot huang2016 --measurements points.csv --out out.json --report out.html"),
                       {.folder = folder.path(), .launcher = {"/bin/sh", "-c", "exec \"$0\" \"$@\" " + streams}});
  };
  ASSERT_EQ(run("").exit_code, kDone);
  const std::string page = folder.read("out.html").substr(0, 15), end = "</html>\n";
  for (const std::string streams : {"<&- >&-", ">&-", "<&- >&- 2>&-"}) {
    folder.write("out.json", "earlier");
    folder.write("out.html", "earlier");
    EXPECT_EQ(run(streams).exit_code, kWrongUsage) << streams;
    EXPECT_TRUE(folder.read("out.json") == "earlier") << streams;
    EXPECT_TRUE(folder.read("out.html") == "earlier") << streams;
  }
  for (const std::string streams : {"<&-", "2>&-", "<&- 2>&-"}) {
    EXPECT_EQ(run(streams).exit_code, kDone) << streams;
    EXPECT_TRUE(nlohmann::json::accept(folder.read("out.json"))) << streams;
    EXPECT_TRUE(folder.read("out.html").starts_with(page) && folder.read("out.html").ends_with(end)) << streams;
  }
}

/// Reading one's own memory from its beginning is an input-output error.
TEST_F(Faults, AnErrorOfReadingIsNotTheEnd) {
  const auto filter = words("export --target gcode --robot huang2016 --calibration calibration.json --out out.gcode");
  const ProgramResult piped = run_program(filter, {.folder = folder.path(), .standard_input = "/proc/self/mem"});
  EXPECT_EQ(piped.exit_code, kBadInputFile);
  EXPECT_THAT(piped.err, AllOf(HasSubstr("standard input"), HasSubstr("cannot be read")));
  for (const std::string command :
       {"export --target gcode --calibration calibration.json --input /proc/self/mem --out out.gcode",
        "calibrate --measurements /proc/self/mem --out out.json", "inverse --poses /proc/self/mem"}) {
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, kBadInputFile) << command;
    EXPECT_THAT(result.err, HasSubstr("cannot be read")) << command;
  }
  expect_untouched("errors of reading");
}

TEST_F(Faults, AFileWithoutEndIsRefused) {
  for (const auto& [command, message] :
       {std::pair{"simulate --poses /dev/zero", "/dev/zero: expected at most 128 MiB"},
        {"inverse --poses /dev/zero", "/dev/zero:1: expected lines of at most 64 KiB"},
        {"forward --joints /dev/zero", "/dev/zero:1: expected lines of at most 64 KiB"},
        {"export --target gcode --calibration calibration.json --input /dev/zero",
         "/dev/zero:1: expected lines of at most 64 KiB"},
        {"export --target csv --calibration calibration.json --input /dev/zero",
         "/dev/zero:1: expected lines of at most 64 KiB"},
        {"compensate --errors errors.toml --poses /dev/zero", "/dev/zero:1: expected lines of at most 64 KiB"}}) {
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, kBadInputFile) << command;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

/// Of batches that begin in one new folder at the same time, one is made and the others are refused.
TEST_F(Faults, BatchesDoNotMix) {
  for (int round = 0; round < 5; ++round) {
    const std::string checkpoint = "batch" + std::to_string(round);
    std::vector<std::unique_ptr<RunningProgram>> running;
    for (int seed = 1; seed <= 4; ++seed) {
      running.push_back(std::make_unique<RunningProgram>(
          words("yield --exact --robot huang2016 --machines 4 --chunk 2 --checkpoint " + checkpoint + " --seed " +
                std::to_string(seed)),
          Surroundings{.folder = folder.path()}));
    }
    int done = 0;
    for (const auto& one : running) {
      const ProgramResult result = one->result();
      done += result.exit_code == kDone;
      if (result.exit_code == kDone) continue;
      EXPECT_EQ(result.exit_code, kBadInputFile) << result.err;
      EXPECT_THAT(result.err, HasSubstr("belongs to another command"));
    }
    EXPECT_EQ(done, 1);
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / checkpoint)) {
      names.insert(entry.path().filename());
    }
    EXPECT_EQ(names.size(), 3u) << checkpoint;  // job.json and two chunks
  }
}

TEST_F(Faults, AFolderIsMadeInSpiteOfSignals) {
  const std::string yield = "yield --exact --robot huang2016 --machines 2 --chunk 1 --checkpoint ";
  int folders = 0;
  const auto make = [&](const std::string& command, int call, const std::filesystem::path& made) {
    const std::string fault = fmt::format("PARACAL_FAULT=mkdir {} {}", call, EINTR);
    const ProgramResult result =
        run_program(words(command), {.folder = folder.path(), .environment = {preloaded_faults(), fault}});
    EXPECT_EQ(result.exit_code, kDone) << result.err;
    folders += is_directory(folder.path() / made);
  };
  make(yield + "one", 1, "one");
  make(yield + "two/below/", 2, "two/below");
  make("demo made --robot linear_delta", 1, "made");
  EXPECT_EQ(folders, 3);
  const ProgramResult refused = folder.run(yield + "points.csv/below");
  EXPECT_EQ(refused.exit_code, kWrongUsage);
  EXPECT_EQ(refused.err, "paracal: points.csv/below: cannot be written: Not a directory\n");
}

TEST_F(Faults, CalibrationsThatCannotBeAreRefused) {
  const auto spoilt = [&](const std::function<void(nlohmann::json&)>& change) {
    nlohmann::json json = nlohmann::json::parse(folder.read("calibration.json"));
    change(json);
    folder.write("spoilt.json", json.dump());
    return folder.run("inverse --poses plan.csv --errors spoilt.json");
  };
  const auto parameter = [](nlohmann::json& json, const std::string& name) -> nlohmann::json& {
    for (nlohmann::json& one : json.at("parameters")) {
      if (one.at("name") == name) return one;
    }
    throw std::logic_error("no " + name);
  };
  EXPECT_EQ(spoilt([](auto&) {}).exit_code, kDone);
  struct Case {
    std::function<void(nlohmann::json&)> change;
    std::string message;
  };
  for (const Case& one : std::vector<Case>{
           {[](auto& json) { json["format"] = "paracal calibration 99"; }, "paracal calibration 1"},
           {[](auto& json) { json["parameters"].push_back(json["parameters"][0]); }, "once"},
           {[&](auto& json) { parameter(json, "rod_mean")["value"] = -5000.0; }, "rod_mean of limb 1 within"},
           {[&](auto& json) { parameter(json, "rod_mean")["value"] = -951.0; }, "the rods of limb 1 longer than 0 mm"},
           {[&](auto& json) { parameter(json, "arm_length")["value"] = -375.0; }, "the arm of limb 1 longer than"},
           {[&](auto& json) { parameter(json, "theta_offset")["value"] = 1e308; }, "theta_offset of limb 1 within 180"},
           {[](auto& json) { json["covariance"][3][3] = -1e-4; }, "variances above 0 in covariance"},
           {[](auto& json) { json["covariance_of_noise"][0][0] = -1e-4; }, "variances above 0 in covariance_of_noise"},
           {[](auto& json) { json["covariance"][3][4] = 1e3; }, "symmetric covariance"},
           {[](auto& json) {
              const double a = json["covariance"][3][3], b = json["covariance"][4][4];
              json["covariance"][3][4] = json["covariance"][4][3] = 2.0 * std::sqrt(a * b);
            },
            "positive semidefinite covariance, got an indefinite one: calibrate again"},
           {[](auto& json) {
              for (auto& row : json["covariance"]) {
                for (auto& value : row) value = 0.0;
              }
            },
            "variances above 0"}}) {
    const ProgramResult result = spoilt(one.change);
    EXPECT_EQ(result.exit_code, kBadInputFile) << one.message;
    EXPECT_THAT(result.err, AllOf(HasSubstr("spoilt.json:1: "), HasSubstr(one.message)));
  }
  folder.write("short.toml", "[[limb]]\narm_length_mm = -400\n[[limb]]\n[[limb]]\n[[limb]]\n");
  const ProgramResult toml = folder.run("inverse --poses plan.csv --errors short.toml");
  EXPECT_EQ(toml.exit_code, kBadInputFile);
  EXPECT_THAT(toml.err, AllOf(HasSubstr("short.toml: "), HasSubstr("the arm of limb 1 longer than 0 mm, got -25 mm")));
}

TEST_F(Faults, DepthIsLimited) {
  std::string key = "a";
  for (int k = 0; k < 31'000; ++k) key += ".a";
  std::string arrays(66'000, '[');
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"deep.toml", "name = \"x\"\n" + key + " = 1\n"},
                                   {"table.toml", "[" + key + "]\n"}}) {
    folder.write(name, text);
    const ProgramResult result = folder.run("robot --robot " + name);
    EXPECT_EQ(result.exit_code, kBadInputFile) << name;
    EXPECT_THAT(result.err, AllOf(HasSubstr(name + ":"), HasSubstr("at most 64 parts"))) << name;
  }
  folder.write("deep.json", "{\"robot\": " + arrays + std::string(66'000, ']') + "}");
  const ProgramResult json = folder.run("inverse --poses plan.csv --errors deep.json");
  EXPECT_EQ(json.exit_code, kBadInputFile);
  EXPECT_THAT(json.err, AllOf(HasSubstr("deep.json:1: "), HasSubstr("at most 64 levels")));
  // What only looks deep is none of it: a comment, a text, numbers.
  const std::string dots(100, '.');
  folder.write("shallow.toml", "# " + dots + "\n" + folder.run("robot").out + "# " + dots + "\n");
  EXPECT_EQ(folder.run(words("robot --robot shallow.toml")).exit_code, kDone);
}

TEST_F(Faults, IncludesDoNotMultiplyWithoutEnd) {
  for (int k = 0; k < 25; ++k) {
    const std::string next = "[include i" + std::to_string(k + 1) + ".cfg]\n";
    folder.write("i" + std::to_string(k) + ".cfg", next + "[x]\n" + next);
  }
  folder.write("i25.cfg", "[printer]\nkinematics: delta\n");
  const ProgramResult result = folder.run("calibrate --printer i0.cfg");
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(result.err, HasSubstr("at most 1000 files"));
}

/// A message never obeys what stands in a file.
TEST_F(Faults, MessagesAreOneReadableLine) {
  const std::string escape = "\x1b[31mred", huge(3'000'000, 'x');
  folder.write("names.csv", "pose,x_mm,y_mm,z_mm\nP\x1b[2J,0,0,-900\n");
  folder.write("reversed.csv", "pose,x_mm,y_mm,z_mm\nP\u202E2,0,0,-900\n");
  folder.write("field.csv", "pose,x_mm,y_mm,z_mm\nP1," + huge + ",0,-900\n");
  folder.write("name.toml", "name = \"\\u001b[31m\"\n");
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           words("inverse --robot huang2016 --poses names.csv"),
           words("inverse --robot huang2016 --poses reversed.csv"),
           words("inverse --robot huang2016 --poses field.csv"),
           words("robot --robot name.toml"),
           {"inverse", "--robot", "huang2016", "--poses", "no\x1b[2J\nsuch.csv"},
           {"calibrate", "--" + escape},
           {"robot", "--robot", escape},
           {"calibrate", "--robot", "huang2016", "--measurements", "points.csv", "--stage", escape}}) {
    const ProgramResult result = folder.run(arguments);
    EXPECT_GE(result.exit_code, kWrongUsage);
    EXPECT_THAT(result.err, AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\u202E")), EndsWith("\n")));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_LT(result.err.size(), 2200u);
  }
}

TEST(Usage, SaysWhatWasProbablyMeant) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"calibrate --mesurements a.csv", "(did you mean --measurements?)"},
      {"calbrate", "(did you mean calibrate?)"},
      {"tolerance alocate", "(did you mean allocate?)"},
      {"calibrate --stage fnie", "--stage: expected one of rough, fine, auto, got fnie (did you mean fine?)"},
      {"robot --robot huang2061", "got \"huang2061\" (did you mean huang2016?)"},
      {"poses --quiet", "see paracal poses --help"},
      {"inverse", "expected --poses FILE, got none"}};
  for (const auto& [command, message] : cases) {
    const ProgramResult result = run_program(words(command));
    EXPECT_EQ(result.exit_code, kWrongUsage) << command;
    EXPECT_THAT(result.err, AllOf(testing::StartsWith("paracal: "), HasSubstr(message)));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  }
  EXPECT_THAT(run_program(words("poses --quiet")).err, Not(HasSubstr("did you mean")));
}

TEST(Usage, WholeNumbersAreWhole) {
  const auto poses = [](const std::string& seed) {
    return run_program(words("poses --robot huang2016 --optimal 8 --candidates 50 --seed " + seed));
  };
  EXPECT_EQ(poses("18446744073709551615").exit_code, kDone);
  EXPECT_EQ(poses("1e3").out, poses("1000").out);
  for (const std::string seed : {"18446744073709551616", "-1", "1.5", "1e30", "0x10", "1_000", "seven", "1e"}) {
    const ProgramResult result = poses(seed);
    EXPECT_EQ(result.exit_code, kWrongUsage) << seed;
    EXPECT_THAT(result.err, HasSubstr("whole number")) << seed;
  }
}

}  // namespace
}  // namespace paracal::test::faults_test
