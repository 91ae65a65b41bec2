#include "outputs.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "session.hpp"

namespace paracal::app {
namespace {

namespace fs = std::filesystem;

bool is_same_file(const std::string& one, const std::string& other) {
  std::error_code ignored;
  return fs::equivalent(one, other, ignored) && fs::is_regular_file(one, ignored);
}

/// Two names of one file that is not there yet.
bool will_be_same_file(const std::string& one, const std::string& other) {
  std::error_code ignored;
  return !fs::exists(one, ignored) &&
         fs::weakly_canonical(fs::absolute(one), ignored) == fs::weakly_canonical(fs::absolute(other), ignored);
}

[[noreturn]] void refuse(const std::string& option, const std::string& file, const std::string& also) {
  throw WrongUsage(fmt::format("{}: expected a separate file, got {}, which is also {}", option, file, also));
}

/// Sooner than after an hour's work.
void require_writable(const std::string& option, const std::string& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored))
    throw WrongUsage(fmt::format("{}: expected a file, got a folder: {}", option, file));
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) return;
  const fs::path folder = fs::absolute(file).parent_path();
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw WrongUsage(fmt::format("{}: {}: cannot be written: {}", option, file, std::strerror(errno)));
  }
}

}  // namespace

Option* Outputs::declare(Option* option) {
  options_.push_back(option->takes("FILE"));
  return option;
}

bool Outputs::is_output(const Option& option) const { return std::ranges::find(options_, &option) != options_.end(); }

void Outputs::check(const Command& command) const {
  for (const Option& option : command.options()) {
    const std::vector<std::string> values = option.values();
    if (!is_output(option) && values.size() == 1 && values.front().empty()) {  // as "$FILE" is where none was set
      throw WrongUsage(fmt::format("{}: expected a value, got \"\"; state one, or omit the option", option.name()));
    }
  }
  for (const Option& output : command.options()) {
    if (!is_output(output) || !output.is_given()) continue;
    const std::string file = output.values().front(), name = output.name();
    if (file.empty()) throw WrongUsage(fmt::format("{}: expected a file, got \"\"", name));
    for (const Option& other : command.options()) {
      if (&other == &output) continue;
      for (const std::string& value : other.values()) {
        const bool same = is_same_file(file, value) || (is_output(other) && will_be_same_file(file, value));
        if (same) refuse(name, file, other.name());
      }
    }
    if (is_same_file(file, "/dev/stdin")) refuse(name, file, "standard input");
    if (is_same_file(file, "/dev/stdout")) refuse(name, file, "standard output");
    require_writable(name, file);
  }
}

void Outputs::keep_off(const std::vector<std::string>& read) const {
  for (const Option* output : options_) {
    if (!output->is_given()) continue;
    for (const std::string& file : read) {
      if (is_same_file(output->values().front(), file)) refuse(output->name(), file, "read");
    }
  }
}

}  // namespace paracal::app
