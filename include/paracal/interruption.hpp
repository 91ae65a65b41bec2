#pragma once

#include <functional>

namespace paracal {

/// While an object exists, computations of its thread call `check` at once and about every 50 ms, on that
/// thread. An exception of `check` stops the computation and reaches the caller, without other effects. Afterwards the
/// previous object is active again.
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

/// For long loops: calls the check of the thread's Interruptible, if there is one and 50 ms have passed. Not for
/// callbacks from C libraries, which do not allow exceptions.
void let_interrupt();

}  // namespace paracal
