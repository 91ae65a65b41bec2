#include "completions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace paracal::app {
namespace {

std::string joined(const std::vector<std::string>& words, std::string_view separator) {
  return fmt::format("{}", fmt::join(words, separator));
}

/// "tolerance allocate" of "paracal tolerance allocate"; empty for the program itself.
std::string path_of(const CommandText& command) {
  const std::size_t blank = command.name.find(' ');
  return blank == std::string::npos ? "" : command.name.substr(blank + 1);
}

std::vector<const CommandText*> all_of(const CommandText& command) {
  std::vector<const CommandText*> all{&command};
  for (const CommandText& one : command.commands) {
    const auto below = all_of(one);
    all.insert(all.end(), below.begin(), below.end());
  }
  return all;
}

std::vector<std::string> words_of(const std::vector<CommandText>& commands) {
  std::vector<std::string> words(commands.size());
  std::ranges::transform(commands, words.begin(), word_of);
  return words;
}

// bash

/// Which words lead to a command: 'tolerance allocate') command='tolerance allocate' ;;
std::string bash_steps(const CommandText& program) {
  std::string text;
  for (const CommandText* above : all_of(program)) {
    for (const CommandText& one : above->commands) {
      text += fmt::format("      '{} {}') command='{}' ;;\n", path_of(*above), word_of(one), path_of(one));
    }
  }
  return text;
}

/// What follows an option that takes a value; bash completes files where nothing is given.
std::string bash_values(const CommandText& program) {
  std::string text;
  for (const CommandText* command : all_of(program)) {
    std::vector<std::string> anything;
    for (const OptionText& option : command->options) {
      for (const std::string& name : option.names) {
        const std::string place = fmt::format("'{} {}'", path_of(*command), name);
        if (!option.takes_value) continue;
        if (option.choices.empty()) {
          anything.push_back(place);
        } else {
          text += fmt::format("    {}) words='{}' ;;\n", place, joined(option.choices, " "));
        }
      }
    }
    if (!anything.empty()) text += fmt::format("    {}) words= ;;\n", joined(anything, " | "));
  }
  return text;
}

std::string bash_words(const CommandText& program) {
  std::string text;
  for (const CommandText* command : all_of(program)) {
    std::vector<std::string> words = words_of(command->commands);
    for (const OptionText& option : command->options) {
      words.insert(words.end(), option.names.begin(), option.names.end());
      if (option.names.empty()) words.insert(words.end(), option.choices.begin(), option.choices.end());
    }
    text += fmt::format("        '{}') words='{}' ;;\n", path_of(*command), joined(words, " "));
  }
  return text;
}

// zsh

std::string zsh_text(std::string_view text) {
  return escaped(text, {{'\'', "'\\''"}, {'[', "\\["}, {']', "\\]"}, {':', "\\:"}, {'\\', "\\\\"}});
}

std::string zsh_value(const OptionText& option) {
  if (!option.takes_value) return "";
  if (option.choices.empty()) return ":value:_files";
  const std::string names = joined(option.choices, " ");
  if (option.takes_others)
    return fmt::format(":value:_alternative \"names\\:name\\:({})\" \"files\\:file\\:_files\"", names);
  return fmt::format(":value:({})", names);
}

std::string zsh_arguments(const CommandText& command) {
  std::string text;
  for (const OptionText& option : command.options) {
    for (const std::string& name : option.names) {
      text += fmt::format(" \\\n    '{}[{}]{}'", name, zsh_text(option.text), zsh_value(option));
    }
    if (option.names.empty())
      text += fmt::format(" \\\n    ':{}{}'", zsh_text(option.text), zsh_value(option).substr(6));
  }
  return text;
}

std::string zsh_function_name(const CommandText& command) {
  return "_" + escaped(command.name, {{' ', "_"}, {'-', "_"}});
}

std::string zsh_function(const CommandText& command) {
  if (command.commands.empty()) {
    return fmt::format("{}() {{\n  _arguments{}\n}}\n\n", zsh_function_name(command), zsh_arguments(command));
  }
  std::string commands;
  for (const CommandText& one : command.commands) {
    commands += fmt::format("\n        '{}:{}'", word_of(one), zsh_text(one.text));
  }
  return fmt::format(
      "{0}() {{\n  local state line\n  typeset -A opt_args\n  _arguments -C{1} \\\n    '1: :->command' '*:: :->rest' "
      "&& return\n"
      "  case $state in\n    command)\n      local -a commands=({2})\n      _describe command commands ;;\n"
      "    rest) _call_function - {0}_${{line[1]//-/_}} ;;\n  esac\n}}\n\n",
      zsh_function_name(command), zsh_arguments(command), commands);
}

// fish

std::string fish_text(std::string_view text) { return escaped(text, {{'\'', "\\'"}, {'\\', "\\\\"}}); }

/// When the words so far mean this command and none below it.
std::string fish_condition(const CommandText& command) {
  if (path_of(command).empty()) return "__fish_use_subcommand";
  const std::string seen = "__fish_seen_subcommand_from ";
  std::string condition = seen + escaped(path_of(command), {{' ', "; and " + seen}});
  if (!command.commands.empty()) condition += "; and not " + seen + joined(words_of(command.commands), " ");
  return condition;
}

std::string fish_option(const OptionText& option) {
  std::string text;
  for (const std::string& name : option.names) {
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  const bool closed = !option.choices.empty() && !option.takes_others;
  if (option.takes_value && !option.names.empty()) text += closed ? " -x" : " -r";
  if (!option.choices.empty()) text += fmt::format(" -a '{}'", joined(option.choices, " "));
  return text + fmt::format(" -d '{}'", fish_text(option.text));
}

}  // namespace

std::string bash_completion(const CommandText& program) {
  return "# Completion of paracal for bash, made from its own options.\n"
         "_paracal() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command='' words='' k\n"
         "  for ((k = 1; k < COMP_CWORD; ++k)); do\n"
         "    case \"$command ${COMP_WORDS[k]}\" in\n" +
         bash_steps(program) +
         "    esac\n"
         "  done\n"
         "  case \"$command $before\" in\n" +
         bash_values(program) +
         "    *)\n"
         "      case $command in\n" +
         bash_words(program) +
         "      esac ;;\n"
         "  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
         "}\n"
         "complete -o default -F _paracal paracal  # files where there is nothing else\n";
}

std::string zsh_completion(const CommandText& program) {
  std::string text = "#compdef paracal\n# Completion of paracal for zsh, made from its own options.\n\n";
  for (const CommandText* command : all_of(program)) text += zsh_function(*command);
  return text + "_paracal \"$@\"\n";
}

std::string fish_completion(const CommandText& program) {
  std::string text = "# Completion of paracal for fish, made from its own options.\n";
  for (const CommandText* command : all_of(program)) {
    const std::string start = fmt::format("complete -c paracal -n '{}'", fish_condition(*command));
    for (const CommandText& one : command->commands) {
      text += fmt::format("{} -f -a {} -d '{}'\n", start, word_of(one), fish_text(one.text));
    }
    for (const OptionText& option : command->options) text += start + fish_option(option) + "\n";
  }
  return text;
}

}  // namespace paracal::app
