#include "usage.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

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

}  // namespace

std::string usage_complaint(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = innermost(app);
  const std::vector<std::string> extra = app.remaining(true);
  std::string text = error.what();
  const bool lacks_or_exceeds = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                                dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  if (lacks_or_exceeds && !extra.empty()) {  // one reason for both: a word that is not known
    const char* const what = command.get_subcommands({}).empty() ? "an option" : "a command";
    text = fmt::format("expected {} of {}, got {}{}", what, whole_name(command), extra.front(),
                       did_you_mean(extra.front(), known_words(command)));
  }
  return fmt::format("{}; see {} --help", text, whole_name(command));
}

namespace {

/// Those of "TEXT:{one,other}".
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
  if (text.names.empty()) text.positional = option.get_name(true);
  text.value = CLI::detail::trim_copy(CLI::Formatter().make_option_opts(&option));
  text.choices = choices_in(option.get_type_name());
  text.takes_value = option.get_items_expected_max() > 0;
  return text;
}

}  // namespace

CommandText description(const CLI::App& command) {
  CommandText all{.name = whole_name(command),
                  .text = command.get_description(),
                  .group = command.get_group(),
                  .footer = command.get_footer()};
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_group().empty()) all.options.push_back(description(*option));
  }
  for (const CLI::App* one : command.get_subcommands({})) {
    if (!one->get_group().empty()) all.commands.push_back(description(*one));
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
