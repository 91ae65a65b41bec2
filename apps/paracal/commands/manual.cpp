#include <filesystem>
#include <memory>

#include "completions.hpp"
#include "manual_pages.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/version.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

/// The option is the same everywhere, and its names are known here alone.
void name_robots(CommandText& command) {
  for (OptionText& option : command.options) {
    const bool names_any_robot = option.choices.empty() && option.names == std::vector<std::string>{"--robot"};
    if (!names_any_robot) continue;
    for (const std::string_view name : catalogue::names()) option.choices.emplace_back(name);
    option.takes_others = true;
  }
  for (CommandText& one : command.commands) name_robots(one);
}

void run(const std::filesystem::path& folder, CommandText program, Session& session) {
  name_robots(program);
  for (const auto& [name, text] : manual_pages(program, std::string(version())))
    session.outputs.store.write(folder / name, text);
  session.outputs.store.write(folder / "paracal.bash", bash_completion(program));
  session.outputs.store.write(folder / "_paracal", zsh_completion(program));
  session.outputs.store.write(folder / "paracal.fish", fish_completion(program));
}

}  // namespace

// Hidden: for those who build and package the program.
void add_manual(Arguments& arguments, Session& session) {
  Command* command =
      arguments.program().add_command("manual", "manual pages and completions, made from the options", kHidden);
  const auto folder = std::make_shared<std::string>();
  command->add_option("folder", *folder, "folder for the pages")->required();
  command->callback([&arguments, &session, folder] { run(*folder, arguments.describe(), session); });
}

}  // namespace paracal::app
