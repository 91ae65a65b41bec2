#pragma once

#include <string>
#include <vector>

#include "description.hpp"

namespace paracal::app {

/// What --help prints of a command: usage, options and commands under their headings, examples. Headings and names are
/// bold where standard output shows colours.
std::string help_text(const CommandText& command);

/// The command that words name, as "tolerance allocate" does; nullptr: there is none.
const CommandText* find_command(const CommandText& program, const std::vector<std::string>& words);

/// How the command is called: its name, what it requires and [OPTIONS].
std::string usage_line(const CommandText& command);

}  // namespace paracal::app
