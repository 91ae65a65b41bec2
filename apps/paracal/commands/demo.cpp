#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

#include "interruption.hpp"
#include "output_folder.hpp"
#include "paracal/compensation/parameters.hpp"
#include "paracal/io/file.hpp"
#include "program.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

namespace fs = std::filesystem;

/// A command as it is typed in the folder, without "paracal".
struct Step {
  std::string what;
  std::string command;
  std::string text_file = {};             ///< where a shell would put what it prints
  std::vector<std::string> telling = {};  ///< lines of that text to show: how they begin

  std::string shell_line() const {
    return "paracal " + command + (text_file.empty() ? std::string() : " > " + text_file);
  }
};

/// From the choice of poses to a compensated controller.
/// @param seed      of the machine, its check and its noise.
/// @param exported  the robot has a compensator.
std::vector<Step> steps_of(const std::string& robot, std::uint64_t seed, bool exported) {
  const std::string tracker = "--noise-mm 0.017 --repeats 3 --frame random";
  std::vector<Step> steps{
      {"Choose the 20 poses that determine the errors best.",
       fmt::format("poses --robot {} --optimal 20 --candidates 2000 --out plan.csv", robot)},
      {"Simulate a machine within the tolerances and measure it: noise 0.017 mm, three visits per pose.",
       fmt::format("simulate --poses plan.csv --seed {} {} --truth truth.toml --out measured.csv", seed + 6, tracker)},
      {"Identify the errors of the machine, with their uncertainty.",
       "calibrate --measurements measured.csv --out calibration.json",
       "calibration.txt",
       {"calibration of", "uncertainty over the workspace", "  uncertainty over the workspace", "  residuals"}},
      {"Choose 30 other poses to check the calibration.",
       fmt::format("poses --robot {} --optimal 30 --candidates 2000 --criterion D --seed 2 --out check_plan.csv",
                   robot)},
      {"Simulate measurements of the same machine at these poses.",
       fmt::format("simulate --poses check_plan.csv --errors truth.toml --seed {} {} --out check.csv", seed + 7,
                   tracker)},
      {"Check the calibration against these measurements: is every error below 0.1 mm?",
       "validate --calibration calibration.json --measurements check.csv --limit-mm 0.1",
       "validation.txt",
       {"validation", "  largest errors", "  distance to home", "  position", "  distance error"}},
      {"Compute compensated joint angles for these poses.",
       "compensate --calibration calibration.json --poses check_plan.csv --out joints.csv"}};
  if (exported) {
    steps.push_back({"Export the compensation as C code for a controller.",
                     "export --calibration calibration.json --target c99 --out compensator.h"});
  }
  steps.push_back(
      {"Write the HTML report.", "report --calibration calibration.json --measurements check.csv --out report.html"});
  return steps;
}

std::vector<std::string> words_of(const std::string& command) {
  std::istringstream stream(command);
  return {std::istream_iterator<std::string>(stream), {}};
}

struct Done {
  Step step;
  int exit_code = kDone;
  std::string text = {};  ///< what it printed
};

struct Demonstration {
  std::vector<Done> steps = {};
  std::map<std::string, std::string> files = {};
};

constexpr std::string_view kScript = "commands.sh", kRobotFile = "robot.toml";
constexpr std::string_view kScriptHead = "#!/bin/sh\n# The commands of paracal demo. Repeat them: sh commands.sh\n";

std::string script_of(const std::vector<Step>& steps) {
  std::string script(kScriptHead);
  for (const Step& step : steps) script += fmt::format("\n# {}\n{}\n", step.what, step.shell_line());
  return script;
}

/// Names of all files that the steps write, and of what stands beside them.
std::set<std::string> names_of_files(const std::vector<Step>& steps) {
  std::set<std::string> names{std::string(kScript), std::string(kRobotFile)};
  for (const Step& step : steps) {
    if (!step.text_file.empty()) names.insert(step.text_file);
    const std::vector<std::string> words = words_of(step.command);
    for (std::size_t k = 0; k + 1 < words.size(); ++k) {
      if (words[k] == "--out" || words[k] == "--truth") names.insert(words[k + 1]);
    }
  }
  return names;
}

/// The folder that is filled: a new or empty one, or one that an earlier demo filled, and nobody else.
OutputFolder folder_for(const std::vector<Step>& steps, const std::string& name) {
  const fs::path script = fs::path(name) / kScript;
  std::error_code ignored;
  const bool is_made_here = fs::exists(script, ignored) && io::read_stored(script).text.starts_with(kScriptHead);
  const std::set<std::string> files = names_of_files(steps);
  return {"demo", name, [&](const fs::directory_entry& entry) {
            return is_made_here && entry.is_regular_file() && files.contains(entry.path().filename().string());
          }};
}

