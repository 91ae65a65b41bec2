#include "nesting.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/robots/same_robot.hpp"
#include "paracal/error.hpp"

namespace paracal::io {
namespace {

constexpr int kTooDeepId = 199;  // an id of a parse error that the library does not use

/// A TOML text, one character after the other, outside of comments and quotation marks.
class Bare {
 public:
  explicit Bare(std::string_view text) : rest_(text) {}

  /// '\0' at the end.
  char next() {
    while (!rest_.empty()) {
      const char one = take(1);
      if (one == '#') {
        rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size()));
      } else if (one == '"' || one == '\'') {
        skip_quoted(one);
      } else {
        return one;
      }
    }
    return '\0';
  }
  int line() const { return line_; }

 private:
  char take(std::size_t count) {
    const char first = rest_.front();
    line_ += static_cast<int>(std::ranges::count(rest_.substr(0, count), '\n'));
    rest_.remove_prefix(std::min(count, rest_.size()));
    return first;
  }

  /// Three marks begin a text of several lines, which three end; a backslash hides what follows it from ".
  void skip_quoted(char mark) {
    const std::string three(3, mark);
    const bool is_long = rest_.starts_with(three.substr(1));
    if (is_long) take(2);
    while (!rest_.empty()) {
      if (mark == '"' && rest_.front() == '\\') {
        take(2);
      } else if (is_long ? rest_.starts_with(three) : rest_.front() == mark || rest_.front() == '\n') {
        take(is_long ? 3 : 1);
        return;
      } else {
        take(1);
      }
    }
  }

  std::string_view rest_;
  int line_ = 1;
};

}  // namespace

Json parse_shallow(std::string_view text) {
  const auto refuse_depth = [](int depth, Json::parse_event_t, const Json&) {
    if (depth > kDeepest) throw Json::parse_error::create(kTooDeepId, 0, "nested too deeply", nullptr);
    return true;
  };
  return Json::parse(text, refuse_depth);
}

Json parse_json(const TextFile& file) {
  try {
    return parse_shallow(file.text);
  } catch (const Json::parse_error& error) {
    throw InputFileError(file.name, error.id == kTooDeepId ? 0 : line_at(file.text, error.byte),
                         error.id == kTooDeepId
                             ? fmt::format("expected at most {} levels of nesting, got more", kDeepest)
                             : "expected JSON, got something else");
  } catch (const Json::out_of_range& error) {  // of numbers; it says which in quotation marks, and not where
    const std::string_view message = error.what();
    const std::size_t from = message.find('\'') + 1;
    const std::string_view number = message.substr(from, message.rfind('\'') - from);
    throw InputFileError(file.name, line_at(file.text, file.text.find(number)),
                         fmt::format("expected numbers below 1e309, got {}", number));
  }
}

std::optional<int> line_of_endless_key(std::string_view text) {
  constexpr std::string_view kEndsKeys = ",[]{}=\n";
  Bare bare(text);
  int dots = 0;
  for (char one = bare.next(); one != '\0'; one = bare.next()) {
    if (kEndsKeys.find(one) != std::string_view::npos) dots = 0;
    if (one == '.' && ++dots > kDeepest) return bare.line();
  }
  return std::nullopt;
}

}  // namespace paracal::io
