// Every command, with every call that can fail failing once: it ends with a code of the contract and one message, and
// leaves inputs and earlier outputs as they were, and nothing else; what it says is done is what an undisturbed run
// does. All this on the disk that is here and on a plain one (fault_shim.cpp); what a signal breaks off is done again.
// The same where the folder of its outputs goes away, and where its standard output cannot be written. And every
// command, interrupted before any such call: all its outputs are there, or none. The end says how often all that held.
// With PARACAL_EVERY_MACHINE every call fails; else one of each kind, drawn by a seed that is another one for each
// commit. PARACAL_FAULT_SEED=N repeats a run.

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <tuple>

#include "fault_shim.hpp"
#include "printer/klipper_sets.hpp"
#include "run_program.hpp"
#include "support/places.hpp"

namespace paracal::test::fault_injection_test {
namespace {

/// Names and texts; a name of a folder ends in a slash.
using Files = std::map<std::string, std::string>;

Files files_of(const std::filesystem::path& folder) {
  Files files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = std::filesystem::relative(entry.path(), folder);
    entry.is_directory() ? files[name + "/"] = "" : files[name] = read_text(entry.path());
  }
  return files;
}

/// PARACAL_FAULT_SEED, or the first digits of the commit; 0 where the sources are in no repository.
std::uint32_t seed() {
  static const auto number = [] {
    if (const char* stated = std::getenv("PARACAL_FAULT_SEED")) return static_cast<std::uint32_t>(std::stoul(stated));
    const std::string head_of = "exec git -C '" + source_folder().string() + "' rev-parse --short=8 HEAD 2>/dev/null";
    const ProgramResult head = run_program({}, {.launcher = {"/bin/sh", "-c", head_of}});
    return head.exit_code == 0 ? static_cast<std::uint32_t>(std::stoul(head.out.substr(0, 8), nullptr, 16)) : 0;
  }();
  return number;
}

/// One of a number of things, whichever tests run beside this one.
std::size_t drawn(const std::string& of, std::size_t number) {
  std::vector<std::uint32_t> words(of.begin(), of.end());
  words.push_back(seed());
  std::seed_seq sequence(words.begin(), words.end());
  std::mt19937 engine(sequence);
  return std::uniform_int_distribution<std::size_t>(0, number - 1)(engine);
}

/// What was tried in this process, and how much of it held.
class Account : public testing::Environment {
 public:
  void add(const std::string& command, const std::string& fault, bool held) {
    commands_.insert(command);
    faults_.insert(fault);
    ++tried_;
    held_ += held;
  }
  void TearDown() override {
    if (tried_ == 0) return;
    const std::string held = held_ == tried_ ? "all held" : fmt::format("{} held", held_);
    const std::string which = every_machine() ? "" : fmt::format("; PARACAL_FAULT_SEED={}", seed());
    fmt::print("{} injections of {} faults in {} commands: {}{}\n", tried_, faults_.size(), commands_.size(), held,
               which);
  }

 private:
  int tried_ = 0, held_ = 0;
  std::set<std::string> commands_, faults_;
};

Account& account() {
  static auto* const all = new Account;  // of the framework, once it is handed over
  return *all;
}

const testing::Environment* const kHandedOver = testing::AddGlobalTestEnvironment(&account());

struct Injected {
  std::string command;
  enum Kind : std::uint8_t {
    plain,
    stops,   ///< a signal makes it state what it has so far: exit code 1
    batch,   ///< so does it, and its chunks stay: that is what they are for
    lengthy  ///< left to PARACAL_EVERY_MACHINE
  } kind = plain;
  std::string input = "/dev/null";  ///< its standard input

