#include "session.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>

#include "paracal/io/robot_statement.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/mechanism/level.hpp"
#include "paracal/units.hpp"
#include "terminal.hpp"

namespace paracal::app {

namespace fs = std::filesystem;

Command* Session::add_command(Command& parent, const std::string& name, const std::string& job,
                              const std::string& what) {
  Command* command = parent.add_command(name, what, job);
  command->heading("Common");
  command
      ->add_option("--robot", robot_,
                   "robot file (TOML) or catalogue name; not needed where a calibration or a table names its robot")
      ->takes("FILE|NAME");
  command->add_flag("--json", json_, "print one JSON object on standard output and nothing else");
  outputs.declare(command->add_option("--out", out_, "write the result to this file, completely or not at all"));
  command->add_option("--seed", seed_, "seed of all random numbers")
      ->check(whole_number(0, std::numeric_limits<std::uint64_t>::max()));
  command->add_option("--threads", threads_, "number of threads; 0: all cores")
      ->check(whole_number(0, std::numeric_limits<unsigned>::max()));
  command->heading("Options");
  command->check_all([this, command] { outputs.check(*command); });
  return command;
}

namespace {

std::string catalogue_names() {
  std::string names;
  for (const std::string_view name : catalogue::names()) names.append(names.empty() ? "" : ", ").append(name);
  return names;
}

io::RobotStatement robot_of_option(const std::string& name) {
  try {
    io::RobotStatement stated = io::named_robot(name);
    stated.by = "--robot";
    return stated;
  } catch (const InvalidArgument& unknown) {
    throw WrongUsage(std::string("--robot: ") + unknown.what() + " (a robot file ends in .toml)");
  }
}

/// What is said, in the order in which it counts.
std::vector<io::RobotStatement> statements(const std::string& option, const RobotSources& inputs, Session& session) {
  std::vector<io::RobotStatement> all;
  if (!option.empty()) all.push_back(robot_of_option(option));
  for (const std::string& name : inputs.calibrations) {
    // Behind another statement its reader compares: then it need not describe a whole robot.
    if (!name.empty() && all.empty()) all.push_back(io::robot_of_calibration(session.calibration_file(name)));
  }
  for (const std::string& name : inputs.tables) {
    if (name.empty()) continue;
    if (auto stated = io::robot_of_table(look_into(name))) all.push_back(std::move(*stated));
  }
  if (inputs.rows != nullptr) {
    if (auto stated = inputs.rows->robot()) all.push_back(std::move(*stated));
  }
  return all;
}

/// Empty where guides let the plate go there.
std::string_view why_held(const Machine& machine, const Pose& pose) {
  if (inverse(machine, pose).unreachable_limb >= 0 || inverse(machine, pose).ok()) return {};
  return machine.freedoms.holds_z() ? "expected z and tilts as the guides fix them"
                                    : "expected tilts as the guides fix them";
}

}  // namespace

Robot Session::robot(const RobotSources& inputs) {
  const std::vector<io::RobotStatement> stated = statements(robot_, inputs, *this);
  if (stated.empty()) {
    throw WrongUsage(fmt::format(
        "--robot: expected a robot, got none: give a catalogue name ({}), a file (.toml), or a line \"# robot: "
        "NAME\" in the measurements",
        catalogue_names()));
  }
  for (const io::RobotStatement& one : stated) io::require_same(stated.front(), one);
  if (inputs.rows != nullptr) inputs.rows->expect(stated.front());
  robot_file_ = stated.front().robot_file;
  if (robot_file_) outputs.keep_off({robot_file_->string()});  // a table may name it
  return stated.front().robot;
}

std::string Session::robot_line(const Robot& robot) const {
  if (!robot_file_) return io::robot_line(robot);
  try {
    if (!fs::is_regular_file(*robot_file_)) return "";  // a pipe is read once
    const fs::path folder = out_.empty() ? fs::current_path() : fs::absolute(out_).parent_path();
    fs::path path = fs::relative(*robot_file_, folder);
    if (path.extension() != ".toml" && !path.has_parent_path()) path = "." / path;
    const std::string line = fmt::format("# robot: {}", path.string());
    const auto read = io::robot_of_line(out_, 0, line);  // not all names are read as they are written
    const bool is_named = line.find('\n') == std::string::npos && fs::equivalent(*read->robot_file, *robot_file_);
    return is_named ? line + "\n" : "";
  } catch (const std::exception&) {
    return "";
  }
}

void require_level(const Robot& robot, std::string_view task) {
  try {
    check_level(robot, task);
  } catch (const InvalidArgument& refused) {
    throw WrongUsage(refused.what());
  }
}

std::string_view why_not_turned(const Robot& robot, const Pose& pose) {
  if (!robot.commands_tilt() && !pose.tilt.isZero(0.0)) return "expected no tilt, because this plate stays level";
  if (robot.slide() || pose.rotation == 0.0) return why_held(robot.nominal(), pose);
  return robot.commands_tilt() ? "expected phi = 0 deg, because this plate turns by tilt_z"
                               : "expected phi = 0 deg, because a rigid plate does not turn";
}

Pose pose_of_option(const Robot& robot, std::string_view option, const std::vector<double>& numbers) {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const plausible::Range range = k < 3 ? plausible::length(robot.reach()) : plausible::kAngle;
    if (const auto complaint = plausible::complaint(option, numbers[k], range)) throw WrongUsage(*complaint);
  }
  const bool tilts = robot.commands_tilt();
  if (numbers.size() != 3 && numbers.size() != (tilts ? 6 : 4)) {
    throw WrongUsage(fmt::format("{}: expected x,y,z{} for {}, got {} numbers", option,
                                 tilts ? " or x,y,z,tilt_x,tilt_y,tilt_z" : " or x,y,z,phi", robot.name(),
                                 numbers.size()));
  }
  Pose pose{{numbers[0], numbers[1], numbers[2]}};
  if (numbers.size() == 4) pose.rotation = to_radians(numbers[3]);
  for (std::size_t k = 3; tilts && k < numbers.size(); ++k) {
    pose.tilt(static_cast<Eigen::Index>(k) - 3) = to_radians(numbers[k]);
  }
  if (const std::string_view why = why_not_turned(robot, pose); !why.empty()) {
    const std::string what = robot.nominal().has_guides
                                 ? fmt::format("({:g}, {:g}, {:g}) mm", numbers[0], numbers[1], numbers[2])
                                 : fmt::format("{:g} deg", to_degrees(pose.rotation));
    throw MathematicsSaysNo(fmt::format("{}: {} for {}: {}", option, what, robot.name(), why));
  }
  return pose;
}

