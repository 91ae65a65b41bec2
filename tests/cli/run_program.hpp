#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace paracal::test {

bool every_machine();  // of support/virtual_machines.hpp

/// Exit codes of the contract.
constexpr int kDone = 0, kVerdictIsNo = 1, kWrongUsage = 2, kBadInputFile = 3, kMathematicsSaysNo = 4;

/// What a finished run of the program left.
struct ProgramResult {
  int exit_code = 0;  ///< minus the signal's number where a signal ended it
  std::string out;    ///< standard output
  std::string err;    ///< standard error
};

/// Where the program runs.
struct Surroundings {
  std::filesystem::path folder = {};          ///< current directory; empty: that of the tests
  std::vector<std::string> environment = {};  ///< NAME=value, beside the environment of the tests
  std::filesystem::path standard_input = "/dev/null";
  std::filesystem::path standard_output = {};  ///< empty: captured into ProgramResult::out
  std::filesystem::path standard_error = {};   ///< empty: captured into ProgramResult::err
  std::vector<std::string> launcher = {};      ///< a program, by its path, that starts paracal, with its arguments
  std::string program = "paracal";             ///< in the folder of programs
};

/// Runs paracal to its end. Arguments reach it as they stand here: no shell is involved.
ProgramResult run_program(const std::vector<std::string>& arguments, const Surroundings& where = {});

/// LD_PRELOAD=... that lets a call fail as PARACAL_FAULT says (fault_shim.cpp); not under sanitizers.
std::string preloaded_faults();

/// "forward --json" as two words.
std::vector<std::string> words(std::string_view text);

/// The words of a command, with --robot huang2016 behind those that may need a robot and name none.
std::vector<std::string> of_huang2016(std::string_view command);

std::string read_text(const std::filesystem::path& path);

/// A new, empty folder that goes when this does.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Path of the new file.
  std::string write(const std::string& name, std::string_view text) const;
  std::string read(const std::string& name) const { return read_text(path_ / name); }
  /// Leaves what these commands leave here, each done by run(); in a process that has done the same from the same files
  /// before, copies it.
  void make(const std::vector<std::string>& commands) const;
  /// Names of everything in the folder, hidden files too.
  std::set<std::string> names() const;
  /// Runs paracal with this folder as the current directory.
  ProgramResult run(const std::vector<std::string>& arguments) const {
    return run_program(arguments, {.folder = path_});
  }
  /// The same; of_huang2016().
  ProgramResult run(std::string_view command) const { return run(of_huang2016(command)); }

 private:
  std::filesystem::path path_;
};

/// paracal while it runs; killed where nobody waits for its end.
class RunningProgram {
 public:
  explicit RunningProgram(const std::vector<std::string>& arguments, const Surroundings& where = {});
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void send(int signal) const;
  /// Waits for its end; once.
  ProgramResult result();

 private:
  TemporaryFolder streams_;
  std::filesystem::path out_, err_;  ///< empty: not captured
  int process_ = 0;                  ///< 0: ended
};

}  // namespace paracal::test
