#include "paracal/io/signals_wait.hpp"

#include <csignal>

#include <array>
#include <atomic>
#include <cstddef>
#include <mutex>

namespace paracal::io {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

/// What those that live share.
struct Waiting {
  std::mutex mutex = {};
  int count = 0;
  std::array<struct sigaction, kSignals.size()> before = {};
};

Waiting& waiting() {
  static Waiting shared;
  return shared;
}

std::array<std::atomic<bool>, kSignals.size()> arrived{};

extern "C" void note_signal(int signal) {
  for (std::size_t k = 0; k < kSignals.size(); ++k) {
    if (kSignals[k] == signal) arrived[k].store(true);
  }
}

}  // namespace

SignalsWait::SignalsWait() {
  Waiting& shared = waiting();
  const std::lock_guard lock(shared.mutex);
  if (shared.count++ > 0) return;
  struct sigaction note {};
  note.sa_handler = note_signal;
  note.sa_flags = SA_RESTART;
  for (std::size_t k = 0; k < kSignals.size(); ++k) {
    sigaction(kSignals[k], nullptr, &shared.before[k]);
    if (shared.before[k].sa_handler != SIG_IGN) sigaction(kSignals[k], &note, nullptr);  // nohup stays
  }
}

SignalsWait::~SignalsWait() {
  Waiting& shared = waiting();
  const std::lock_guard lock(shared.mutex);
  if (--shared.count > 0) return;
  for (std::size_t k = 0; k < kSignals.size(); ++k) sigaction(kSignals[k], &shared.before[k], nullptr);
  for (std::size_t k = 0; k < kSignals.size(); ++k) {
    if (arrived[k].exchange(false)) raise(kSignals[k]);
  }
}

}  // namespace paracal::io
