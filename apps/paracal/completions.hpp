#pragma once

#include <string>

#include "description.hpp"

namespace paracal::app {

/// What completes the program's commands, options and values as they are typed, for three shells.
std::string bash_completion(const CommandText& program);
std::string zsh_completion(const CommandText& program);
std::string fish_completion(const CommandText& program);

}  // namespace paracal::app
