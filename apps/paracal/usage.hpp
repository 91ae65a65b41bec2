#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace paracal::app {

/// What is wrong with the arguments, in one line, and the option or command that was probably meant.
std::string usage_complaint(const CLI::App& app, const CLI::ParseError& error);

/// A text that is one number from its first character to its last.
template <typename Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  return error == std::errc{} && at == end ? std::optional(number) : std::nullopt;
}

/// Accepts whole numbers from `smallest` to `largest`, 1e6 and the like, too.
CLI::Validator whole_number(std::uint64_t smallest, std::uint64_t largest);

}  // namespace paracal::app
