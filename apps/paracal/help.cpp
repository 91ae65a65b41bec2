#include "help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "terminal.hpp"

namespace paracal::app {
namespace {

constexpr std::size_t kNames = 28;          // columns of names, before their texts
constexpr std::size_t kWidestText = 100;    // columns: longer lines are hard to read
constexpr std::size_t kNarrowestText = 50;  // columns: narrower terminals break lines themselves

std::string strong(const std::string& text) { return emphasised(STDOUT_FILENO, Emphasis::strong, text); }

/// Words in lines of at most `width` columns, each but the first behind `indent` blanks.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::istringstream words(text);
  std::string result, word;
  std::size_t column = indent;
  while (words >> word) {
    if (column > indent && column + 1 + word.size() > width) {
      result += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      result += " ";
      ++column;
    }
    result += word;
    column += word.size();
  }
  return result;
}

std::size_t line_width() { return std::clamp(columns_of_output(), kNarrowestText, kWidestText); }

/// A name, what it takes, and its text beside or below it.
std::string entry(const std::string& name, const std::string& value, const std::string& text) {
  const std::size_t written = 2 + name.size() + (value.empty() ? 0 : 1 + value.size());
  const std::string gap = written + 2 <= kNames ? std::string(kNames - written, ' ') : "\n" + std::string(kNames, ' ');
  return fmt::format("  {}{}{}{}{}\n", strong(name), value.empty() ? "" : " ", value, gap,
                     wrapped(text, kNames, line_width()));
}

std::string names_of(const OptionText& option) {
  return option.names.empty() ? option.positional : fmt::format("{}", fmt::join(option.names, ", "));
}

std::string examples(const CommandText& command) {
  std::string text = command.examples.empty() ? "" : "\n" + strong("Examples:") + "\n";
  for (const Example& one : command.examples) text += fmt::format("  {}:\n    {}\n", one.purpose, one.line);
  return text;
}

}  // namespace

std::string usage_line(const CommandText& command) {
  std::string line = command.name;
  for (const OptionText& option : command.options) {
    if (option.names.empty()) line += option.is_required ? " " + option.positional : " [" + option.positional + "]";
  }
  for (const OptionText& option : command.options) {
    if (!option.names.empty() && option.is_required) line += " " + option.names.front() + " " + option.value;
  }
  return line + (command.commands.empty() ? " [OPTIONS]" : " COMMAND [OPTIONS]");
}

std::string help_text(const CommandText& command) {
  std::string text = fmt::format("{}\n\n{} {}\n", command.text, strong("Usage:"), usage_line(command));
  for (const std::string& heading : headings(command.commands)) {
    text += "\n" + strong(heading + ":") + "\n";
    for (const CommandText& one : command.commands) {
      if (one.group == heading) text += entry(word_of(one), "", one.text);
    }
  }
  for (const std::string& heading : headings(command.options)) {
    text += "\n" + strong(heading + ":") + "\n";
    for (const OptionText& one : command.options) {
      if (one.group == heading) text += entry(names_of(one), one.value, one.text);
    }
  }
  text += examples(command);
  return command.footer.empty() ? text : text + "\n" + wrapped(command.footer, 0, line_width()) + "\n";
}

const CommandText* find_command(const CommandText& program, const std::vector<std::string>& words) {
  const CommandText* found = &program;
  for (const std::string& word : words) {
    const auto below =
        std::ranges::find_if(found->commands, [&](const CommandText& one) { return word_of(one) == word; });
    if (below == found->commands.end()) return nullptr;
    found = &*below;
  }
  return found;
}

}  // namespace paracal::app