  bool is_batch() const { return kind == batch; }
};

void PrintTo(const Injected& one, std::ostream* stream) { *stream << one.command; }

const std::vector<Injected> kCommands{
    {"robot --out out.toml"},
    {"schema calibration --out out.json"},
    {"poses --stage rough --out out.csv"},
    {"poses --optimal 8 --candidates 40 --out out.csv"},
    {"inverse --poses plan.csv --errors calibration.json --out out.csv"},
    {"forward --joints joints.csv --out out.csv"},
    {"inverse --poses /dev/stdin --out out.csv", Injected::plain, "plan.csv"},
    {"forward --joints /dev/stdin --out out.csv", Injected::plain, "joints.csv"},
    {"error-model --pose 100,50,-900,20 --out out.txt"},
    {"simulate --poses plan.csv --truth truth.toml --out out.csv"},
    {"calibrate --measurements points.csv --tolerances tolerances.toml --out out.json --report out.html"},
    {"calibrate --printer printer.cfg --out out.json"},
    {"calibrate --printer advised.cfg --apply"},
    {"validate --calibration calibration.json --measurements points.csv --out out.json"},
    {"report --calibration calibration.json --measurements points.csv --out out.html"},
    {"compensate --calibration calibration.json --poses plan.csv --out out.csv"},
    {"compensate --calibration calibration.json --poses path.csv --json --out out.json"},
    {"compensate --calibration calibration.json --poses /dev/stdin --out out.csv", Injected::plain, "plan.csv"},
    {"export --target gcode --calibration calibration.json --input part.gcode --out out.gcode"},
    {"export --target csv --calibration calibration.json --input plan.csv --out out.csv"},
    {"export --target c99 --calibration calibration.json --out out.h"},
    {"export --target linuxcnc --calibration calibration.json --out out.comp"},
    {"export --target json --calibration calibration.json --out out.json"},
    {"identifiability --poses plan.csv --out out.txt"},
    {"sensitivity --map map.csv --out out.txt"},
    {"tolerance allocate --max-tilt 5e-4 --toml out.toml --out out.txt"},
    {"tolerance analyze --failure-error 0.5 --tolerances tolerances.toml --out out.txt --report "
     "out.html",
     Injected::stops},
    {"yield --machines 2 --chunk 1 --checkpoint batch --out out.txt --report out.html", Injected::batch},
    {"reproduce huang2016 --out out.txt --report out.html", Injected::lengthy},
};

bool is_output(const std::string& word) {
  return word.starts_with("out.") || word == "truth.toml" || word == "map.csv";
}

/// What makes the files that commands read.
const std::map<std::string, std::string> kMadeBy{
    {"plan.csv", "poses --stage rough --out plan.csv"},
    {"joints.csv", "inverse --poses plan.csv --out joints.csv"},
    {"fine.csv", "poses --stage fine --out fine.csv"},
    {"points.csv", "simulate --poses fine.csv --noise-mm 0.01 --frame random --out points.csv"},
    {"calibration.json", "calibrate --measurements points.csv --out calibration.json"},
};

std::string shortest_config() {
  return std::ranges::min(klipper_sets(), {}, [](const KlipperSet& set) { return set.config.size(); }).config;
}

/// More results than what waits in memory holds.
std::string long_path() {
  std::string path = "x_mm,y_mm,z_mm\n";
  for (int k = 0; k < 700; ++k) path += fmt::format("{},0,-900\n", k / 10.0);
  return path;
}

/// Text of a file that commands read, made once; empty: none of kMadeBy.
std::string made(const std::string& name) {
  static const TemporaryFolder folder;
  const auto made_by = kMadeBy.find(name);
  if (made_by == kMadeBy.end()) return "";
  if (!exists(folder.path() / name)) {
    for (const std::string& word : words(made_by->second)) {
      if (word != name) (void)made(word);  // before it what it is made of
    }
    EXPECT_EQ(folder.run(made_by->second).exit_code, 0) << made_by->second;
  }
  return folder.read(name);
}

/// The robot's own tolerances.
const std::string& tolerances() {
  static const std::string text = [] {
    const std::string robot = run_program(of_huang2016("robot")).out;
    return robot.substr(robot.find("[tolerances]"));
  }();
  return text;
}

/// A run without faults, what it leaves, and how often it makes each call.
struct Undisturbed {
  ProgramResult result;
  Files files;
  std::vector<std::pair<std::string, long>> calls;
};

/// What is done to calls, each by a test of its own.
enum class Fault : std::uint8_t { error, signal, vanishing };

class Injection : public testing::TestWithParam<Injected> {
 protected:
  /// Whether this run leaves the command out.
  static bool is_left_out() { return GetParam().kind == Injected::lengthy && !every_machine(); }

