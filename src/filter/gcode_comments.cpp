#include "gcode_comments.hpp"

#include <algorithm>
#include <array>

#include "io/columns.hpp"
#include "io/letters.hpp"

namespace paracal::io {
namespace {

/// (...) each, and ;... at the end.
std::vector<std::string_view> comments(std::string_view line) {
  std::vector<std::string_view> all;
  for (std::size_t at = line.find_first_of("(;"); at != std::string_view::npos; at = line.find_first_of("(;", at)) {
    const std::size_t end = line[at] == ';' ? std::string_view::npos : line.find(')', at);
    all.push_back(line.substr(at, end == std::string_view::npos ? end : end + 1 - at));
    if (end == std::string_view::npos) break;
    at = end + 1;
  }
  return all;
}

bool shows_values(std::string_view comment) {
  constexpr std::array<std::string_view, 3> kShows{"DEBUG,", "PRINT,", "LOG,"};
  const std::string text = upper_case(trimmed(comment.substr(1)));
  return std::ranges::any_of(kShows, [&](std::string_view one) { return text.starts_with(one); });
}

/// The parameter that begins behind a '#' at the beginning of a text: its digits, or its name in angle brackets.
std::string_view parameter_at(std::string_view text) {
  if (text.substr(1).starts_with('<')) {
    const std::size_t end = text.find('>');
    return end == std::string_view::npos ? std::string_view() : text.substr(0, end + 1);
  }
  const std::size_t end = std::min(text.find_first_not_of("0123456789", 1), text.size());
  return end == 1 ? std::string_view() : text.substr(0, end);
}

}  // namespace

std::string comments_of(std::string_view line) {
  std::string text;
  for (const std::string_view one : comments(line)) text.append(text.empty() ? "" : " ").append(one);
  return text;
}

std::vector<std::string_view> shown_parameters(std::string_view line) {
  std::vector<std::string_view> in_brackets = comments(line);
  std::erase_if(in_brackets, [](std::string_view one) { return one.starts_with(';'); });
  if (in_brackets.empty() || !shows_values(in_brackets.back())) return {};
  std::vector<std::string_view> shown;
  std::string_view rest = in_brackets.back();
  for (std::size_t at = rest.find('#'); at != std::string_view::npos; at = rest.find('#', 1)) {
    rest.remove_prefix(at);
    const std::string_view one = parameter_at(rest);
    if (!one.empty() && std::ranges::find(shown, one) == shown.end()) shown.push_back(one);
  }
  return shown;
}

}  // namespace paracal::io
