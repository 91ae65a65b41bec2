// Every command, with every call that can fail failing once: it ends with a code of the contract and one message, and
// leaves inputs and earlier outputs as they were, and nothing else; what it says is done is what an undisturbed run
// does.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cerrno>
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

  TemporaryFolder folder;
  Files before;
};

TEST_P(Injection, LosesNothing) {
  const TemporaryFolder elsewhere;
  const std::string counts_file = elsewhere.path() / "counts";
  const ProgramResult undisturbed = run_with("none 0 0", counts_file);
  ASSERT_LT(undisturbed.exit_code, 2) << undisturbed.err;
  const Files expected = files_of(folder.path());
  // In the quick run a few of many calls of a kind; where a run works in threads, how many there are varies.
  const long most = std::getenv("PARACAL_EVERY_MACHINE") != nullptr ? 100 : 6;
  int tried = 0, disturbed = 0;
  std::istringstream counts(read_text(counts_file));
  std::string call;
  for (long number = 0; counts >> call >> number;) {
    const std::vector<int> errors = call == "malloc" ? std::vector{ENOMEM}
                                    : call == "read" ? std::vector{EIO}
                                    : call == "open" ? std::vector{EACCES, EMFILE}
                                                     : std::vector{ENOSPC, EIO};
    const long step = std::max(1L, number / most);
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

INSTANTIATE_TEST_SUITE_P(Commands, Injection, testing::ValuesIn(kCommands));

}  // namespace
}  // namespace paracal::test
