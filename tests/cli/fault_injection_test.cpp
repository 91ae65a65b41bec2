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
    {"compensate --calibration calibration.json --poses path.csv --json --out out.json"},
    {"export --target gcode --calibration calibration.json --input part.gcode --out out.gcode"},
    {"export --target csv --calibration calibration.json --input plan.csv --out out.csv"},
    {"export --target c99 --calibration calibration.json --out out.h"},
    {"identifiability --poses plan.csv --out out.txt"},
    {"sensitivity --map map.csv --out out.txt"},
    {"tolerance allocate --max-tilt 5e-4 --toml out.toml --out out.txt"},
    {"yield --machines 4 --chunk 2 --checkpoint batch --out out.txt", true},
};

struct Tally {
  int tried = 0, disturbed = 0;
};

class Injection : public testing::TestWithParam<Injected> {
 protected:
  void SetUp() override {
    folder.write("part.gcode", "G1 X0 Y0 Z-900\nG1 X100 Y50 Z-950\n");
    std::string path = "x_mm,y_mm,z_mm\n";  // longer than what waits in memory
    for (int k = 0; k < 700; ++k) path += fmt::format("{},0,-900\n", k / 10.0);
    folder.write("path.csv", path);
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

  template <typename FaultsOf, typename Objection>
  Tally inject(long quick, FaultsOf&& faults_of, Objection&& objection_to) const;

  TemporaryFolder folder;
  Files before;
};

/// Which of the calls of a kind are tried: in the quick run a few of many. The last ones always: what is done by then
/// cannot fail any more. Where a run works in threads, how many calls there are varies.
std::vector<long> tried_of(long number, long quick) {
  const long most = std::getenv("PARACAL_EVERY_MACHINE") != nullptr ? 100 : quick;
  const long step = std::max(1L, number / most), last = std::max(1L, number - 1);
  std::vector<long> tried;
  for (long k = 1; k < last; k += step) tried.push_back(k);
  for (long k = last; k <= number; ++k) tried.push_back(k);
  return tried;
}

/// Runs the command with each fault, and says of each outcome what speaks against it.
/// @param faults_of  a kind of call: what is done to it, numbers of errors, or of signals with a minus.
template <typename FaultsOf, typename Objection>
Tally Injection::inject(long quick, FaultsOf&& faults_of, Objection&& objection_to) const {
  ProgramResult undisturbed;
  const auto all = calls(undisturbed);
  EXPECT_LT(undisturbed.exit_code, 2) << undisturbed.err;
  const Files expected = files_of(folder.path());
  Tally tally;
  for (const auto& [call, number] : all) {
    for (const long k : tried_of(number, quick)) {
      for (const int fault : faults_of(call)) {
        restore();
        const ProgramResult result = run_with(fmt::format("{} {} {}", call, k, fault));
        ++tally.tried;
        tally.disturbed += result.exit_code != undisturbed.exit_code;
        EXPECT_EQ(objection_to(result, fault, undisturbed, expected), "")
            << call << " " << k << " of " << number << ", fault " << fault << ": exit code " << result.exit_code << ", "
            << result.err;
      }
    }
  }
  return tally;
}

TEST_P(Injection, LosesNothing) {
  const auto errors_of = [](const std::string& call) {
    if (call == "unlink") return std::vector<int>{};  // of what only leaves a file behind
    if (call == "malloc") return std::vector{ENOMEM};
    if (call == "read") return std::vector{EIO};
    return call == "open" ? std::vector{EACCES, EMFILE} : std::vector{ENOSPC, EIO};
  };
  const auto [tried, disturbed] = inject(6, errors_of, [this](const auto& result, int, const auto&... undisturbed) {
    return objection(result, undisturbed...);
  });
  EXPECT_GT(disturbed, 0);
  fmt::print("  {}: {} injections, {} of them disturbed the command\n", GetParam().command, tried, disturbed);
}

TEST_P(Injection, SignalsLeaveAllOutputsOrNone) {
  const auto signals = [](const std::string&) { return std::vector{-SIGINT, -SIGTERM}; };
  const auto [tried, ended] = inject(3, signals, [this](const auto& result, int fault, const auto&... undisturbed) {
    return objection_after_signal(result, -fault, undisturbed...);
  });
  EXPECT_GT(GetParam().is_batch ? 1 : ended, 0);
  fmt::print("  {}: {} signals, {} of them ended the command\n", GetParam().command, tried, ended);
}

INSTANTIATE_TEST_SUITE_P(Commands, Injection, testing::ValuesIn(kCommands));

}  // namespace
}  // namespace paracal::test
