#include "terminal.hpp"

#include <fmt/color.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <string_view>

namespace paracal::app {
namespace {

bool shows_colours(int stream) {
  const char* const refused = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  const bool is_refused = refused != nullptr && *refused != '\0';
  return !is_refused && terminal != nullptr && std::string_view(terminal) != "dumb" && isatty(stream) == 1;
}

fmt::text_style style_of(Emphasis emphasis) {
  switch (emphasis) {
    case Emphasis::strong:
      return fmt::emphasis::bold;
    case Emphasis::good:
      return fmt::emphasis::bold | fg(fmt::terminal_color::green);
    case Emphasis::bad:
      return fmt::emphasis::bold | fg(fmt::terminal_color::red);
    case Emphasis::warning:
      return fg(fmt::terminal_color::yellow);
  }
  return {};
}

}  // namespace

std::string emphasised(int stream, Emphasis emphasis, const std::string& text) {
  return shows_colours(stream) ? fmt::format(style_of(emphasis), "{}", text) : text;
}

std::string with_verdict(const std::string& text, bool is_met) {
  std::istringstream lines(text);
  std::string line, result;
  std::getline(lines, line);
  result = emphasised(STDOUT_FILENO, is_met ? Emphasis::good : Emphasis::bad, line) + "\n";
  while (std::getline(lines, line)) {
    const bool is_note = line.starts_with("  note:");
    result += (is_note ? emphasised(STDOUT_FILENO, Emphasis::warning, line) : line) + "\n";
  }
  return result;
}

std::size_t columns_of_output() {
  constexpr std::size_t kUsual = 80;
  winsize size{};
  const bool is_known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return is_known ? size.ws_col : kUsual;
}

}  // namespace paracal::app