  void SetUp() override {
    if (is_left_out()) return;
    for (const std::string& word : words(GetParam().command + " " + GetParam().input)) {
      if (kMadeBy.contains(word)) folder.write(word, made(word));
      if (word == "path.csv") folder.write(word, long_path());
      if (word == "part.gcode") folder.write(word, "G1 X0 Y0 Z-900\nG1 X100 Y50 Z-950\n");
      if (word == "printer.cfg") folder.write(word, shortest_config());
      if (word == "advised.cfg") folder.write(word, read_text(source_folder() / "samples/printer.cfg"));
      if (word == "tolerances.toml") folder.write(word, tolerances());
    }
    inputs = files_of(folder.path());
    arguments = of_huang2016(GetParam().command);
    set_out("", true);
  }

  /// Outputs go to a folder, or where the program runs; files of an earlier run stand there, or none.
  void set_out(const std::string& results, bool earlier) {
    before = inputs;
    if (!results.empty()) before[results + "/"] = "";
    arguments = of_huang2016(GetParam().command);
    for (std::string& word : arguments) {
      if (!is_output(word)) continue;
      if (!results.empty()) word = results + "/" + word;
      if (earlier) before[word] = "earlier";
    }
    restore();
  }

  Surroundings here(const std::vector<std::string>& environment) const {
    return {.folder = folder.path(), .environment = environment, .standard_input = folder.path() / GetParam().input};
  }

  ProgramResult run_with(const std::string& fault, std::vector<std::string> environment = {}) const {
    for (const std::string& one : {preloaded_faults(), "PARACAL_FAULT=" + fault, std::string("SOURCE_DATE_EPOCH=0")}) {
      environment.push_back(one);
    }
    if (is_plain) environment.emplace_back("PARACAL_FAULT_DISK=plain");
    return run_program(arguments, here(environment));
  }

  void restore() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) remove_all(entry.path());
    for (const auto& [name, text] : before) {
      name.ends_with("/") ? (void)create_directory(folder.path() / name) : (void)folder.write(name, text);
    }
  }

  static bool is_of_batch(const Files::value_type& file) { return file.first.starts_with("batch"); }

  /// What speaks against a run that was refused.
  std::string objection_to_refusal(const ProgramResult& result) const {
    Files now = files_of(folder.path());
    if (result.exit_code < 2 || result.exit_code > 4) return "ended otherwise than the contract says";
    if (std::ranges::count(result.err, '\n') != 1 || !result.err.starts_with("paracal: ")) return "said no one message";
    if (GetParam().is_batch()) std::erase_if(now, is_of_batch);
    return now == before ? "" : "left other files than it found";
  }

  /// @returns what speaks against the outcome; nothing of a good one.
  std::string objection(const ProgramResult& result, const Undisturbed& undisturbed) const {
    if (result.exit_code != undisturbed.result.exit_code) return objection_to_refusal(result);
    if (result.out != undisturbed.result.out) return "said something else";
    return files_of(folder.path()) == undisturbed.files ? "" : "left other files than an undisturbed run";
  }

  /// All outputs are there, and the text says that not all was done.
  bool says_partial(const Files& now) const {
    const auto is_as_done = [&](const auto& old, const auto& file) {
      return old.first == file.first && inputs.contains(old.first) == (old.second == file.second);
    };
    return std::ranges::equal(before, now, is_as_done) && now.at("out.txt").find("partial") != std::string::npos;
  }

  /// The same of a run that got a signal.
  std::string objection_after_signal(const ProgramResult& result, int signal, const Undisturbed& undisturbed) const {
    Files now = files_of(folder.path());
    if (std::ranges::any_of(now, [](const auto& file) { return file.first.find(".paracal-") != std::string::npos; })) {
      return "left a temporary file";
    }
    const bool stopped = GetParam().kind != Injected::plain && result.exit_code == kVerdictIsNo;
    const bool ended = result.exit_code == undisturbed.result.exit_code || stopped;
    if (!ended && result.exit_code != -signal) return "ended neither by the signal nor in spite of it";
    if (GetParam().is_batch()) return objection_to_resumption(undisturbed);
    if (stopped) return says_partial(now) ? "" : "did not say that it stopped";
    return now == undisturbed.files || (!ended && now == before) ? "" : "left neither all its outputs nor none";
  }

  /// A batch goes on where it was.
  std::string objection_to_resumption(const Undisturbed& undisturbed) const {
    (void)run_with("none 0 0");
    const bool held = files_of(folder.path()) == undisturbed.files;
    return held ? "" : "did not go on to what an undisturbed run leaves";
  }

  /// The same of a run whose folder went; it is put back first, so that all is where it would have been.
  std::string objection_after_vanishing(const ProgramResult& result, const std::filesystem::path& gone,
                                        const Undisturbed& undisturbed) const {
    const std::filesystem::path away = gone.string() + ".away";
    if (exists(away) && exists(gone)) return "made a folder that had been there";
    if (exists(away)) rename(away, gone);
    if (!GetParam().is_batch()) create_directory(gone);
    const std::string complaint = objection(result, undisturbed);
    return complaint.empty() && GetParam().is_batch() ? objection_to_resumption(undisturbed) : complaint;
  }

  /// Of the command as set_out() left it; run once for all tests that start from the same files.
  const Undisturbed& undisturbed() const {
    static std::map<std::tuple<std::vector<std::string>, Files, bool>, Undisturbed> known;
    const auto [place, is_new] = known.try_emplace({arguments, before, is_plain});
    Undisturbed& one = place->second;
    if (!is_new) return one;
    const TemporaryFolder elsewhere;
    const std::string counts_file = elsewhere.path() / "counts";
    restore();
    one.result = run_with("none 0 0", {"PARACAL_FAULT_COUNTS=" + counts_file});
    one.files = files_of(folder.path());
    std::istringstream counts(read_text(counts_file));
    std::string call;
    for (long number = 0; counts >> call >> number;) one.calls.emplace_back(call, number);
    EXPECT_LT(one.result.exit_code, 2) << one.result.err;
    return one;
  }

  /// Enters one run into the account.
  static void judge(const std::string& fault, const std::string& complaint, const ProgramResult& result,
                    const std::string& where) {
    account().add(GetParam().command, fault, complaint.empty());
    EXPECT_EQ(complaint, "") << fault << ", " << where << ": exit code " << result.exit_code << ", " << result.err;
  }

  template <typename FaultsOf, typename Objection>
  int inject(Fault kind, FaultsOf&& faults_of, Objection&& objection_to,
             const std::vector<std::string>& environment = {}) const;

  TemporaryFolder folder;
  /// On the disk that is here and on a plain one; in the quick run on one of them.
  template <typename Test>
  void on_each_disk(Test&& test) {
    for (const bool plain : {false, true}) {
      if (!every_machine() && plain != (drawn(GetParam().command + " on", 2) == 1)) continue;
      is_plain = plain;
      test();
    }
  }

  Files inputs, before;
  std::vector<std::string> arguments;
  bool is_plain = false;
};

