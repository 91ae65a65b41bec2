#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>

namespace paracal::app {

/// What is wrong with the arguments, in one line, and the option or command that was probably meant.
std::string usage_complaint(const CLI::App& app, const CLI::ParseError& error);

/// Accepts whole numbers from `smallest` to `largest`, 1e6 and the like, too.
CLI::Validator whole_number(std::uint64_t smallest, std::uint64_t largest);

}  // namespace paracal::app
