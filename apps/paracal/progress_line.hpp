#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace paracal::app {

/// One line on standard error that is written over and over: how far, how fast, how long still. Silent where standard
/// error is no terminal. Gone when this is.
class ProgressLine {
 public:
  /// @param what  is counted, e.g. "machines".
  ProgressLine(std::string what, std::uint64_t total);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// The first call tells what was there before this process began.
  void show(std::uint64_t done);
  /// The total is known better now.
  void expect(std::uint64_t total) { total_ = total; }
  /// Makes room for a message.
  void clear() const;

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  std::uint64_t total_;
  bool on_terminal_;
  bool started_ = false;
  std::uint64_t at_start_ = 0;
  Clock::time_point start_ = {};
};

}  // namespace paracal::app
