#include "progress_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace paracal::app {
namespace {

constexpr const char* kEraseLine = "\r\033[K";

/// 1:02:03 or 2:03.
std::string clock_text(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  const std::int64_t hours = whole / 3600, minutes = whole / 60 % 60, rest = whole % 60;
  return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, rest) : fmt::format("{}:{:02}", minutes, rest);
}

}  // namespace

bool ProgressLine::is_shown() { return isatty(STDERR_FILENO) == 1; }

void ProgressLine::begin(std::uint64_t stage) {
  started_ = false;
  stage_ = stage > 1 ? fmt::format("stage {}: ", stage) : "";
}

void ProgressLine::show(std::uint64_t done, std::uint64_t total) {
  if (!on_terminal_) return;
  if (!started_) {
    started_ = true;
    at_start_ = done;
    start_ = Clock::now();
  }
  const std::string of = total > 0 ? fmt::format(" of {}", total) : "";
  std::string text = fmt::format("{}{}{}{} {}", kEraseLine, stage_, done, of, what_);
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  if (done > at_start_ && seconds > 0.0) {
    const double rate = static_cast<double>(done - at_start_) / seconds;
    text += fmt::format(", {:.3g} per second", rate);
    if (total > 0) text += fmt::format(", {} left", clock_text(static_cast<double>(total - done) / rate));
  }
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

void ProgressLine::clear() const {
  if (started_) std::fputs(kEraseLine, stderr);
}

}  // namespace paracal::app
