#pragma once

// Private to io: letters, blanks and digits of ASCII, which programs and configurations are written in, whatever the
// locale.

#include <algorithm>
#include <string>
#include <string_view>

namespace paracal::io {

constexpr bool is_blank(char c) { return c == ' ' || c == '\t'; }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr char upper_case(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
constexpr char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
/// Before a name that a spreadsheet would compute, so that it does not. It is no part of the name.
inline constexpr char kNoFormula = '\'';
/// Whether a spreadsheet would compute this cell, or it has such marks already.
constexpr bool begins_as_formula(std::string_view cell) {
  const std::size_t first = cell.find_first_not_of(kNoFormula);
  return first != std::string_view::npos && std::string_view("=+-@").find(cell[first]) != std::string_view::npos;
}

constexpr bool is_letter(char c) { return upper_case(c) >= 'A' && upper_case(c) <= 'Z'; }

inline std::string upper_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](char c) { return upper_case(c); });
  return result;
}

inline std::string lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](char c) { return lower_case(c); });
  return result;
}

}  // namespace paracal::io
