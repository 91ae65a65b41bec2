#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "inputs.hpp"
#include "jobs/ranks.hpp"
#include "outputs.hpp"
#include "paracal/calibration/prediction.hpp"
#include "paracal/error.hpp"
#include "paracal/io/file.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/tables.hpp"
#include "paracal/mechanism/machine.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal::app {

/// Exit codes of the contract.
enum ExitCode : int { kDone = 0, kVerdictIsNo = 1, kWrongUsage = 2, kBadInputFile = 3, kMathematicsSaysNo = 4 };

/// The arguments contradict each other or name nothing (exit code 2).
class WrongUsage : public Error {
  using Error::Error;
};

/// Unreachable, singular (exit code 4).
class MathematicsSaysNo : public Error {
  using Error::Error;
};

/// "pose P3 at (500, 0, -888) mm, 90 deg", for messages.
std::string pose_text(const Station& station);

/// The pose of an option: x,y,z and, of a plate with six freedoms, its tilts, else phi; mm and deg. What is left out is
/// zero.
/// @throws WrongUsage for numbers that are none or too many, MathematicsSaysNo for a turn that the plate cannot take.
Pose pose_of_option(const Robot& robot, std::string_view option, const std::vector<double>& numbers);

/// What a plate is asked that it cannot do: "a rigid plate does not turn: expected phi = 0 deg"; empty where it can.
std::string_view why_not_turned(const Robot& robot, const Pose& pose);

/// @throws WrongUsage for a plate with six freedoms, for what is done only for plates that stay level.
void require_level(const Robot& robot, std::string_view task);

/// Seconds since 1970, or SOURCE_DATE_EPOCH where someone wants the same bytes again.
std::int64_t now();

/// "joints_deg"; "joints_mm" of rails.
std::string joints_key(Actuator actuator);
/// {name, joints_deg: [q1, ...]}, of one pose.
io::Json joints_json(const io::NamedJoints& row, Actuator actuator);

/// A JSON object as it is printed, and in one line.
std::string json_text(const io::Json& json);
std::string json_line(const io::Json& json);

/// @throws Error when it cannot be written.
void write_to_standard_output(std::string_view text);

/// A word as a shell takes it for what it is.
std::string shell_word(std::string_view word);

/// Arguments behind "paracal", as a line that a shell takes apart again as they were.
std::string shell_line(const std::vector<std::string>& arguments);

/// What all commands share: the common options and where results go.
/// A machine, and where its drives bring its joints.
struct MachineAsBuilt {
  Machine machine;
  DriveCurves drives = {};
};

class Session {
 public:
  /// @param ranks  that compute long jobs; each of them runs the command, and the first one writes.
  Session(io::TextSink standard_output, jobs::Ranks& ranks)
      : standard_output_(std::move(standard_output)), ranks_(ranks), threads_(ranks.size() > 1 ? 1 : 0) {}

  /// A new command with the common options, listed in --help under the user's job.
  Command* add_command(Command& parent, const std::string& name, const std::string& job, const std::string& what);

  /// The robot that --robot, a calibration or a table names; where several do, they name the same.
  /// @throws WrongUsage where none does or an output is its file, InputFileError where two disagree.
  Robot robot(const RobotSources& inputs = {});
  /// "# robot: NAME" for a table of this robot(): its name in the catalogue, or the path of its file from the folder of
  /// --out (else from the current one), as readers of the table look for it. Empty where a table cannot name it.
  std::string robot_line(const Robot& robot) const;
  /// The file that described it, where one did.
  const std::optional<std::filesystem::path>& robot_file() const { return robot_file_; }

  /// A calibration file. Each is read once, so that all see the same one even if it changes meanwhile.
  const io::JsonFile& calibration_file(const std::string& name);
  /// Frees the memory of one whose machine is known, before rows without end.
  void forget_calibration(const std::string& name) { calibrations_.erase(name); }
  /// Source errors of a file: source errors (TOML) or a calibration (JSON).
  SourceErrors read_errors(const Robot& robot, const std::string& errors_file);
  /// Machine that --errors describes, as read_errors(), with the drives of a calibration; the nominal one without a
  /// file.
  MachineAsBuilt machine_as_built(const Robot& robot, const std::string& errors_file);

  bool json() const { return json_; }
  const std::string& out() const { return out_; }
  std::uint64_t seed() const { return seed_; }
  /// Of this process; 0: all.
  unsigned threads() const { return threads_; }
  jobs::Ranks& ranks() { return ranks_; }
  /// Takes a result piece by piece, to standard output or, whole or not at all, --out.
  io::TextSink result_sink();
  /// Prints a result, or writes it whole to --out.
  void print(std::string_view text);
  void print_json(const io::Json& json);
  /// What goes to standard output even with --out.
  void print_summary(std::string_view text) { standard_output_(text); }
  /// The same, for a result whose first line is its verdict: a terminal shows it and the notes in colour.
  void print_verdict(const std::string& text, bool is_met);
  /// For standard error, once all outputs are in their places: nobody reads of targets that are then not there.
  void say_when_done(std::string text) { last_words_ = std::move(text); }
  /// Puts the outputs into their places and says so.
  void finish();

  Outputs outputs;
  ExitCode exit_code = kDone;
  std::vector<std::string> words;  ///< of the command line, behind the program's name

 private:
  io::TextSink standard_output_;
  jobs::Ranks& ranks_;
  std::string robot_;
  std::map<std::string, io::JsonFile> calibrations_;  ///< by the names under which they were read
  std::optional<std::filesystem::path> robot_file_;   ///< known once robot() has found it
  std::string out_;
  std::string last_words_;
  bool json_ = false;
  std::uint64_t seed_ = 1;
  unsigned threads_;
};

/// One function a command (commands/NAME.cpp): declares its options and what it does.
void add_robot(Command& program, Session& session);
void add_inverse(Command& program, Session& session);
void add_forward(Command& program, Session& session);
void add_error_model(Command& program, Session& session);
void add_poses(Command& program, Session& session);
void add_identifiability(Command& program, Session& session);
void add_simulate(Command& program, Session& session);
void add_calibrate(Command& program, Session& session);
void add_validate(Command& program, Session& session);
void add_sensitivity(Command& program, Session& session);
void add_tolerance_allocate(Command& tolerance, Session& session);
void add_tolerance_analyze(Command& tolerance, Session& session);
void add_report(Command& program, Session& session);
void add_reproduce(Command& program, Session& session);
void add_yield(Command& program, Session& session);
void add_compensate(Command& program, Session& session);
void add_export(Command& program, Session& session);
void add_schema(Command& program, Session& session);
void add_demo(Command& program, Session& session);
void add_printer(Command& program, Session& session);
/// Both read the whole tree of commands once they are called.
void add_help(Arguments& arguments, Session& session);
void add_manual(Arguments& arguments, Session& session);

}  // namespace paracal::app
