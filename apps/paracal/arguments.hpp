#pragma once

#include <charconv>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "description.hpp"
#include "paracal/io/file.hpp"
#include "paracal/mechanism/option_limits.hpp"
#include "paracal/mechanism/plausible.hpp"

// The command line library costs each unit that includes it four seconds: arguments.cpp and usage.cpp alone do.
namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace paracal::app {

/// A text that is one number from its first character to its last.
template <typename Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  return error == std::errc{} && at == end ? std::optional(number) : std::nullopt;
}

/// What the text of an option must be.
class Rule {
 public:
  explicit Rule(const CLI::Validator& validator);
  /// @param complaint  of a text; empty: none.
  /// @param shown      in --help.
  /// @param rewrites   whether the complaint writes the text in another way, too.
  Rule(const std::function<std::string(std::string& text)>& complaint, const std::string& shown, bool rewrites = false);
  void set_on(CLI::Option& option) const;

 private:
  std::shared_ptr<const CLI::Validator> validator_;
};

Rule one_of(const std::vector<std::string>& words);
Rule between(double smallest, double largest);
Rule within(const plausible::Range& range);
/// Limits and the like, which no robot has beyond plausible::kLimit.
Rule positive();
/// The same, and zero.
Rule non_negative();
/// Whole numbers from `smallest` to `largest`, 1e6 and the like, too.
Rule whole_number(std::uint64_t smallest, std::uint64_t largest);
inline Rule within(const option_limits::Whole& range) { return whole_number(range.least, range.most); }

/// Heading of what --help does not show.
inline constexpr const char* kHidden = "hidden";

/// An option of a command. Everything that declares returns the option itself.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}
  Option* required(bool is_required = true);
  Option* check(const Rule& rule);
  Option* needs(const Option* other);
  Option* excludes(const Option* other);
  /// Several values in one text, between commas.
  /// @param what  --help calls them: X,Y,Z.
  Option* lists(const std::string& what);
  Option* lists(const std::string& what, int least, int most);
  Option* lists(const std::string& what, int count) { return lists(what, count, count); }
  /// What --help calls the default, where it is not the value that the option begins with; empty: none.
  Option* shows_default(const std::string& text);
  Option* hide();
  /// What --help calls its value: DEG, FILE.
  Option* takes(const std::string& what);

  std::string name() const;
  bool is_given() const;
  /// As typed.
  std::vector<std::string> values() const;
  /// Of what a rule found to be numbers.
  std::vector<double> numbers() const;
  /// Of a flag.
  bool is_set() const;

 private:
  CLI::Option* option_;
};

/// A command, or the program itself. Options and commands live as long as it does.
class Command {
 public:
  explicit Command(CLI::App& command) : command_(&command) {}
  /// @param value  set when the arguments are parsed: a string, a number, an optional<double>, or a vector of either.
  ///               What it holds before is the default, which --help shows but of vectors and empty strings.
  ///               --help calls a string FILE, an integer N, and other numbers by the unit at the end of the name.
  template <typename Value>
  Option* add_option(const std::string& name, Value& value, const std::string& text);
  Option* add_flag(const std::string& name, bool& value, const std::string& text);
  /// A flag and an option whose values are taken from the option itself.
  Option* add_flag(const std::string& name, const std::string& text);
  Option* add_text(const std::string& name, const std::string& text);
  Option* add_choice(const std::string& name, const std::function<void(const std::string&)>& choose,
                     const std::string& text);
  /// The heading in --help of the options that follow; kHidden: they are not shown.
  void heading(const std::string& heading) { heading_ = heading; }
  void example(const std::string& purpose, const std::string& line) { examples_.push_back({purpose, line}); }
  Command* add_command(const std::string& name, const std::string& text, const std::string& group);
  /// Without one of its commands it is wrong usage.
  void require_command();
  /// What it does once everything is parsed and checked.
  void callback(const std::function<void()>& run);
  /// What is looked at before that.
  void check_all(const std::function<void()>& look);
  Option* get_option(std::string_view name);
  const Option* get_option(std::string_view name) const { return const_cast<Command*>(this)->get_option(name); }
  const std::deque<Option>& options() const { return options_; }

 private:
  friend class Arguments;
  Option* keep(CLI::Option* option, const std::string& kind);
  void add_examples(CommandText& text) const;
  CLI::App* command_;
  std::string heading_ = "Options";
  std::vector<Example> examples_ = {};
  std::deque<Option> options_ = {};
  std::deque<bool> flags_ = {};
  std::deque<Command> commands_ = {};
};

/// What the program says of itself.
struct ProgramText {
  std::string about, name, version, footer;
  std::function<std::string()> licences;
};

/// The program's arguments.
class Arguments {
 public:
  explicit Arguments(const ProgramText& text);
  Arguments(const Arguments&) = delete;
  Arguments& operator=(const Arguments&) = delete;
  ~Arguments();
  Command& program() { return program_; }
  /// Parses them, as they follow the program's name, and runs the command.
  /// @param standard_output  takes what --help, --version and --licenses say.
  /// @returns an exit code where all was said by --help, --version or --licenses.
  /// @throws WrongUsage in one line, with the option or command that was probably meant.
  std::optional<int> run(const std::vector<std::string>& words, const io::TextSink& standard_output);
  /// Everything that --help says, of every command.
  CommandText describe() const;

 private:
  std::unique_ptr<CLI::App> app_;
  Command program_;
};

}  // namespace paracal::app
