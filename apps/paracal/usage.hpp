#pragma once

#include <string>
#include <vector>

#include "description.hpp"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace paracal::app {

/// What is wrong with the arguments, in one line, and the option or command that was probably meant.
std::string usage_complaint(const CLI::App& app, const CLI::ParseError& error);

/// The commands that the arguments chose, from the program on: "tolerance", "allocate".
std::vector<std::string> chosen_words(const CLI::App& app);

/// The command with all that belongs to it, as --help has it.
CommandText description(const CLI::App& command);

}  // namespace paracal::app
