#pragma once

#include <functional>

namespace paracal {

/// While one lives, what its thread computes by this library calls `check` at once and about every 50 ms, on that
/// thread. What `check` throws ends the computation and reaches the caller; nothing else of it remains. The one that
/// lived before counts again afterwards.
class Interruptible {
 public:
  explicit Interruptible(std::function<void()> check);
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
  ~Interruptible();

 private:
  std::function<void()> check_;
  const std::function<void()>* before_;
};

/// For loops that may last: calls the check of the thread's Interruptible where there is one and it is time. Not for
/// what a library in C calls back, which no exception can leave.
void let_interrupt();

}  // namespace paracal
