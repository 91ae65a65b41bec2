#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace paracal::app {

/// What is wrong with the arguments, in one line, and the option or command that was probably meant.
std::string usage_complaint(const CLI::App& app, const CLI::ParseError& error);

}  // namespace paracal::app
