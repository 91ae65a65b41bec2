#pragma once

#include <map>
#include <string>

#include "description.hpp"

namespace paracal::app {

/// A manual page (man(7)) for the program and for each command, by file name: paracal.1, paracal-tolerance-allocate.1.
std::map<std::string, std::string> manual_pages(const CommandText& program, const std::string& version);

}  // namespace paracal::app