/// Which of the calls of a kind fail, and how: all, of more than `most` every few, the last ones always: what is done
/// by then cannot fail any more. Where a run works in threads, their number varies. In the quick run one call, in the
/// test that is drawn.
std::vector<std::pair<long, int>> tried_of(const std::string& name, Fault kind, long number, long most,
                                           const std::vector<int>& faults) {
  std::vector<std::pair<long, int>> tried;
  if (number == 0 || faults.empty()) return tried;
  if (!every_machine()) {
    if (drawn(name + " by", 3) != static_cast<std::size_t>(kind)) return tried;
    tried.emplace_back(1 + drawn(name, static_cast<std::size_t>(number)), faults[drawn(name + " of", faults.size())]);
    return tried;
  }
  const long step = std::max(1L, number / most), last = std::max(1L, number - 1);
  for (long k = 1; k <= number; k += k < last ? std::min(step, last - k) : 1) {
    for (const int fault : faults) tried.emplace_back(k, fault);
  }
  return tried;
}

std::string name_of_fault(const std::string& call, int fault) {
  if (fault == kTakesNothing) return call + " that takes nothing";
  if (fault < 0) return fmt::format("{} before {}", strsignal(-fault), call);
  return fault == 0 ? "no folder at " + call : fmt::format("{} of {}", std::strerror(fault), call);
}

