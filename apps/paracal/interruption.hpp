#pragma once

#include <atomic>

namespace paracal::app {

/// From now on Ctrl-C (SIGINT) and SIGTERM set a flag, so that a long command can end with what it has. The second time
/// they end the program at once.
/// @returns the flag; true once a signal came.
const std::atomic<bool>& flag_of_interruption();

/// Ends the process by the signal that set the flag, as if nobody had waited.
[[noreturn]] void end_by_interruption();

}  // namespace paracal::app
