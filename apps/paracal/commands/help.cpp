#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "embedded.hpp"
#include "help.hpp"
#include "paracal/spelling.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

/// "terms" of terms.txt.
std::string topic_of(const detail::EmbeddedFile& file) { return std::string(file.name.substr(0, file.name.find('.'))); }

std::string help_on(const CommandText& program, const std::vector<std::string>& words) {
  if (const CommandText* const command = find_command(program, words)) return help_text(*command);
  std::vector<std::string> known;
  for (const detail::EmbeddedFile& file : detail::help_topics()) {
    if (words == std::vector{topic_of(file)}) return std::string(file.text);
    known.push_back(topic_of(file));
  }
  const std::string topics = fmt::format("{}", fmt::join(known, ", "));
  for (const CommandText& one : program.commands) known.push_back(word_of(one));
  const std::string wanted = fmt::format("{}", fmt::join(words, " "));
  throw WrongUsage(
      fmt::format("help: expected a command or a topic ({}), got {}{}", topics, wanted, did_you_mean(wanted, known)));
}

}  // namespace

void add_help(Arguments& arguments, Session& session) {
  Command* command =
      arguments.program().add_command("help", "explain a command or a topic: terms, files, units", "Help");
  const auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("topic", *words, "a command, or a topic: terms, files, units")->takes("WORD");
  command->example("Meaning of the terms in results", "paracal help terms");
  command->example("Options of a command", "paracal help tolerance analyze");
  command->callback([&arguments, &session, words] { session.print(help_on(arguments.describe(), *words)); });
}

}  // namespace paracal::app