/// Runs the command with each fault, and says of each outcome what speaks against it.
/// @param faults_of  a kind of call: what is done to it, numbers of errors, or of signals with a minus.
/// @returns how many runs ended otherwise than an undisturbed one.
template <typename FaultsOf, typename Objection>
int Injection::inject(Fault kind, FaultsOf&& faults_of, Objection&& objection_to,
                      const std::vector<std::string>& environment) const {
  const Undisturbed& usual = undisturbed();
  const long most = GetParam().kind == Injected::lengthy ? 5 : 100;
  int disturbed = 0;
  for (const auto& [call, all] : usual.calls) {
    // What `tolerance analyze` tells of rare failures comes last, and stopped there it ends as if it were done.
    const bool is_stopped = kind == Fault::signal && GetParam().kind == Injected::stops && !every_machine();
    const long number = is_stopped ? (all + 1) / 2 : all;
    for (const auto& [k, fault] : tried_of(GetParam().command + call, kind, number, most, faults_of(call))) {
      restore();
      const ProgramResult result = run_with(fmt::format("{} {} {}", call, k, fault), environment);
      disturbed += result.exit_code != usual.result.exit_code;
      judge(name_of_fault(call, fault), objection_to(result, fault, usual), result,
            fmt::format("{} of {}{}", k, number, is_plain ? ", plain disk" : ""));
    }
  }
  return disturbed;
}

TEST_P(Injection, LosesNothing) {
  if (is_left_out()) return;
  const auto errors_of = [](const std::string& call) {
    if (call == "unlink") return std::vector<int>{};  // of what only leaves a file behind
    if (call == "malloc") return std::vector{ENOMEM};
    if (call == "read") return std::vector{EIO, EINTR};
    if (call == "write") return std::vector{ENOSPC, EIO, EINTR, kTakesNothing};
    return call == "open" ? std::vector{EACCES, EMFILE, EINTR} : std::vector{ENOSPC, EIO, EINTR};
  };
  const auto objection_to = [this](const ProgramResult& result, int fault, const Undisturbed& usual) {
    const bool is_as_usual = result.exit_code == usual.result.exit_code && result.err == usual.result.err;
    if (fault == EINTR && !is_as_usual) return std::string("did not do again what a signal broke off");
    return objection(result, usual);
  };
  on_each_disk([&] {
    const int disturbed = inject(Fault::error, errors_of, objection_to);
    EXPECT_GT(disturbed, every_machine() ? 0 : -1);
  });
}

TEST_P(Injection, SignalsLeaveAllOutputsOrNone) {
  if (is_left_out()) return;
  const auto signals = [](const std::string&) { return std::vector{-SIGINT, -SIGTERM}; };
  on_each_disk([&] {
    const int ended = inject(Fault::signal, signals, [this](const auto& result, int fault, const auto& usual) {
      return objection_after_signal(result, -fault, usual);
    });
    EXPECT_GT(GetParam().is_batch() ? 1 : ended, every_machine() ? 0 : -1);
  });
}

/// Where what was replaced cannot be put back either, as from some call on no file can be renamed, it is not lost, and
/// the message says where it is.
TEST(Injections, WhatCannotBePutBackIsNamed) {
  constexpr int kMostRenames = 4;  // that put two files into their places
  for (const std::string disk : {"PARACAL_NO_FAULT=", "PARACAL_FAULT_DISK=plain"}) {
    int named = 0;
    for (int from = 1; from <= kMostRenames; ++from) {
      const TemporaryFolder folder;
      for (const char* name : {"out.toml", "out.txt"}) folder.write(name, std::string("earlier ") + name);
      const std::string fault = fmt::format("PARACAL_FAULT=rename -{} {}", from, EIO);
      const ProgramResult result =
          run_program(of_huang2016("tolerance allocate --max-tilt 5e-4 --toml out.toml --out out.txt"),
                      {.folder = folder.path(), .environment = {preloaded_faults(), fault, disk}});
      const std::size_t begin = result.err.find(".paracal-"), end = result.err.find(' ', begin);
      if (begin == std::string::npos) continue;
      ++named;
      EXPECT_EQ(result.exit_code, kWrongUsage);
      const std::string kept = folder.read(result.err.substr(begin, end - begin));
      EXPECT_THAT(kept, testing::StartsWith("earlier out."));
      EXPECT_THAT(result.err, testing::HasSubstr("; the earlier " + kept.substr(8) + " is kept as .paracal-"));
    }
    EXPECT_GT(named, 0) << disk;
  }
}

