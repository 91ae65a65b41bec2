#include "arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "help.hpp"
#include "paracal/spelling.hpp"
#include "session.hpp"
#include "usage.hpp"

namespace paracal::app {

Rule::Rule(const CLI::Validator& validator) : validator_(std::make_shared<const CLI::Validator>(validator)) {}

Rule::Rule(const std::function<std::string(std::string& text)>& complaint, const std::string& shown, bool rewrites)
    : Rule(CLI::Validator(complaint, shown).non_modifying(!rewrites)) {}

void Rule::set_on(CLI::Option& option) const {
  validator_->get_modifying() ? option.transform(*validator_) : option.check(*validator_);
}

Rule one_of(const std::vector<std::string>& words) {
  const std::string shown = fmt::format("{{{}}}", fmt::join(words, ","));
  const auto complaint = [words](const std::string& text) {
    if (std::ranges::find(words, text) != words.end()) return std::string();
    return fmt::format("expected one of {}, got {}{}", fmt::join(words, ", "), text, did_you_mean(text, words));
  };
  return {complaint, shown};
}

namespace {

/// A number as people write one: 100000, 1e5.
std::optional<std::uint64_t> whole(std::string_view text) {
  constexpr double kLargestExact = 9007199254740992.0;  // 2^53
  if (const auto number = number_in<std::uint64_t>(text)) return number;
  const double value = number_in<double>(text).value_or(-1.0);
  const bool is_whole = value >= 0.0 && value <= kLargestExact && value == std::floor(value);
  return is_whole ? std::optional(static_cast<std::uint64_t>(value)) : std::nullopt;
}

}  // namespace

Rule within(const plausible::Range& range) {
  const auto complaint = [range](const std::string& text) {
    double value = 0.0;
    if (!CLI::detail::lexical_cast(text, value)) return fmt::format("expected a number, got {}", text);
    return plausible::complaint("a number", value, range).value_or("");
  };
  return {complaint, fmt::format("NUMBER in [{:g} - {:g}]", range.least, range.most)};
}

Rule between(double smallest, double largest) { return within(plausible::Range{smallest, largest}); }

Rule positive() { return within(plausible::kLimit); }

Rule non_negative() { return within(option_limits::kStd); }

Rule whole_number(std::uint64_t smallest, std::uint64_t largest) {
  const auto rewrite = [smallest, largest](std::string& text) {
    const auto number = whole(text);
    if (!number || *number < smallest || *number > largest) {
      return fmt::format("expected a whole number from {} to {}, got {}", smallest, largest, text);
    }
    text = std::to_string(*number);
    return std::string();
  };
  return {rewrite, fmt::format("INT in [{} - {}]", smallest, largest), true};
}

Option* Option::required(bool is_required) {
  option_->required(is_required);
  return this;
}

Option* Option::check(const Rule& rule) {
  rule.set_on(*option_);
  return this;
}

Option* Option::needs(const Option* other) {
  option_->needs(other->option_);
  return this;
}

Option* Option::excludes(const Option* other) {
  option_->excludes(other->option_);
  return this;
}

Option* Option::lists(const std::string& what) { return lists(what, 1, CLI::detail::expected_max_vector_size); }

Option* Option::lists(const std::string& what, int least, int most) {
  option_->delimiter(',')->type_name(what)->expected(least, most);
  return this;
}

Option* Option::shows_default(const std::string& text) {
  option_->default_str(text);
  return this;
}

Option* Option::hide() {
  option_->group(kHidden);
  return this;
}

Option* Option::takes(const std::string& what) {
  option_->type_name(what);
  return this;
}

std::string Option::name() const { return option_->get_name(); }

bool Option::is_given() const { return option_->count() > 0; }

std::vector<std::string> Option::values() const { return option_->results(); }

std::vector<double> Option::numbers() const { return option_->as<std::vector<double>>(); }

bool Option::is_set() const { return option_->as<bool>(); }

namespace {

/// What a value is where the option does not say.
template <typename Value>
std::string usual_kind(const std::string& name) {
  if constexpr (std::is_same_v<Value, std::string> || std::is_same_v<Value, std::vector<std::string>>) return "FILE";
  if constexpr (std::is_integral_v<Value>) return "N";
  for (const auto& [end, unit] : {std::pair{"-mm", "MM"}, {"-deg", "DEG"}, {"-ppm", "PPM"}, {"-c", "CELSIUS"}}) {
    if (name.ends_with(end)) return unit;
  }
  return "NUMBER";
}

}  // namespace

Option* Command::keep(CLI::Option* option, const std::string& kind) {
  if (!kind.empty()) option->type_name(kind);
  option->group(heading_);
  return &options_.emplace_back(*option);
}

template <typename Value>
Option* Command::add_option(const std::string& name, Value& value, const std::string& text) {
  CLI::Option* const option = command_->add_option(name, value, text);
  if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>) option->capture_default_str();
  return keep(option, usual_kind<Value>(name));
}
template Option* Command::add_option(const std::string&, std::string&, const std::string&);
template Option* Command::add_option(const std::string&, int&, const std::string&);
template Option* Command::add_option(const std::string&, unsigned&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option* Command::add_option(const std::string&, double&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::string>&, const std::string&);

Option* Command::add_flag(const std::string& name, bool& value, const std::string& text) {
  return keep(command_->add_flag(name, value, text), "");
}

Option* Command::add_flag(const std::string& name, const std::string& text) {
  return add_flag(name, flags_.emplace_back(false), text);
}

Option* Command::add_text(const std::string& name, const std::string& text) {
  return keep(command_->add_option(
                  name, [](const CLI::results_t&) { return true; }, text),
              usual_kind<double>(name));
}

Option* Command::add_choice(const std::string& name, const std::function<void(const std::string&)>& choose,
                            const std::string& text) {
  return keep(command_->add_option_function<std::string>(name, choose, text), "NAME");
}

Command* Command::add_command(const std::string& name, const std::string& text, const std::string& group) {
  CLI::App* const command = command_->add_subcommand(name, text);
  command->group(group);
  command->get_help_ptr()->group("Common");
  return &commands_.emplace_back(*command);
}

void Command::require_command() { command_->require_subcommand(1); }

void Command::callback(const std::function<void()>& run) { command_->callback(run); }

void Command::check_all(const std::function<void()>& look) { command_->parse_complete_callback(look); }

Option* Command::get_option(std::string_view name) {
  return &*std::ranges::find(options_, name, [](const Option& one) { return one.name(); });
}

Arguments::Arguments(const ProgramText& text)
    : app_(std::make_unique<CLI::App>(text.about, text.name)), program_(*app_) {
  app_->set_help_flag("-h,--help", "show this help");
  app_->set_version_flag("--version", text.version, "show the version");
  // Shown as the version is: nothing else is done.
  const auto show = [licences = text.licences] { throw CLI::CallForVersion(licences(), 0); };
  app_->add_flag_callback("--licenses", show, "show the licences of the software in this program");
  app_->require_subcommand(0, 1);
  app_->footer(text.footer);
}

Arguments::~Arguments() = default;

std::optional<int> Arguments::run(const std::vector<std::string>& words, const io::TextSink& standard_output) {
  try {
    app_->parse(std::vector<std::string>(words.rbegin(), words.rend()));  // the first last, as it wants them
  } catch (const CLI::CallForHelp&) {
    const CommandText program = describe();
    const CommandText* const chosen = find_command(program, chosen_words(*app_));
    standard_output(help_text(chosen == nullptr ? program : *chosen));
    return 0;
  } catch (const CLI::CallForVersion& version) {
    standard_output(std::string(version.what()) + "\n");
    return 0;
  } catch (const CLI::ParseError& error) {
    throw WrongUsage(usage_complaint(*app_, error));
  }
  if (app_->get_subcommands().empty()) throw WrongUsage("expected a command, got none; see paracal --help");
  return std::nullopt;
}

void Command::add_examples(CommandText& text) const {
  text.examples = examples_;
  for (CommandText& below : text.commands) {
    for (const Command& one : commands_) {
      if (one.command_->get_name() == word_of(below)) one.add_examples(below);
    }
  }
}

CommandText Arguments::describe() const {
  CommandText all = description(*app_);
  program_.add_examples(all);
  return all;
}

}  // namespace paracal::app
