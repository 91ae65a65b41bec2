#include "interruption.hpp"

#include <csignal>

namespace paracal::app {
namespace {

std::atomic<bool> interrupted = false;  // a handler reaches nothing but globals
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void note_interruption(int /*signal*/) { interrupted.store(true); }

}  // namespace

const std::atomic<bool>& flag_of_interruption() {
  struct sigaction action {};
  action.sa_handler = note_interruption;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  return interrupted;
}

}  // namespace paracal::app