/// A signal that waited until the outputs were in their places is not lost.
TEST_P(Injection, SignalsComeInTheEnd) {
  if (GetParam().kind != Injected::plain) return;  // others handle them
  const Undisturbed& usual = undisturbed();
  const std::vector<int> signals{SIGINT, SIGTERM, SIGHUP};
  for (const int signal : signals) {
    if (!every_machine() && signal != signals[drawn(GetParam().command, signals.size())]) continue;
    restore();
    const ProgramResult result = run_with(fmt::format("rename 1 {}", -signal));
    const bool held = result.exit_code == -signal && files_of(folder.path()) == usual.files;
    judge(name_of_fault("the first rename", -signal), held ? "" : "was lost", result, "");
  }
}

/// The folder of the outputs, or that of a batch: moved away, or removed where nothing is in it. What moves takes the
/// outputs along.
TEST_P(Injection, VanishedFoldersTakeAllOutputsOrNone) {
  if (is_left_out()) return;
  const auto vanishes = [](const std::string& call) {
    return call == "malloc" || call == "unlink" ? std::vector<int>{} : std::vector{0};
  };
  const std::string gone = GetParam().is_batch() ? "batch" : "results";
  for (const bool is_empty : {false, true}) {
    if (is_empty && (GetParam().is_batch() || !every_machine())) continue;  // a batch makes its own
    set_out(GetParam().is_batch() ? "" : gone, !is_empty);
    inject(Fault::vanishing, vanishes,
           [&](const auto& result, int, const auto& usual) {
             return objection_after_vanishing(result, folder.path() / gone, usual);
           },
           {"PARACAL_FAULT_FOLDER=" + gone});
  }
}

/// A shell line that ends in the program, which stands behind it.
std::vector<std::string> behind(const std::string& line) { return {"/bin/sh", "-c", line}; }

