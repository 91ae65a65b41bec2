// Every command, with every call that can fail failing once: it ends with a code of the contract and one message, and
// leaves inputs and earlier outputs as they were, and nothing else; what it says is done is what an undisturbed run
// does. And every command, interrupted before any such call: all its outputs are there, or none.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <map>
#include <sstream>

#include "run_program.hpp"

namespace paracal::test {
namespace {

using Files = std::map<std::string, std::string>;

Files files_of(const std::filesystem::path& folder) {
  Files files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = std::filesystem::relative(entry.path(), folder);
    files[name] = entry.is_regular_file() ? read_text(entry.path()) : "";
  }
  return files;
}

struct Injected {
  std::string command;
  bool is_batch = false;  ///< whose chunks stay: that is what they are for
};

void PrintTo(const Injected& one, std::ostream* stream) { *stream << one.command; }

const std::vector<Injected> kCommands{
    {"robot --out out.toml"},
    {"poses --stage rough --out out.csv"},
    {"inverse --poses plan.csv --errors calibration.json --out out.csv"},
    {"forward --joints joints.csv --out out.csv"},
    {"simulate --poses plan.csv --truth truth.toml --out out.csv"},
    {"calibrate --measurements points.csv --tolerances tolerances.toml --out out.json --report out.html"},
    {"validate --calibration calibration.json --measurements points.csv --out out.json"},
    {"report --calibration calibration.json --measurements points.csv --out out.html"},
    {"compensate --calibration calibration.json --poses plan.csv --out out.csv"},
    {"export --target gcode --calibration calibration.json --input part.gcode --out out.gcode"},
    {"export --target csv --calibration calibration.json --input plan.csv --out out.csv"},
    {"export --target c99 --calibration calibration.json --out out.h"},
    {"identifiability --poses plan.csv --out out.txt"},
    {"sensitivity --map map.csv --out out.txt"},
    {"tolerance allocate --max-tilt 5e-4 --toml out.toml --out out.txt"},
    {"yield --machines 4 --chunk 2 --checkpoint batch --out out.txt", true},
};

class Injection : public testing::TestWithParam<Injected> {
 protected:
  void SetUp() override {
    folder.write("part.gcode", "G1 X0 Y0 Z-900\nG1 X100 Y50 Z-950\n");
    for (const char* command : {"robot --out robot.toml", "poses --stage rough --out plan.csv",
                                "inverse --poses plan.csv --out joints.csv", "poses --stage fine --out fine.csv",
                                "simulate --poses fine.csv --noise-mm 0.01 --frame random --out points.csv",
                                "calibrate --measurements points.csv --out calibration.json"}) {
      ASSERT_EQ(folder.run(command).exit_code, 0) << command;
    }
    const std::string robot = folder.read("robot.toml");
    folder.write("tolerances.toml", robot.substr(robot.find("[tolerances]")));
    // What a command is to replace.
    for (const std::string& word : words(GetParam().command)) {
      if (word.starts_with("out.") || word == "truth.toml" || word == "map.csv") folder.write(word, "earlier");
    }
    before = files_of(folder.path());
  }

  ProgramResult run_with(const std::string& fault, const std::string& counts = "") const {
    std::vector<std::string> environment{fmt::format("LD_PRELOAD={}", PARACAL_FAULT_SHIM), "PARACAL_FAULT=" + fault,
                                         "SOURCE_DATE_EPOCH=0"};
    if (!counts.empty()) environment.push_back("PARACAL_FAULT_COUNTS=" + counts);
    return run_program(of_huang2016(GetParam().command), {.folder = folder.path(), .environment = environment});
  }

