#include "paracal/interruption.hpp"

#include <chrono>
#include <utility>

namespace paracal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kBetween = std::chrono::milliseconds(50);

thread_local const std::function<void()>* check_of_thread = nullptr;
thread_local Clock::time_point next_check = {};

}  // namespace

Interruptible::Interruptible(std::function<void()> check)
    : check_(std::move(check)), before_(std::exchange(check_of_thread, &check_)) {
  next_check = {};
}

Interruptible::~Interruptible() { check_of_thread = before_; }

void let_interrupt() {
  if (check_of_thread == nullptr) return;
  const auto now = Clock::now();
  if (now < next_check) return;
  next_check = now + kBetween;
  (*check_of_thread)();
}

}  // namespace paracal