/// A pipe whose reader goes: at once, or after it has got so many bytes.
ProgramResult run_into_pipe(const std::vector<std::string>& arguments, Surroundings where, std::size_t bytes) {
  const TemporaryFolder elsewhere;
  where.standard_output = elsewhere.path() / "pipe";
  if (mkfifo(where.standard_output.c_str(), 0600) != 0) throw std::runtime_error("mkfifo");
  const int reader = open(where.standard_output.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  fcntl(reader, F_SETPIPE_SZ, 4096);
  RunningProgram running(arguments, where);
  fcntl(reader, F_SETFL, 0);
  std::string got(bytes, '\0');
  if (bytes > 0 && read(reader, got.data(), bytes) < 0) throw std::runtime_error("read");
  close(reader);
  return running.result();
}

/// What is printed and not written to --out, into what takes nothing, or no more.
TEST_P(Injection, StandardOutputsThatFailLoseNothing) {
  if (is_left_out()) return;
  if (const auto out = std::ranges::find(arguments, "--out"); out != arguments.end()) arguments.erase(out, out + 2);
  const std::size_t one = drawn(GetParam().command, 6);
  for (const bool json : {false, true}) {
    if (json && !every_machine()) break;
    if (json) arguments.emplace_back("--json");
    restore();
    const ProgramResult usual = run_with("none 0 0");
    const Files expected = files_of(folder.path());
    if (usual.exit_code > 1 || usual.out.empty()) continue;  // prints no JSON, or nothing
    std::size_t next = 0;
    const auto is_left_to_others = [&] { return next++ != one && !every_machine(); };
    const auto expect_refused = [&](const std::string& fault, const Surroundings& where) {
      if (is_left_to_others()) return;
      restore();
      const ProgramResult result = run_program(arguments, where);
      const bool is_refused = result.exit_code == kWrongUsage && result.err.find("standard output") < 50;
      judge(fault, is_refused ? objection_to_refusal(result) : "did not refuse", result, json ? "JSON" : "text");
    };
    const auto with = [&](const auto& change) {
      Surroundings where = here({"SOURCE_DATE_EPOCH=0"});
      change(where);
      return where;
    };
    expect_refused("full standard output", with([](auto& where) { where.standard_output = "/dev/full"; }));
    expect_refused("closed standard output",
                   with([](auto& where) { where.launcher = behind("exec \"$0\" \"$@\" >&-"); }));
    for (const std::size_t bytes : {0U, 1U}) {
      for (const bool ignored : {false, true}) {
        if (is_left_to_others()) continue;
        restore();
        const ProgramResult result = run_into_pipe(arguments, with([&](auto& where) {
                                                     if (ignored)
                                                       where.launcher = behind("trap '' PIPE; exec \"$0\" \"$@\"");
                                                   }),
                                                   bytes);
        Files now = files_of(folder.path());
        if (GetParam().is_batch()) std::erase_if(now, is_of_batch);
        std::string complaint;
        if (result.exit_code == usual.exit_code) {  // nobody was gone yet
          if (files_of(folder.path()) != expected) complaint = "left other files than an undisturbed run";
        } else if (!ignored) {
          complaint = result.exit_code == -SIGPIPE && result.err.empty() && now == before ? "" : "ended otherwise";
        } else {
          complaint = objection_to_refusal(result);
        }
        judge(fmt::format("no reader{}{}", bytes > 0 ? " any more" : "", ignored ? ", signal ignored" : ""), complaint,
              result, json ? "JSON" : "text");
      }
    }
  }
}

/// What came through a pipe until its writer died is what a file of that length says.
TEST_P(Injection, PipesThatBreakOffAreShortFiles) {
  const std::string& input = GetParam().input;
  if (input == "/dev/null") return;
  const std::string text = folder.read(input);
  const std::size_t step = every_machine() ? 7 : text.size();
  for (std::size_t length = every_machine() ? 0 : drawn(input, step); length < text.size(); length += step) {
    restore();
    folder.write("short.csv", text.substr(0, length));
    Surroundings where = here({"SOURCE_DATE_EPOCH=0"});
    where.standard_input = folder.path() / "short.csv";
    const ProgramResult expected = run_program(arguments, where);
    const Files files = files_of(folder.path());
    restore();
    folder.write("short.csv", text.substr(0, length));
    where.standard_input = "/dev/null";
    where.launcher = behind("cat short.csv | \"$0\" \"$@\"");
    const ProgramResult result = run_program(arguments, where);
    const bool held = result.exit_code == expected.exit_code && result.exit_code != kWrongUsage &&
                      result.out == expected.out && result.err == expected.err && files_of(folder.path()) == files;
    judge("a writer that dies", held ? "" : "took it otherwise", result, fmt::format("after {} bytes", length));
  }
}

/// Whether this process may mount a disk of its own.
bool can_mount() {
  static const bool can =
      run_program({}, {.launcher = {"/usr/bin/unshare", "-rm", "/bin/sh", "-c", "mount -t tmpfs -o size=8k none /tmp"}})
          .exit_code == 0;
  return can;
}

/// A disk of a few pages, mounted where no other process sees it, with what it holds in the end copied off it. Where
/// none can be mounted the table's own ENOSPC has to do.
TEST_P(Injection, FullDisksLoseNothing) {
  if (is_left_out()) return;
  if (!can_mount()) return fmt::print("  no disk of one's own here\n");
  const std::string disk = GetParam().is_batch() ? "batch" : "results";
  set_out(GetParam().is_batch() ? "" : disk, true);
  const Undisturbed& usual = undisturbed();
  std::vector<int> sizes{8, 16, 32, 64, 256, 1024, 4096};  // KiB
  if (!every_machine()) sizes = {8};
  for (const int size : sizes) {
    restore();
    Surroundings where = here({"SOURCE_DATE_EPOCH=0"});
    where.launcher = {"/usr/bin/unshare", "-rm", "/bin/sh", "-c",
                      fmt::format("mkdir -p {0} kept; cp -a {0} earlier; mount -t tmpfs -o size={1}k none {0} || exit; "
                                  "cp -a earlier/. {0}; \"$0\" \"$@\"; code=$?; cp -a {0}/. kept; exit $code",
                                  disk, size)};
    const ProgramResult result = run_program(arguments, where);
    for (const std::string& name : {disk, std::string("earlier")}) remove_all(folder.path() / name);
    rename(folder.path() / "kept", folder.path() / disk);
    std::string complaint = objection(result, usual);
    if (complaint.empty() && GetParam().is_batch()) complaint = objection_to_resumption(usual);
    judge("full disk", complaint, result, fmt::format("of {} KiB", size));
  }
}

INSTANTIATE_TEST_SUITE_P(Commands, Injection, testing::ValuesIn(kCommands));

}  // namespace
}  // namespace paracal::test::fault_injection_test
