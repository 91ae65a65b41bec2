#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "paracal/batch/production.hpp"
#include "paracal/batch/tally.hpp"

namespace paracal {

/// Everything that decides what the machines of a batch are.
struct Batch {
  Robot robot;
  ProductionPlan plan;  ///< settled()
  std::uint64_t seed = 1;
};

/// Machines first, first + 1, ..., first + count - 1.
struct MachineRange {
  std::uint64_t first = 0, count = 0;
};

/// Produces some machines of a batch. Memory depends on their count (about 100 bytes a machine), not on where they
/// stand.
/// @param threads  at most this many; 0: as many as there are cores. The result is the same for any number.
/// @param stop     may be set by another thread or a signal handler; the chunk is then dropped.
/// @returns empty when it was stopped.
std::optional<Tally> run_chunk(const Batch& batch, MachineRange range, unsigned threads, const std::atomic<bool>& stop);

}  // namespace paracal
