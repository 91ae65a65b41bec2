#pragma once

#include <string>
#include <vector>

#include "jobs/ranks.hpp"
#include "paracal/io/file.hpp"

namespace paracal::app {

/// One command line of paracal, up to the outputs that replace earlier ones.
/// @param words            what follows the program's name.
/// @param standard_output  takes what the command prints (help, version and licences go to the real one).
/// @param ranks            that run the same command line together.
/// @returns the exit code; throws what main() makes the others of.
int run_program(const std::vector<std::string>& words, const io::TextSink& standard_output, jobs::Ranks& ranks);

}  // namespace paracal::app
