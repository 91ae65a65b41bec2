#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

namespace paracal::app {

/// One line on standard error that is overwritten: how much is done, how fast, and how long the rest takes where the
/// total is known. Silent where standard error is not a terminal. Erased by the destructor.
class ProgressLine {
 public:
  /// @param what  is counted, e.g. "machines".
  explicit ProgressLine(std::string what) : what_(std::move(what)), on_terminal_(is_shown()) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// The first call states what was done before this process began.
  /// @param total  fixed, as a total that grows misleads; 0: not known, because the results decide when to stop.
  void show(std::uint64_t done, std::uint64_t total = 0);
  /// Begins a new stage with its own total; the first one is stage 1.
  void begin(std::uint64_t stage);
  /// Makes room for a message.
  void clear() const;

 private:
  using Clock = std::chrono::steady_clock;

  static bool is_shown();

  std::string what_;
  std::string stage_;
  bool on_terminal_;
  bool started_ = false;
  std::uint64_t at_start_ = 0;
  Clock::time_point start_ = {};
};

}  // namespace paracal::app