const io::JsonFile& Session::calibration_file(const std::string& name) {
  const auto found = calibrations_.find(name);
  return (found != calibrations_.end() ? found : calibrations_.emplace(name, io::read_stored(name)).first)->second;
}

SourceErrors Session::read_errors(const Robot& robot, const std::string& errors_file) {
  if (is_calibration(errors_file)) {
    const SourceErrors errors = io::read_calibration(calibration_file(errors_file), robot).errors;
    forget_calibration(errors_file);
    return errors;
  }
  const io::TextFile file = io::read_stored(errors_file);
  const SourceErrors errors = io::read_source_errors(file, robot.joint_space());
  if (const auto complaint = implausible(robot, errors)) throw InputFileError(file.name, 0, *complaint);
  return errors;
}

MachineAsBuilt Session::machine_as_built(const Robot& robot, const std::string& errors_file) {
  if (errors_file.empty()) return {robot.nominal()};
  if (!is_calibration(errors_file)) return {build(robot, read_errors(robot, errors_file))};
  const KnownErrors known = io::read_calibration(calibration_file(errors_file), robot).known();
  forget_calibration(errors_file);
  return {build(robot, known.errors), known.drives()};
}

std::string pose_text(const Station& station) {
  const Pose& pose = station.commanded;
  const Eigen::Vector3d& r = pose.position;
  const std::string place =
      fmt::format("{}: pose {} at ({:g}, {:g}, {:g}) mm", station.stated_in, station.name, r.x(), r.y(), r.z());
  if (pose.tilt.isZero(0.0)) return fmt::format("{}, {:g} deg", place, to_degrees(pose.rotation));
  return fmt::format("{}, tilted by ({:g}, {:g}, {:g}) deg", place, to_degrees(pose.tilt.x()),
                     to_degrees(pose.tilt.y()), to_degrees(pose.tilt.z()));
}

std::string joints_key(Actuator actuator) { return fmt::format("joints_{}", file_unit(joint_unit(actuator))); }

io::Json joints_json(const io::NamedJoints& row, Actuator actuator) {
  const auto in_unit = [&](double joint) { return to_file_unit(joint_unit(actuator), joint); };
  return {{"name", row.name}, {joints_key(actuator), io::json_array(row.joints, in_unit)}};
}

io::TextSink Session::result_sink() {
  if (out_.empty()) return standard_output_;
  return outputs.store.begin(out_);
}

void Session::print(std::string_view text) { result_sink()(text); }

void Session::print_verdict(const std::string& text, bool is_met) { standard_output_(with_verdict(text, is_met)); }

namespace {

std::int64_t seconds_of(std::string_view text) {
  constexpr std::int64_t kYear9999 = 253402300799;
  const auto seconds = number_in<std::int64_t>(text);
  if (seconds && *seconds >= 0 && *seconds <= kYear9999) return *seconds;
  throw WrongUsage(fmt::format("SOURCE_DATE_EPOCH: expected seconds since 1970, got \"{}\"", text));
}

}  // namespace

std::int64_t now() {
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH")) return seconds_of(fixed);
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::string shell_word(std::string_view word) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=./,:@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos) return std::string(word);
  std::string text = "'";
  for (const char c : word) c == '\'' ? text += "'\\''" : text += c;
  return text + "'";
}

std::string shell_line(const std::vector<std::string>& arguments) {
  std::string line = "paracal";
  for (const std::string& argument : arguments) line.append(" ").append(shell_word(argument));
  return line;
}

void write_to_standard_output(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written) throw Error("standard output: cannot be written");
}

namespace {

/// File names may hold bytes that are no UTF-8, which JSON cannot.
std::string dumped(const io::Json& json, int indent) {
  return json.dump(indent, ' ', false, io::Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string json_text(const io::Json& json) { return dumped(json, 2); }

std::string json_line(const io::Json& json) { return dumped(json, -1); }

void Session::finish() {
  if (ranks_.number() != 0) return;
  outputs.store.commit();
  std::fputs(last_words_.c_str(), stderr);  // wants no memory: what is done can no longer fail
}

void Session::print_json(const io::Json& json) { print(json_text(json)); }

}  // namespace paracal::app
