#include "interruption.hpp"

#include <csignal>
#include <cstdlib>

namespace paracal::app {
namespace {

std::atomic<bool> interrupted = false;  // a handler reaches nothing but globals
std::atomic<int> signal_that_came = SIGTERM;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

extern "C" void note_interruption(int signal) {
  signal_that_came.store(signal);
  interrupted.store(true);
}

}  // namespace

const std::atomic<bool>& flag_of_interruption() {
  struct sigaction action {};
  action.sa_handler = note_interruption;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  return interrupted;
}

void end_by_interruption() {
  std::signal(signal_that_came, SIG_DFL);
  std::raise(signal_that_came);
  std::abort();  // a signal that is blocked
}

}  // namespace paracal::app
