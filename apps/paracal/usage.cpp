#include "usage.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "arguments.hpp"
#include "io/files/letters.hpp"
#include "paracal/spelling.hpp"

namespace paracal::app {
namespace {

/// What could stand where something unknown stood: options of the command, or commands.
std::vector<std::string> known_words(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::Option* option : command.get_options()) words.push_back(option->get_name());
  for (const CLI::App* one : command.get_subcommands({})) words.push_back(one->get_name());
  return words;
}

/// The command that the arguments went to.
const CLI::App& innermost(const CLI::App& app) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return chosen.empty() ? app : innermost(*chosen.front());
}

std::string whole_name(const CLI::App& command) {
  return command.get_parent() == nullptr ? command.get_name()
                                         : whole_name(*command.get_parent()) + " " + command.get_name();
}

/// Those of "NAME:{one,other}".
std::vector<std::string> choices_in(const std::string& kind) {
  const std::size_t begin = kind.find('{'), end = kind.find('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  return CLI::detail::split(kind.substr(begin + 1, end - begin - 1), ',');
}

OptionText description(const CLI::Option& option) {
  OptionText text{
      .names = {}, .positional = {}, .value = {}, .text = option.get_description(), .group = option.get_group()};
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  if (text.names.empty()) {
    text.positional = io::upper_case(option.get_name(true));
  }
  const std::string kind = option.get_type_name();
  text.choices = choices_in(kind);
  text.takes_value = option.get_items_expected_max() > 0;
  text.is_required = option.get_required();
  if (text.takes_value && !text.names.empty()) {
    text.value =
        text.choices.empty() ? kind.substr(0, kind.find(':')) : fmt::format("{}", fmt::join(text.choices, "|"));
    const bool is_repeated = option.get_items_expected_max() > 1 && option.get_delimiter() == '\0';
    if (is_repeated) text.value += " ...";
  }
  if (text.names.empty() && !text.choices.empty()) text.text += fmt::format(": {}", fmt::join(text.choices, ", "));
  if (!option.get_default_str().empty()) text.text += fmt::format(" (default: {})", option.get_default_str());
  return text;
}

/// The option that CLI11's own message is about: the one with the longest name in it.
const CLI::Option* option_in(const CLI::App& command, const std::string& message) {
  const CLI::Option* found = nullptr;
  for (const CLI::Option* one : command.get_options()) {
    const bool is_longer = found == nullptr || one->get_name().size() > found->get_name().size();
    if (message.find(one->get_name()) != std::string::npos && is_longer) found = one;
  }
  return found;
}

std::string number_complaint(const CLI::Option& option, const std::string& value) {
  const int least = option.get_items_expected_min(), most = option.get_items_expected_max();
  const std::size_t got = option.count();
  if (most == 0) return "expected no value, got one";
  if (got == 0) return fmt::format("expected {}, got no value", value);
  if (most == 1) return fmt::format("expected it once, got it {} times", got);
  const std::string count = least == most ? std::to_string(least) : fmt::format("{} to {}", least, most);
  return fmt::format("expected {} values ({}), got {}", count, value, got);
}

/// "one requires other", of CLI11, as a pair.
std::pair<std::string, std::string> pair_in(const std::string& message, const std::string& between) {
  const std::size_t at = message.find(between);
  return {message.substr(0, at), message.substr(at + between.size())};
}

/// What is wrong, in our words; CLI11 knows the kind of mistake and the options, and its own words are for programmers.
std::string reason(const CLI::App& command, const CLI::ParseError& error) {
  const std::string kind = error.get_name();
  std::string message = error.what();
  if (kind == "RequiresError") {
    const auto [one, other] = pair_in(message, " requires ");
    return fmt::format("{}: expected {} with it, got none", one, other);
  }
  if (kind == "ExcludesError") {
    const auto [one, other] = pair_in(message, " excludes ");
    return fmt::format("expected {} or {}, got both", one, other);
  }
  const CLI::Option* option = option_in(command, message);
  if (kind == "RequiredError" && option == nullptr) return "expected one of its commands, got none";
  if (option == nullptr || kind == "ValidationError") return message;
  const OptionText text = description(*option);
  const std::string& value = text.value;
  if (kind == "RequiredError") {
    return fmt::format("expected {}, got none",
                       text.names.empty() ? text.positional : option->get_name() + " " + value);
  }
  if (kind == "ConversionError" && option->get_items_expected_max() > 0) {
    return fmt::format("{}: expected {}, got {}", option->get_name(), value, pair_in(message, " = ").second);
  }
  return fmt::format("{}: {}", option->get_name(), number_complaint(*option, value));
}

}  // namespace

std::string usage_complaint(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = innermost(app);
  const std::vector<std::string> extra = app.remaining(true);
  std::string text;
  const bool lacks_or_exceeds = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                                dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  if (lacks_or_exceeds && !extra.empty()) {  // one reason for both: a word that is not known
    const char* const what = command.get_subcommands({}).empty() ? "an option" : "a command";
    text = fmt::format("expected {} of {}, got {}{}", what, whole_name(command), extra.front(),
                       did_you_mean(extra.front(), known_words(command)));
  } else {
    text = reason(command, error);
  }
  return fmt::format("{}; see {} --help", text, whole_name(command));
}

std::vector<std::string> chosen_words(const CLI::App& app) {
  std::vector<std::string> words;
  for (const CLI::App* one = &app; !one->get_subcommands().empty(); words.push_back(one->get_name())) {
    one = one->get_subcommands().front();
  }
  return words;
}

CommandText description(const CLI::App& command) {
  CommandText all{.name = whole_name(command),
                  .text = command.get_description(),
                  .group = command.get_group(),
                  .footer = command.get_footer()};
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group() != kHidden) all.options.push_back(description(*option));
  }
  for (const CLI::App* one : command.get_subcommands({})) {
    if (one->get_group() != kHidden) all.commands.push_back(description(*one));
  }
  return all;
}

std::string word_of(const CommandText& command) { return command.name.substr(command.name.rfind(' ') + 1); }

std::string escaped(std::string_view text, std::initializer_list<std::pair<char, std::string_view>> others) {
  std::string result;
  for (const char c : text) {
    const auto* const other = std::ranges::find(others, c, &std::pair<char, std::string_view>::first);
    other == others.end() ? result += c : result += other->second;
  }
  return result;
}

}  // namespace paracal::app