  void restore() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) remove_all(entry.path());
    for (const auto& [name, text] : before) folder.write(name, text);
  }

  /// @returns what speaks against the outcome; nothing of a good one.
  std::string objection(const ProgramResult& result, const ProgramResult& undisturbed, const Files& expected) const {
    Files now = files_of(folder.path());
    if (result.exit_code == undisturbed.exit_code) {
      if (result.out != undisturbed.out) return "said something else";
      return now == expected ? "" : "left other files than an undisturbed run";
    }
    if (result.exit_code < 2 || result.exit_code > 4) return "ended otherwise than the contract says";
    if (std::ranges::count(result.err, '\n') != 1 || !result.err.starts_with("paracal: ")) return "said no one message";
    if (GetParam().is_batch) {
      std::erase_if(now, [](const auto& file) { return file.first.starts_with("batch"); });
    }
    return now == before ? "" : "left other files than it found";
  }

  /// The same of a run that got a signal.
  std::string objection_after_signal(const ProgramResult& result, int signal, const ProgramResult& undisturbed,
                                     const Files& expected) const {
    Files now = files_of(folder.path());
    if (std::ranges::any_of(now, [](const auto& file) { return file.first.find(".paracal-") != std::string::npos; })) {
      return "left a temporary file";
    }
    const bool ended = result.exit_code == undisturbed.exit_code || (GetParam().is_batch && result.exit_code == 1);
    if (!ended && result.exit_code != -signal) return "ended neither by the signal nor in spite of it";
    if (GetParam().is_batch) {  // goes on where it was
      (void)run_with("none 0 0");
      return files_of(folder.path()) == expected ? "" : "did not go on to what an undisturbed run leaves";
    }
    return now == expected || (!ended && now == before) ? "" : "left neither all its outputs nor none";
  }

  /// How often an undisturbed run makes each call.
  std::vector<std::pair<std::string, long>> calls(ProgramResult& undisturbed) const {
    const TemporaryFolder elsewhere;
    const std::string counts_file = elsewhere.path() / "counts";
    undisturbed = run_with("none 0 0", counts_file);
    std::istringstream counts(read_text(counts_file));
    std::vector<std::pair<std::string, long>> calls;
    std::string call;
    for (long number = 0; counts >> call >> number;) calls.emplace_back(call, number);
    return calls;
  }

  TemporaryFolder folder;
  Files before;
};

/// In the quick run a few of many calls of a kind; where a run works in threads, how many there are varies.
long most_of_a_kind(long quick) { return std::getenv("PARACAL_EVERY_MACHINE") != nullptr ? 100 : quick; }

TEST_P(Injection, LosesNothing) {
  ProgramResult undisturbed;
  const auto all = calls(undisturbed);
  ASSERT_LT(undisturbed.exit_code, 2) << undisturbed.err;
  const Files expected = files_of(folder.path());
  int tried = 0, disturbed = 0;
  for (const auto& [call, number] : all) {
    if (call == "unlink") continue;  // of what only leaves a file behind
    const std::vector<int> errors = call == "malloc" ? std::vector{ENOMEM}
                                    : call == "read" ? std::vector{EIO}
                                    : call == "open" ? std::vector{EACCES, EMFILE}
                                                     : std::vector{ENOSPC, EIO};
    const long step = std::max(1L, number / most_of_a_kind(6));
    for (long k = 1; k <= number; k += step) {
      for (const int error : errors) {
        restore();
        const ProgramResult result = run_with(fmt::format("{} {} {}", call, k, error));
        ++tried;
        disturbed += result.exit_code != undisturbed.exit_code;
        const std::string against = objection(result, undisturbed, expected);
        EXPECT_EQ(against, "") << call << " " << k << " of " << number << ", errno " << error << ": exit code "
                               << result.exit_code << ", " << result.err;
      }
    }
  }
  EXPECT_GT(disturbed, 0);
  fmt::print("  {}: {} injections, {} of them disturbed the command\n", GetParam().command, tried, disturbed);
}

TEST_P(Injection, SignalsLeaveAllOutputsOrNone) {
  ProgramResult undisturbed;
  const auto all = calls(undisturbed);
  ASSERT_LT(undisturbed.exit_code, 2) << undisturbed.err;
  const Files expected = files_of(folder.path());
  int tried = 0, ended = 0;
  for (const auto& [call, number] : all) {
    const long step = std::max(1L, number / most_of_a_kind(3));
    for (long k = 1; k <= number; k += step) {
      for (const int signal : {SIGINT, SIGTERM}) {
        restore();
        const ProgramResult result = run_with(fmt::format("{} {} {}", call, k, -signal));
        ++tried;
        ended += result.exit_code == -signal;
        const std::string against = objection_after_signal(result, signal, undisturbed, expected);
        EXPECT_EQ(against, "") << call << " " << k << " of " << number << ", signal " << signal << ": exit code "
                               << result.exit_code << ", " << result.err;
      }
    }
  }
  EXPECT_GT(GetParam().is_batch ? 1 : ended, 0);
  fmt::print("  {}: {} signals, {} of them ended the command\n", GetParam().command, tried, ended);
}

INSTANTIATE_TEST_SUITE_P(Commands, Injection, testing::ValuesIn(kCommands));

}  // namespace
}  // namespace paracal::test