/// A new, empty folder under $TMPDIR, the current one while this lives; gone with it.
class ScratchFolder {
 public:
  /// @throws std::exception when it cannot be made.
  ScratchFolder() {
    std::string name = fs::temp_directory_path() / "paracal-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw fs::filesystem_error(name, {errno, std::generic_category()});
    path_ = name;
    try {
      fs::current_path(path_);
    } catch (...) {
      fs::remove(path_);
      throw;
    }
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::current_path(before_, ignored);
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  /// Its files, by their names.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(path_)) {
      all[entry.path().filename()] = io::read_stored(entry.path()).text;
    }
    return all;
  }

 private:
  fs::path before_ = fs::current_path();
  fs::path path_;
};

/// Everything, in a folder that is gone afterwards; as far as it came where somebody interrupts it.
/// @param texts  files that the steps read.
Demonstration demonstrate(const std::vector<Step>& steps, std::map<std::string, std::string> texts, Session& session,
                          const std::atomic<bool>& interrupted) {
  const ScratchFolder scratch;
  Demonstration all;
  for (const auto& [name, text] : texts) std::ofstream(name, std::ios::binary) << text;
  texts[std::string(kScript)] = script_of(steps);
  for (const Step& step : steps) {
    Done done{step};
    const auto take = [&done](std::string_view text) { done.text += text; };
    done.exit_code = run_program(words_of(step.command), take, session.ranks());
    if (interrupted) return all;
    if (!step.text_file.empty()) texts[step.text_file] = done.text;
    all.steps.push_back(std::move(done));
  }
  all.files = scratch.files();
  all.files.merge(texts);
  return all;
}

bool tells(const Step& step, const std::string& line) {
  return std::ranges::any_of(step.telling, [&](const std::string& start) { return line.starts_with(start); });
}

std::string text_of(const Demonstration& all, const fs::path& folder) {
  std::string text;
  for (const Done& done : all.steps) {
    text += fmt::format("{}\n  $ {}\n", done.step.what, done.step.shell_line());
    std::istringstream lines(done.text);
    for (std::string line; std::getline(lines, line);) {
      if (tells(done.step, line)) text += fmt::format("    {}\n", line);
    }
  }
  const std::string quoted = shell_word(folder.string());
  return text +
         fmt::format("\n{} files are in {}; open report.html there.\nTo repeat the commands: cd {} && sh commands.sh\n",
                     all.files.size(), folder.string(), quoted);
}

io::Json json_of(const Demonstration& all, const fs::path& folder) {
  const auto step_json = [](const Done& done) {
    return io::Json{{"what", done.step.what},
                    {"command", done.step.shell_line()},
                    {"exit_code", done.exit_code},
                    {"text", done.text}};
  };
  return {{"folder", folder.string()},
          {"steps", io::json_array(all.steps, step_json)},
          {"files", io::json_array(all.files, [](const auto& file) { return file.first; })}};
}

void run(const std::string& folder_name, bool has_robot, Session& session) {
  std::string robot = "huang2016";
  std::map<std::string, std::string> files;
  bool exported = true;
  if (has_robot) {
    robot = session.robot().name();
    exported = has_compensator(session.robot());
    if (const auto& file = session.robot_file()) {
      robot = kRobotFile;
      files[robot] = io::read_stored(*file).text;
    }
  }
  const std::vector<Step> steps = steps_of(robot, session.seed(), exported);
  const OutputFolder folder = folder_for(steps, folder_name);
  const std::atomic<bool>& interrupted = flag_of_interruption();
  const Demonstration all = demonstrate(steps, std::move(files), session, interrupted);
  if (interrupted) end_by_interruption();
  session.json() ? session.print_json(json_of(all, folder.path())) : session.print(text_of(all, folder.path()));
  folder.write(all.files);
}

}  // namespace

void add_demo(Command& program, Session& session) {
  Command* command = session.add_command(
      program, "demo", "Try it", "run a whole calibration of a simulated machine, and keep every file and command");
  const auto folder = std::make_shared<std::string>("paracal-demo");
  command->add_option("folder", *folder, "folder for the files: new, empty, or from an earlier demo");
  command->example("Run it in the folder paracal-demo", "paracal demo");
  command->callback([&session, command, folder] { run(*folder, command->get_option("--robot")->is_given(), session); });
}

}  // namespace paracal::app
