#include "run_program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <stdexcept>

#include "support/places.hpp"

namespace paracal::test {
namespace {

/// Functions of posix_spawn return their error, others set errno.
void require(int error, std::string_view what) {
  if (error != 0) throw std::runtime_error(fmt::format("{}: {}", what, std::strerror(error)));
}

/// Pointers into texts, with the null at the end that exec wants.
std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

std::vector<std::string> environment_with(const std::vector<std::string>& added) {
  std::vector<std::string> all(added);
  for (char** entry = environ; *entry != nullptr; ++entry) all.emplace_back(*entry);
  return all;
}

/// Where the program's standard streams go and which folder it starts in.
class SpawnActions {
 public:
  SpawnActions() { require(posix_spawn_file_actions_init(&actions_), "posix_spawn_file_actions_init"); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  void open(int stream, const std::filesystem::path& path, int flags) {
    require(posix_spawn_file_actions_addopen(&actions_, stream, path.c_str(), flags, 0600), path.native());
  }
  void change_folder(const std::filesystem::path& path) {
    require(posix_spawn_file_actions_addchdir_np(&actions_, path.c_str()), path.native());
  }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

int exit_code_of(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) require(errno, "waitpid");
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace

ProgramResult run_program(const std::vector<std::string>& arguments, const Surroundings& where) {
  return RunningProgram(arguments, where).result();
}

RunningProgram::RunningProgram(const std::vector<std::string>& arguments, const Surroundings& where) {
  if (where.standard_output.empty()) out_ = streams_.path() / "out";
  if (where.standard_error.empty()) err_ = streams_.path() / "err";
  SpawnActions actions;
  actions.open(STDIN_FILENO, where.standard_input, O_RDONLY);
  actions.open(STDOUT_FILENO, out_.empty() ? where.standard_output : out_, O_WRONLY | O_CREAT);
  actions.open(STDERR_FILENO, err_.empty() ? where.standard_error : err_, O_WRONLY | O_CREAT | O_NOCTTY);
  if (!where.folder.empty()) actions.change_folder(where.folder);
  std::vector<std::string> command(where.launcher);
  command.push_back(build_folder() / "bin" / where.program);
  command.insert(command.end(), arguments.begin(), arguments.end());
  std::vector<std::string> environment = environment_with(where.environment);
  require(posix_spawn(&process_, command.front().c_str(), actions.get(), nullptr, pointers(command).data(),
                      pointers(environment).data()),
          command.front());
}

RunningProgram::~RunningProgram() {
  if (process_ == 0) return;
  kill(process_, SIGKILL);
  (void)exit_code_of(process_);
}

void RunningProgram::send(int signal) const {
  if (kill(process_, signal) != 0) require(errno, "kill");
}

ProgramResult RunningProgram::result() {
  const int exit_code = exit_code_of(process_);
  process_ = 0;
  return {exit_code, out_.empty() ? "" : read_text(out_), err_.empty() ? "" : read_text(err_)};
}

std::string preloaded_faults() {
  return "LD_PRELOAD=" + (build_folder() / "tests/cli/libparacal-fault-shim.so").string();
}

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (end > 0) result.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

std::vector<std::string> of_huang2016(std::string_view command) {
  std::vector<std::string> arguments = words(command);
  const bool needs_none = std::ranges::any_of(arguments, [](const std::string& word) {
    return word == "--robot" || word == "--printer" || word == "--template" || word == "--list" || word == "--help" ||
           word == "--version" || word == "--licenses";
  });
  if (!needs_none && !arguments.empty()) arguments.insert(arguments.end(), {"--robot", "huang2016"});
  return arguments;
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(stream), {}};
}

TemporaryFolder::TemporaryFolder() {
  std::string name = std::filesystem::temp_directory_path() / "paracal-test-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) require(errno, name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, std::string_view text) const {
  std::ofstream stream(path_ / name, std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw std::runtime_error((path_ / name).string() + ": cannot be written");
  return path_ / name;
}

void TemporaryFolder::make(const std::vector<std::string>& commands) const {
  constexpr auto kAll = std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing;
  static std::map<std::vector<std::string>, std::unique_ptr<TemporaryFolder>> made;
  std::vector<std::string> key = commands;
  for (const std::string& name : names()) key.insert(key.end(), {name, read(name)});
  std::unique_ptr<TemporaryFolder>& place = made[key];
  if (place == nullptr) {
    auto fresh = std::make_unique<TemporaryFolder>();
    std::filesystem::copy(path_, fresh->path(), kAll);
    for (const std::string& command : commands) {
      const ProgramResult result = fresh->run(command);
      if (result.exit_code != kDone) throw std::runtime_error(command + ": " + result.err);
    }
    place = std::move(fresh);
  }
  std::filesystem::copy(place->path(), path_, kAll);
}

std::set<std::string> TemporaryFolder::names() const {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_)) names.insert(entry.path().filename());
  return names;
}

}  // namespace paracal::test
